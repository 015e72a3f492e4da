#include "apps/reproduce/target_comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/workflow/locate.h"
#include "calib/models/held_out_frames.h"
#include "core/imaging/change_scale.h"
#include "core/math/statistics.h"
#include "core/types/units.h"
#include "data_io/recordings/recording_io.h"
#include "sim/paper/paper_image.h"
#include "sim/paper/paper_values.h"

namespace sonarcal::reproduce {
namespace {

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

// Range of incidence of the echoes, without the rarest 0.1 % at either end.
workflow::IncidenceRange IncidenceOf(const sim::EchoList& echoes) {
  if (echoes.incidence_rad.empty()) return {};
  const auto at = [&](double share) {
    return DegFromRad(double{LowerQuantile(echoes.incidence_rad, share)});
  };
  return {.low_deg = at(0.001), .high_deg = at(0.999)};
}

// All frames of a recording of a static scene, from one pose.
std::vector<Frame> FramesFrom(const Pose& world_from_sonar, const RecordingSource& recorded) {
  std::vector<Frame> frames;
  for (int i = 0; i < recorded.frame_count(); ++i) {
    frames.push_back(recorded.ReadFrame(i));
    frames.back().info.world_from_sonar = world_from_sonar;
  }
  return frames;
}

class Comparison {
 public:
  Comparison(const CasePlan& plan, const std::filesystem::path& images,
             const TargetComparisonOptions& options)
      : options_(options),
        target_(TargetOf(plan)),
        material_(target_.scene.material_names.front()),
        recorded_(OpenTarget(plan, images)) {
    comparison_.segmentation = target_.segmentation;
    frames_ = {recorded_->ReadFrame(target_.fitted_frame), recorded_->ReadFrame(target_.held_out_frame)};
    result_.plan = plan;
    result_.info = InfoOf(target_, *recorded_);
    water_ = result_.info.water.value_or(Water{});
  }

  TargetComparison Run() {
    Search();
    EvaluateAsFound();
    Say("fitting the paper's model at the pose found");
    result_.paper = FitPaper();
    Say("fitting the acoustic model at the pose found");
    FitAcoustic();
    result_.real_against_real =
        Compare({frames_[1]}, {frames_[0].image}, "the other frame", result_.info.synthetic);
    return std::move(result_);
  }

 private:
  void Say(const std::string& line) const {
    if (options_.on_note) options_.on_note(line);
  }

  // As `sonarcal locate` does without parameters.
  void Search() {
    workflow::LocateOptions locate;
    locate.threads = options_.threads;
    if (options_.quick) {
      locate.spacing = 40.0;
      locate.starts = 1;
      locate.ray_height = 0.2;
      locate.max_iterations = 5;
    }
    workflow::Location location =
        workflow::Locate(MemoryRecording(result_.info, {frames_[0]}), target_.scene, {0}, locate, {},
                         {.progress = {}, .message = options_.on_note, .stop = {}});
    result_.pose = std::move(location.frames.front().search);
    result_.acoustic = std::move(location.parameters);
  }

  // A static scene: both frames have one pose.
  workflow::RecordingFit FitPaper() const {
    RecordingInfo info = result_.info;
    info.sonar.elevation_beam_width_deg = target_.elevation_span_deg;
    info.water = water_;
    workflow::FitRecordingOptions fit;
    fit.rays = Rays();
    fit.comparison = comparison_;
    fit.fit.progress = options_.on_note;
    fit.fit.starts = options_.quick ? 1 : 4;
    fit.on_note = options_.on_note;
    fit.config.used = {target_.fitted_frame};
    fit.config.held_out = {target_.held_out_frame};
    // Errors are bounded by what is known of pulse and beam. Wider ones would smear the object over the
    // background that the model does not have.
    fit.config.bounds["jitter.sigma_range_m"] = {1e-4, 2.0 * info.sonar.axes.range_bin_m()};
    fit.config.bounds["jitter.sigma_azimuth_deg"] = {1e-3, target_.azimuth_beam_width_deg};
    fit.pixels = AroundObject(frames_[0].image, comparison_.segmentation);
    fit.fit.block_beams = 4;
    SonarModel sonar = info.sonar;
    sonar.azimuth_beam_width_deg = target_.azimuth_beam_width_deg;
    return workflow::FitRecording(
        MemoryRecording(info, FramesFrom(result_.pose.best().WorldFromSonar(), *recorded_)), target_.scene,
        sim::PaperValues(sonar, target_.scene.material_names), fit);
  }

