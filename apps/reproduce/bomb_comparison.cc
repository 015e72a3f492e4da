#include "apps/reproduce/bomb_comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "calib/bomb_fit.h"
#include "calib/models/held_out_frames.h"
#include "calib/noise/background_display.h"
#include "core/math/statistics.h"
#include "core/types/units.h"
#include "data_io/sonars/aris3000_frames_io.h"
#include "sim/paper/paper_values.h"
#include "sim/physics/receiver.h"
#include "sim/scenes/bomb.h"
#include "sim/scenes/scenes.h"

namespace sonarcal::reproduce {
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
  return UpperMedian(std::vector<float>(image.value.values().begin(), image.value.values().end()));
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
      MedianGrey(image) / image.scale.full_scale * *image.scale.db_span - sim::MeanLogSpeckleDb(1.0);
  parameters.receiver.gain_db = kEchoOverNoiseDb;
  parameters.beam.azimuth_width_deg = kAzimuthBeamDeg;
  parameters.pulse.length_m = kPulseBins * sonar.axes.range_bin_m();
  // No ray meets the body within 5 degrees of its normal for long: the specular terms are left out.
  parameters.materials["body"].gsab = {.a = 0.0, .b_deg = 4.0, .c = 1.0, .d = 1.5, .e = 0.0, .f_deg = 10.0};
  return parameters;
}

