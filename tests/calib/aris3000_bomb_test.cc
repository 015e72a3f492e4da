// The acoustic model against the two frames of a bomb that an ARIS 3000 recorded: display read off the
// background of frame 0, model fitted on frame 0, judged on frame 1. It is one still scene, so frame 1 has
// other receiver noise but the same speckle and the same pose.
//
// The pose is where the search of calib/pose_search.h ends on frame 0 (minutes of work, not repeated here),
// and is held: about it the likelihood trades the wrong outline for worse images.
//
// Wanted and not reached, with the figures reached:
//   mean error over union and overlap   0.085   0.091 and 0.100
//   IoU of a speckled sample            0.80    0.795, eight draws pooled
//   KS of the background's grey         0.03    0.038
// Likely cause: the outline. The difference of the smoothed images is largest at the near end and along the
// far edge; none of the few poses, noses and tails tried brought union below 0.09, wider tails at this pose
// made it worse. Beam and pulse end at or near their upper bounds, and bounds of 0.35 degrees and three bins
// gave the same errors: take neither width for the sonar's. Bounds named kRegression... hold what is reached
// and claim no more.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <iostream>
#include <vector>

#include "calib/background_display.h"
#include "calib/target_fit.h"
#include "data_io/open_recording.h"
#include "data_io/types/units.h"
#include "metrics/compare.h"
#include "sim/physics/display.h"
#include "sim/scenes.h"
#include "tests/support/recordings.h"

namespace sonarcal {
namespace {

constexpr double kRegressionKs = 0.045;
constexpr double kRegressionIou = 0.78;
constexpr double kRegressionUnion = 0.097;
constexpr double kRegressionOverlap = 0.105;

// Where the fit starts: the data sheet's beam, and a pulse as the grain shows it.
constexpr double kBeamDeg = 0.25;
constexpr double kPulseBins = 2.0;

const TargetPose kPose = {.range_m = 1.286,
                          .azimuth_rad = RadFromDeg(-5.0),
                          .elevation_rad = RadFromDeg(2.2),
                          .yaw_rad = RadFromDeg(125.4),
                          .pitch_rad = RadFromDeg(29.7)};

// Pixels beyond reach of the object found in the image: 20 bins and 8 beams.
Mask BackgroundOf(const PolarImage& image) {
  Mask background = BoxAround(Segment(image, {}).object, 20, 8);
  for (std::uint8_t& pixel : background.values()) pixel = pixel == 0 ? 1 : 0;
  return background;
}

// Wasserstein-1 distance between two images' distributions of whole grey levels, of full scale 1.
double GreyDistance(const PolarImage& a, const PolarImage& b) {
  std::array<double, 256> excess{};
  for (const float grey : a.value.values()) excess.at(std::lround(grey)) += 1.0;
  for (const float grey : b.value.values()) excess.at(std::lround(grey)) -= 1.0;
  double cumulated = 0.0;
  double distance = 0.0;
  for (const double e : excess) distance += std::abs(cumulated += e);
  return distance / static_cast<double>(a.value.size()) / 255.0;
}

struct Judgement {
  FrameMetrics metrics;
  double grey_distance = 0.0;