  void EvaluateAsFound() {
    sim::SimulationOptions simulation = Rays().For(recorded_->info().sonar, water_, EchoModel::kAcoustic);
    simulation.noise = true;
    simulation.fan.elevation_span_deg = target_.elevation_span_deg;
    const sim::Simulator simulator(target_.scene, recorded_->info().sonar, simulation);
    const sim::EchoList echoes = simulator.TraceEchoes(result_.pose.best().WorldFromSonar());
    result_.acoustic_expected =
        Compare({frames_[1]}, {OnRecordedScale(simulator.RenderExpected(echoes, result_.acoustic))},
                "expected image of the acoustic model", true);
    result_.acoustic_samples = CompareSamples(Samples(simulator, echoes, result_.acoustic),
                                              "speckled samples of the acoustic model");
  }

  // A simulated image in whole grey levels of the held-out frame.
  PolarImage OnRecordedScale(PolarImage image) const {
    ChangeScale(frames_[1].image.scale, image);
    sim::QuantiseImage(image);
    return image;
  }

  std::vector<PolarImage> Samples(const sim::Simulator& simulator, const sim::EchoList& echoes,
                                  const ParameterSet& parameters) const {
    std::vector<PolarImage> samples;
    samples.reserve(TargetComparison::kDraws);
    for (int draw = 0; draw < TargetComparison::kDraws; ++draw)
      samples.push_back(OnRecordedScale(simulator.RenderEchoes(echoes, parameters, draw)));
    return samples;
  }

  metrics::MetricsReport CompareSamples(const std::vector<PolarImage>& samples,
                                        const std::string& name) const {
    return Compare(std::vector<Frame>(samples.size(), frames_[1]), samples, name, true);
  }

  void FitAcoustic() {
    TargetComparison::Fitted& fitted = result_.fitted;
    const SonarModel& sonar = recorded_->info().sonar;
    const PolarImage& image = frames_[0].image;
    calib::TargetFitOptions options = target_.fit;
    options.threads = options_.threads;
    options.fit.progress = options_.on_note;
    if (options_.quick) {
      options.ray_height_deg = 0.2;
      options.fit.max_iterations = 5;
    }
    fitted.acoustic.initial = TargetStart(target_, image);
    calib::TargetFit fit = calib::FitTarget(target_.scene, sonar, water_, image, result_.pose.best().pose,
                                            fitted.acoustic.initial, options);
    fitted.acoustic.fit = {std::move(fit.fit.parameters), std::move(fit.fit.report), fit.fit.usable};
    fitted.acoustic.fit.report.frames_used = {target_.fitted_frame};
    fitted.acoustic.fit.report.frames_held_out = {target_.held_out_frame};
    if (!fit.fit.usable) return;
    const sim::Simulator simulator(fit.placed, sonar, fit.simulation);
    const sim::EchoList echoes = simulator.TraceEchoes(fit.fit.world_from_sonar[0]);
    fitted.acoustic.seen[material_] = IncidenceOf(echoes);
    const ParameterSet& parameters = fitted.acoustic.fit.parameters;
    const PolarImage expected = OnRecordedScale(simulator.RenderExpected(echoes, parameters));
    fitted.expected = Compare({frames_[1]}, {expected}, "expected image of the fitted acoustic model", true,
                              &fitted.expected_frames);
    const std::vector<PolarImage> samples = Samples(simulator, echoes, parameters);
    const std::string name = "speckled samples of the fitted acoustic model";
    fitted.samples = CompareSamples(samples, name);
    Compare({frames_[1]}, {samples.front()}, name, true, &fitted.sample_frames);
    std::vector<Frame> sampled(samples.size(), frames_[1]);
    for (std::size_t i = 0; i < samples.size(); ++i) sampled[i].image.value = samples[i].value;
    fitted.floor = Compare(sampled, std::vector<PolarImage>(samples.size(), expected),
                           "expected image against its own samples", true);
  }