// Pixels within reach of the object found in the recorded image: the model has no background to explain the
// rest by.
Mask AroundObject(const PolarImage& image, const metrics::SegmentationOptions& segmentation) {
  constexpr int kReachBins = 20;
  constexpr int kReachBeams = 4;
  const Mask object = metrics::Segment(image, segmentation).object;
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

// Pixels out of reach of the object found in the image.
Mask Background(const PolarImage& image, const metrics::SegmentationOptions& segmentation) {
  Mask background = metrics::BoxAround(metrics::Segment(image, segmentation).object, 20, 8);
  for (std::uint8_t& pixel : background.values()) pixel = pixel == 0 ? 1 : 0;
  return background;
}

// Of all echoes but the rarest 0.1 % at either end.
workflow::IncidenceRange IncidenceOf(const sim::EchoList& echoes) {
  if (echoes.incidence_rad.empty()) return {};
  const auto at = [&](double share) {
    return DegFromRad(double{LowerQuantile(echoes.incidence_rad, share)});
  };
  return {.low_deg = at(0.001), .high_deg = at(0.999)};
}

class Comparison {
 public:
  Comparison(const std::filesystem::path& folder, const BombComparisonOptions& options)
      : options_(options), recorded_(data_io::OpenAris3000Frames(folder)) {
    if (recorded_->frame_count() < 2) {
      throw DataError("{}: {} frames, expected two: one to fit and one to judge", folder.string(),
                      recorded_->frame_count());
    }
    calib::CheckHeldOut(*recorded_, {.used = {0}, .held_out = {1}});
    frames_ = {recorded_->ReadFrame(0), recorded_->ReadFrame(1)};
    water_ = recorded_->info().water.value_or(Water{});
    bomb_.info = recorded_->info();
  }

  BombComparison Run() {
    Search();
    Say("fitting the paper's model at the pose found");
    bomb_.fit = FitPaper(sim::MakeBody(), bomb_.pose.best.pose);
    JudgeAsFound();
    Say("fitting both models with the outline and the pose found beforehand");
    bomb_.fitted.paper = FitPaper(sim::MakeBomb(), calib::BombPose());
    FitAcoustic();
    bomb_.real_against_real = Judge({frames_[1]}, {frames_[0].image}, "the other recorded frame", false);
    return std::move(bomb_);
  }

 private:
  void Say(const std::string& line) const {
    if (options_.on_note) options_.on_note(line);
  }

  void Search() {
    const Scene body = sim::MakeBody();
    const SonarModel& sonar = recorded_->info().sonar;
    bomb_.acoustic = AcousticFor(frames_[0].image, sonar);
    calib::PoseSearchOptions search;
    search.progress = options_.on_note;
    if (options_.quick) {
      search.yaw_steps = 12;
      search.pitches_deg = {25.0};
      search.refined_starts = 1;
      search.ray_height_deg = 0.2;
      search.max_iterations = 5;
      search.ridge_elevations_deg = {0.0};
    }
    bomb_.pose = calib::SearchPose(body, sonar, water_, frames_[0].image, bomb_.acoustic, search);
    bomb_.acoustic.receiver.gain_db += bomb_.pose.best.gain_db;
  }

  // A still scene: both frames have the pose of the first.
  workflow::RecordingFit FitPaper(const Scene& body, const calib::TargetPose& pose) const {
    RecordingInfo info = recorded_->info();
    info.sonar.elevation_beam_width_deg = kElevationSpanDeg;
    info.water = water_;
    std::vector<Frame> frames = frames_;
    for (Frame& frame : frames) frame.info.world_from_sonar = pose.WorldFromSonar();
    workflow::FitRecordingOptions fit;
    fit.rays = Rays();
    fit.comparison = options_.comparison;
    fit.fit.progress = options_.on_note;
    fit.fit.starts = options_.quick ? 1 : 4;
    fit.on_note = options_.on_note;
    fit.config.held_out = {1};
    // Errors are bounded by what is known of pulse and beam. Wider ones would smear the object over the
    // background that the model does not have.
    fit.config.bounds["jitter.sigma_range_m"] = {1e-4, 2.0 * info.sonar.axes.range_bin_m()};
    fit.config.bounds["jitter.sigma_azimuth_deg"] = {1e-3, kAzimuthBeamDeg};
    fit.pixels = AroundObject(frames[0].image, options_.comparison.segmentation);
    fit.fit.block_beams = 4;
    SonarModel sonar = info.sonar;
    sonar.azimuth_beam_width_deg = kAzimuthBeamDeg;
    return workflow::FitRecording(MemoryRecording(info, frames), body, sim::PaperValues(sonar, {"body"}),
                                  fit);
  }

  void JudgeAsFound() {
    sim::SimulationOptions simulation = Rays().For(recorded_->info().sonar, water_, EchoModel::kAcoustic);
    simulation.noise = true;
    simulation.fan.elevation_span_deg = kElevationSpanDeg;
    const sim::Simulator simulator(sim::MakeBody(), recorded_->info().sonar, simulation);
    const sim::EchoList echoes = simulator.TraceEchoes(bomb_.pose.best.pose.WorldFromSonar());
    bomb_.acoustic_expected = Judge({frames_[1]}, {simulator.RenderExpected(echoes, bomb_.acoustic)},
                                    "expected image of the acoustic model", true, &bomb_.acoustic_pictures);
    bomb_.acoustic_sample = Judge({frames_[1]}, {simulator.RenderEchoes(echoes, bomb_.acoustic)},
                                  "speckled sample of the acoustic model", true);
  }

  void FitAcoustic() {
    BombComparison::Fitted& fitted = bomb_.fitted;
    const SonarModel& sonar = recorded_->info().sonar;
    const PolarImage& image = frames_[0].image;
    const DisplayParameters<double> display = DisplayOfBackground(image, options_.comparison.segmentation);
    calib::TargetFitOptions options = calib::BombFitOptions();
    options.threads = options_.threads;
    options.fit.progress = options_.on_note;
    if (options_.quick) {
      options.ray_height_deg = 0.2;
      options.fit.max_iterations = 5;
    }
    fitted.acoustic.initial = calib::BombInitial(display, sonar);
    calib::TargetFit fit = calib::FitTarget(sim::MakeBomb(), sonar, water_, image, calib::BombPose(),
                                            fitted.acoustic.initial, options);
    fitted.acoustic.fit = {std::move(fit.fit.parameters), std::move(fit.fit.report), fit.fit.usable};
    fitted.acoustic.fit.report.frames_held_out = {1};
    if (!fit.fit.usable) return;
    const sim::Simulator simulator(fit.placed, sonar, fit.simulation);
    const sim::EchoList echoes = simulator.TraceEchoes(fit.fit.world_from_sonar[0]);
    fitted.acoustic.seen["body"] = IncidenceOf(echoes);
    const ParameterSet& parameters = fitted.acoustic.fit.parameters;
    const PolarImage expected = simulator.RenderExpected(echoes, parameters);
    fitted.expected = Judge({frames_[1]}, {expected}, "expected image of the fitted acoustic model", true,
                            &fitted.expected_pictures);
    std::vector<PolarImage> draws;
    draws.reserve(BombComparison::kDraws);
    for (int draw = 0; draw < BombComparison::kDraws; ++draw)
      draws.push_back(simulator.RenderEchoes(echoes, parameters, draw));
    const std::string name = "speckled samples of the fitted acoustic model";
    fitted.samples = Judge(std::vector<Frame>(draws.size(), frames_[1]), draws, name, true);
    Judge({frames_[1]}, {draws.front()}, name, true, &fitted.sample_pictures);
    std::vector<Frame> sampled(draws.size(), frames_[1]);
    for (std::size_t i = 0; i < draws.size(); ++i) sampled[i].image.value = draws[i].value;
    fitted.floor = Judge(sampled, std::vector<PolarImage>(draws.size(), expected),
                         "expected image against its own samples", true);
  }

  // Images in the place of recorded frames, one by one.
  metrics::MetricsReport Judge(const std::vector<Frame>& real, std::vector<PolarImage> images,
                               const std::string& name, bool synthetic,
                               std::vector<report::FramePictures>* pictures = nullptr) const {
    const RecordingInfo& info = recorded_->info();
    RecordingInfo simulated = info;
    simulated.source = name;
    simulated.synthetic = synthetic;
    std::vector<Frame> frames;
    for (std::size_t i = 0; i < images.size(); ++i) {
      images[i].scale = real[i].image.scale;
      frames.push_back({real[i].info, std::move(images[i])});
    }
    const workflow::CompareRecordingsOptions compare{
        .compare = options_.comparison, .as_displayed = true, .noise_floor = false};
    report::PictureMaker maker;
    return workflow::CompareRecordings(
        MemoryRecording(info, real), MemoryRecording(simulated, std::move(frames)), compare,
        [&](const PolarImage& r, const PolarImage& s, const metrics::FrameMetrics& metrics) {
          if (pictures == nullptr) return;
          pictures->push_back(maker.Make(r, s, metrics));
          pictures->back().index = 1;  // in the recording
        });
  }

  workflow::RayOptions Rays() const {
    workflow::RayOptions rays(sim::Sampling::kBeams);
    rays.threads = options_.threads;
    rays.rays = RayGridSize{2 * recorded_->info().sonar.axes.beam_count(), options_.quick ? 140 : 560};
    return rays;
  }

  const BombComparisonOptions& options_;
  std::unique_ptr<RecordingSource> recorded_;
  std::vector<Frame> frames_;
  Water water_;
  BombComparison bomb_;
};

}  // namespace

