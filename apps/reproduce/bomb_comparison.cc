#include "apps/reproduce/bomb_comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "data_io/aris3000_frames_io.h"
#include "sim/physics/receiver.h"
#include "sim/scenes.h"

namespace sonarcal {
namespace {

// Of an ARIS 3000 at 3 MHz. The beam is that of its data sheet; the pulse is not recorded with the frames,
// and two bins are what their grain shows.
constexpr double kAzimuthBeamDeg = 0.25;
constexpr double kPulseBins = 2.0;
// The target's echo, before its strength is searched for.
constexpr double kEchoOverNoiseDb = 60.0;
// Rays reach beyond the nominal vertical field of view, where the pattern still lets echoes in.
constexpr double kElevationSpanDeg = 28.0;

double MedianGrey(const PolarImage& image) {
  std::vector<float> values(image.value.values().begin(), image.value.values().end());
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Display and noise floor read off the image: most of it is background. Only differences of level are known,
// so 0 dB is where the display begins.
ParameterSet AcousticFor(const PolarImage& image, const SonarModel& sonar) {
  if (!image.scale.db_span) throw DataError("the frames of the bomb state no dB scale");
  ParameterSet parameters;
  parameters.model = EchoModel::kAcoustic;
  parameters.source_level_db = 0.0;
  parameters.display = {.db_min = 0.0, .db_max = *image.scale.db_span};
  parameters.receiver.noise_db =
      MedianGrey(image) / image.scale.full_scale * *image.scale.db_span - MeanLogSpeckleDb(1.0);
  parameters.receiver.gain_db = kEchoOverNoiseDb;
  parameters.beam.azimuth_width_deg = kAzimuthBeamDeg;
  parameters.pulse.length_m = kPulseBins * sonar.axes.range_bin_m();
  // No ray meets the body within 5 degrees of its normal for long: the specular terms are left out.
  parameters.materials["body"].gsab = {.a = 0.0, .b_deg = 4.0, .c = 1.0, .d = 1.5, .e = 0.0, .f_deg = 10.0};
  return parameters;
}

// The paper's values, its dB limits chosen as for the tank; errors of range and azimuth are bounded by what
// is known of pulse and beam, or they would smear the object over the background that the model does not
// have.
ParameterSet PaperInitial(const SonarModel& sonar) {
  ParameterSet initial;
  initial.display = {.db_min = 150.0, .db_max = 220.0};
  initial.materials["body"];
  initial.jitter.sigma_range_m = sonar.axes.range_bin_m();
  initial.jitter.sigma_azimuth_deg = 0.5 * kAzimuthBeamDeg;
  initial.jitter.reference_frequency_hz = sonar.frequency_hz;
  return initial;
}

// Pixels within reach of the object found in the recorded image: the model has no background to explain the
// rest by.
Mask AroundObject(const PolarImage& image, const SegmentationOptions& segmentation) {
  constexpr int kReachBins = 20;
  constexpr int kReachBeams = 4;
  const Mask object = Segment(image, segmentation).object;
  Mask around(object.rows(), object.cols());
  for (int row = 0; row < object.rows(); ++row) {
    for (int col = 0; col < object.cols(); ++col) {
      if (object(row, col) == 0) continue;
      for (int r = std::max(0, row - kReachBins); r <= std::min(object.rows() - 1, row + kReachBins); ++r) {
        for (int c = std::max(0, col - kReachBeams); c <= std::min(object.cols() - 1, col + kReachBeams);
             ++c) {
          around(r, c) = 1;
        }
      }
    }
  }
  return around;
}

}  // namespace

BombComparison CompareBomb(const std::filesystem::path& folder, const BombComparisonOptions& options) {
  const auto recorded = OpenAris3000Frames(folder);
  if (recorded->frame_count() < 2) {
    throw DataError("{}: {} frames, expected two: one to fit and one to judge", folder.string(),
                    recorded->frame_count());
  }
  BombComparison bomb;
  bomb.info = recorded->info();
  const Scene body = MakeBody();
  std::vector<Frame> frames = {recorded->ReadFrame(0), recorded->ReadFrame(1)};
  SonarModel sonar = bomb.info.sonar;
  const Water water = bomb.info.water.value_or(Water{});

  bomb.acoustic = AcousticFor(frames[0].image, sonar);
  PoseSearchOptions search;
  search.progress = options.on_note;
  if (options.quick) {
    search.yaw_steps = 12;
    search.pitches_deg = {25.0};
    search.refined_starts = 1;
    search.ray_height_deg = 0.2;
    search.max_iterations = 5;
    search.ridge_elevations_deg = {0.0};
  }
  bomb.pose = SearchPose(body, sonar, water, frames[0].image, bomb.acoustic, search);
  bomb.acoustic.receiver.gain_db += bomb.pose.best.gain_db;

  // A still scene: both frames have the pose found on the first.
  for (Frame& frame : frames) frame.info.world_from_sonar = bomb.pose.best.pose.WorldFromSonar();
  sonar.elevation_beam_width_deg = kElevationSpanDeg;
  RecordingInfo info = bomb.info;
  info.sonar = sonar;
  info.water = water;
  const MemoryRecording recording(info, frames);

  FitRecordingOptions fit;
  fit.rays.threads = options.threads;
  fit.rays.rays = fmt::format("{}x{}", 2 * sonar.axes.beam_count(), options.quick ? 140 : 560);
  fit.comparison = options.comparison;
  fit.fit.progress = options.on_note;
  fit.fit.starts = options.quick ? 1 : 4;
  fit.on_note = options.on_note;
  fit.config.held_out = {1};
  fit.config.bounds["jitter.sigma_range_m"] = {1e-4, 2.0 * sonar.axes.range_bin_m()};
  fit.config.bounds["jitter.sigma_azimuth_deg"] = {1e-3, kAzimuthBeamDeg};
  fit.pixels = AroundObject(frames[0].image, options.comparison.segmentation);
  fit.fit.block_beams = 4;
  bomb.fit = FitRecording(recording, body, PaperInitial(sonar), fit);

  SimulationOptions simulation = fit.rays.For(sonar, water);
  simulation.noise = true;
  const Simulator simulator(body, bomb.info.sonar, [&] {
    simulation.fan.elevation_span_deg = kElevationSpanDeg;
    return simulation;
  }());
  const EchoList echoes = simulator.TraceEchoes(*frames[1].info.world_from_sonar);
  const auto judge = [&](PolarImage image, const std::string& name, std::vector<FramePictures>* pictures) {
    image.scale = frames[1].image.scale;
    RecordingInfo simulated = info;
    simulated.source = name;
    simulated.synthetic = true;
    CompareRecordingsOptions compare{
        .compare = options.comparison, .as_displayed = true, .noise_floor = false};
    PictureMaker maker;
    return CompareRecordings(MemoryRecording(info, {frames[1]}),
                             MemoryRecording(simulated, {{frames[1].info, std::move(image)}}), compare,
                             [&](const PolarImage& real, const PolarImage& sim, const FrameMetrics& metrics) {
                               if (pictures != nullptr) pictures->push_back(maker.Make(real, sim, metrics));
                             });
  };
  bomb.acoustic_expected = judge(simulator.RenderExpected(echoes, bomb.acoustic),
                                 "expected image of the acoustic model", &bomb.acoustic_pictures);
  bomb.acoustic_sample =
      judge(simulator.RenderEchoes(echoes, bomb.acoustic), "speckled sample of the acoustic model", nullptr);
  return bomb;
}

}  // namespace sonarcal