  // Images in the place of the held-out frame, one by one.
  metrics::MetricsReport Compare(const std::vector<Frame>& real, const std::vector<PolarImage>& images,
                                 const std::string& name, bool synthetic,
                                 std::vector<workflow::ComparedFrame>* compared = nullptr) const {
    const RecordingInfo& info = result_.info;
    RecordingInfo simulated = info;
    simulated.source = name;
    simulated.synthetic = synthetic;
    std::vector<Frame> frames;
    for (std::size_t i = 0; i < images.size(); ++i) frames.push_back({real[i].info, images[i]});
    const workflow::CompareRecordingsOptions compare{
        .compare = comparison_, .as_displayed = true, .noise_floor = false};
    metrics::MetricsReport report = workflow::CompareRecordings(
        MemoryRecording(info, real), MemoryRecording(simulated, std::move(frames)), compare,
        [&](const PolarImage& r, const PolarImage& s, const metrics::FrameMetrics& metrics) {
          if (compared == nullptr) return;
          compared->push_back({r, s, metrics});
          compared->back().metrics.index = target_.held_out_frame;
        });
    for (metrics::FrameMetrics& frame : report.frames) frame.index = target_.held_out_frame;
    return report;
  }

  workflow::RayOptions Rays() const {
    workflow::RayOptions rays(sim::Sampling::kBeams);
    rays.threads = options_.threads;
    rays.rays = RayGridSize{2 * recorded_->info().sonar.axes.beam_count(), options_.quick ? 140 : 560};
    return rays;
  }

  const TargetComparisonOptions& options_;
  const TargetCase& target_;
  std::string material_;
  std::unique_ptr<RecordingSource> recorded_;
  metrics::CompareOptions comparison_;
  std::vector<Frame> frames_;
  Water water_;
  TargetComparison result_;
};

}  // namespace

const TargetCase& TargetOf(const CasePlan& plan) {
  const auto* target = std::get_if<TargetCase>(&plan.study);
  if (target == nullptr) throw DataError("{}: expected a case of a target", plan.folder.string());
  return *target;
}

std::unique_ptr<RecordingSource> OpenTarget(const CasePlan& plan, const std::filesystem::path& images) {
  const TargetCase& target = TargetOf(plan);
  auto recording = data_io::OpenRecordingOf(images, plan.folder);
  const int last = std::max(target.fitted_frame, target.held_out_frame);
  if (recording->frame_count() <= last) {
    throw DataError("{}: {} frames, expected at least {}", (plan.folder / "recording.json").string(),
                    recording->frame_count(), last + 1);
  }
  calib::CheckHeldOut(*recording, {.used = {target.fitted_frame}, .held_out = {target.held_out_frame}});
  return recording;
}

RecordingInfo InfoOf(const TargetCase& target, const RecordingSource& recorded) {
  RecordingInfo info = recorded.info();
  if (target.water) info.water = target.water;
  return info;
}

ParameterSet TargetStart(const TargetCase& target, const PolarImage& image) {
  ParameterSet start = target.start;
  start.display = workflow::DisplayOfBackground(image, target.segmentation);
  return start;
}

PosedTarget PoseTarget(const CasePlan& plan, const std::filesystem::path& images) {
  const TargetCase& target = TargetOf(plan);
  const auto recorded = OpenTarget(plan, images);
  RecordingInfo info = InfoOf(target, *recorded);
  info.sonar.elevation_beam_width_deg = target.elevation_span_deg;
  std::vector<Frame> frames = FramesFrom(target.pose.WorldFromSonar(), *recorded);
  ParameterSet start = TargetStart(target, frames.at(target.fitted_frame).image);
  return {std::make_unique<MemoryRecording>(std::move(info), std::move(frames)), target.scene,
          std::move(start)};
}

TargetComparison CompareTarget(const CasePlan& plan, const std::filesystem::path& images,
                               const TargetComparisonOptions& options) {
  return Comparison(plan, images, options).Run();
}

}  // namespace sonarcal::reproduce