DisplayParameters<double> DisplayOfBackground(const PolarImage& image,
                                              const metrics::SegmentationOptions& segmentation) {
  return calib::FitBackgroundDisplay(image, Background(image, segmentation), DisplayLaw::kSoftAmplitude)
      .display;
}

KnownBomb PrepareBomb(const std::filesystem::path& folder, const metrics::SegmentationOptions& segmentation) {
  const auto recorded = data_io::OpenAris3000Frames(folder);
  RecordingInfo info = recorded->info();
  info.sonar.elevation_beam_width_deg = kElevationSpanDeg;
  std::vector<Frame> frames;
  for (int i = 0; i < recorded->frame_count(); ++i) {
    frames.push_back(recorded->ReadFrame(i));
    frames.back().info.world_from_sonar = calib::BombPose().WorldFromSonar();
  }
  const DisplayParameters<double> display = DisplayOfBackground(frames.at(0).image, segmentation);
  ParameterSet initial = calib::BombInitial(display, info.sonar);
  return {std::make_unique<MemoryRecording>(std::move(info), std::move(frames)), sim::MakeBomb(),
          std::move(initial)};
}

BombComparison CompareBomb(const std::filesystem::path& folder, const BombComparisonOptions& options) {
  return Comparison(folder, options).Run();
}

}  // namespace sonarcal::reproduce