  double Error(IntensityDomain domain) const {
    return metrics.polar.intensity.Over(domain).mean_absolute().value();
  }
};

Judgement Judge(const PolarImage& real, PolarImage simulated) {
  simulated.scale = real.scale;  // levels count from the noise in one, from the display's start in the other
  return {CompareFrames(real, simulated), GreyDistance(real, simulated)};
}

void Print(const char* what, const Judgement& judgement) {
  const Occupancy& o = judgement.metrics.polar.occupancy;
  std::cout << what << ": whole " << judgement.Error(IntensityDomain::kWhole) << ", union "
            << judgement.Error(IntensityDomain::kUnion) << ", overlap "
            << judgement.Error(IntensityDomain::kOverlap) << "; IoU " << *o.iou() << ", Ns/Nr "
            << *o.ns_over_nr() << ", Na/Ns " << *o.na_over_ns() << ", Na/Nr " << *o.na_over_nr() << "; W1 "
            << judgement.grey_distance << "\n";
}

TEST(Aris3000BombTest, BackgroundFollowsASoftenedAmplitude) {
  SONARCAL_NEEDS_RECORDING(folder, "aris3000_uxo");
  const PolarImage image = OpenRecording(folder)->ReadFrame(0).image;
  // 97 counts of 80/255 dB over the full grey scale: the slope of the display.
  EXPECT_NEAR(image.scale.db_span.value() / 97.0, 0.3137, 1e-4);
  const Mask background = BackgroundOf(image);
  const BackgroundDisplay amplitude = FitBackgroundDisplay(image, background, DisplayLaw::kSoftAmplitude);
  const BackgroundDisplay power = FitBackgroundDisplay(image, background, DisplayLaw::kSoftLog);
  std::cout << "amplitude: db_min " << amplitude.display.db_min << ", soft_db " << amplitude.display.soft_db
            << ", KS " << amplitude.ks << "; power: KS " << power.ks << "\n";
  EXPECT_LE(amplitude.ks, kRegressionKs);
  // A logarithm softened in power is no match at one look, which is what the object's speckle has.
  EXPECT_GE(power.ks, 0.08);
  EXPECT_LT(amplitude.nats_per_pixel, power.nats_per_pixel);
  EXPECT_NEAR(AmplitudeOfLevel(amplitude.display.soft_db), 1.27, 0.05);
}

TEST(Aris3000BombTest, FitOfOneFrameTellsTheOther) {
  SONARCAL_NEEDS_RECORDING(folder, "aris3000_uxo");
  const auto recording = OpenRecording(folder);
  const PolarImage fitted = recording->ReadFrame(0).image;
  const PolarImage judged = recording->ReadFrame(1).image;
  const SonarModel& sonar = recording->info().sonar;
  const Water water = recording->info().water.value_or(Water{});

  ParameterSet initial;
  initial.model = EchoModel::kAcoustic;
  initial.source_level_db = 0.0;
  initial.display = FitBackgroundDisplay(fitted, BackgroundOf(fitted), DisplayLaw::kSoftAmplitude).display;
  initial.receiver = {.gain_db = 80.0, .noise_db = 0.0};  // the level is the material's to carry
  initial.beam.azimuth_width_deg = kBeamDeg;
  initial.pulse.length_m = kPulseBins * sonar.axes.range_bin_m();
  initial.materials["body"].gsab = {.a = 1e-7, .b_deg = 4.0, .c = 0.02, .d = 1.4, .e = 1e-7, .f_deg = 10.0};
  TargetFitOptions options;
  options.free_pose = false;
  options.fit.starts = 1;
  options.fit.function_tolerance = 1e-6;
  const TargetFit fit = FitTarget(MakeBody(), sonar, water, fitted, kPose, initial, options);
  ASSERT_TRUE(fit.fit.usable);
  for (const FittedParameter& p : fit.fit.report.parameters) {
    if (p.status != ParameterStatus::kFixed) {
      std::cout << "  " << p.name << " " << p.value << " +- " << p.sigma.value_or(0.0) << " "
                << ToString(p.status) << "\n";
    }
  }

  const Simulator simulator(fit.placed, sonar, fit.simulation);
  const EchoList echoes = simulator.TraceEchoes(fit.fit.world_from_sonar[0]);
  const Judgement expected = Judge(judged, simulator.RenderExpected(echoes, fit.fit.parameters));
  Print("expected image", expected);
  EXPECT_LE(expected.Error(IntensityDomain::kWhole), 0.053);
  EXPECT_LE(expected.Error(IntensityDomain::kUnion), kRegressionUnion);
  EXPECT_LE(expected.Error(IntensityDomain::kOverlap), kRegressionOverlap);

  // A draw moves the occupancy by 0.02: the mean of several is judged.
  constexpr int kDraws = 8;
  Judgement mean;
  for (int draw = 0; draw < kDraws; ++draw) {
    const Judgement sample = Judge(judged, simulator.RenderEchoes(echoes, fit.fit.parameters, draw));
    mean.metrics.polar += sample.metrics.polar;
    mean.grey_distance += sample.grey_distance / kDraws;
  }
  Print("speckled samples, pooled", mean);
  const Occupancy& occupancy = mean.metrics.polar.occupancy;
  EXPECT_GE(*occupancy.iou(), kRegressionIou);
  EXPECT_GE(*occupancy.ns_over_nr(), 0.94);
  EXPECT_LE(*occupancy.ns_over_nr(), 1.08);
  EXPECT_GE(*occupancy.na_over_ns(), 0.86);
  EXPECT_GE(*occupancy.na_over_nr(), 0.89);
  EXPECT_LE(mean.grey_distance, 0.005);
}

}  // namespace
}  // namespace sonarcal
