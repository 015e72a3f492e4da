#include "apps/workflow/explain.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "apps/workflow/fit.h"
#include "apps/workflow/fit_frames.h"
#include "apps/workflow/scene_geometry.h"
#include "apps/workflow/simulate.h"
#include "calib/acoustic_fit.h"
#include "calib/models/held_out_frames.h"
#include "core/imaging/change_scale.h"
#include "core/math/local_sums.h"
#include "core/types/error.h"
#include "core/types/units.h"
#include "data_io/parameters/parameters_io.h"
#include "data_io/pose_io.h"
#include "data_io/recordings/recording_io.h"
#include "metrics/segmentation/region.h"
#include "metrics/segmentation/segmentation.h"
#include "sim/gathered/echo_causes.h"
#include "sim/gathered/empty_frames.h"
#include "sim/paper/paper_image.h"
#include "sim/physics/display.h"

namespace sonarcal::workflow {

namespace {

void CheckExplainable(const RecordingSource& recording, const ParameterSet& given) {
  if (given.model != EchoModel::kAcoustic) {
    throw DataError("the parameters name the model '{}', but only 'acoustic' can be explained",
                    ToString(given.model));
  }
  const RecordingInfo& info = recording.info();
  if (info.scale.quantity != Quantity::kGrey) {
    throw DataError("{}: the images hold {}, expected grey levels", info.source,
                    ToString(info.scale.quantity));
  }
  if (recording.frame_count() < 2) {
    throw DataError("{}: one frame, expected at least two: one to fit and one to evaluate on", info.source);
  }
}

// A recording of the held-out frames only; with `images` in place of the recorded ones, if given.
MemoryRecording AsRecording(const RecordingSource& recorded, const std::vector<calib::GreyFrame>& frames,
                            const std::vector<PolarImage>* images) {
  RecordingInfo info = recorded.info();
  if (images != nullptr) {
    info.source = "expected";
    info.synthetic = true;
  }
  std::vector<Frame> all;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    Frame frame{recorded.frame_info(frames[f].index), images != nullptr ? (*images)[f] : frames[f].image};
    frame.image.scale = info.scale;
    sim::QuantiseImage(frame.image);
    all.push_back(std::move(frame));
  }
  return {std::move(info), std::move(all)};
}

// Mean absolute difference over the used pixels, as a fraction of full scale.
std::optional<double> MeanDifference(const std::vector<PolarImage>& a, const std::vector<PolarImage>& b,
                                     const std::vector<calib::GreyFrame>& frames) {
  double sum = 0.0;
  double count = 0.0;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    for (std::size_t i = 0; i < a[f].value.size(); ++i) {
      if (!frames[f].use.empty() && frames[f].use[i] == 0) continue;
      sum += std::abs(a[f].value.values()[i] - b[f].value.values()[i]) / a[f].scale.full_scale;
      count += 1.0;
    }
  }
  if (count == 0.0) return std::nullopt;
  return sum / count;
}

class RecordingExplainer {
 public:
  RecordingExplainer(const RecordingSource& recording, const Scene& scene, const ParameterSet& given,
                     const ExplainRecordingOptions& options)
      : recording_(recording), options_(options), given_(given) {
    CheckExplainable(recording, given);
    if (options.comparison.object) CheckObject(*options.comparison.object, scene.material_names);
    CheckRayWeight(options.rays.ray_weight, given.model);
    const SonarModel& sonar = recording.info().sonar;
    calib::FitConfig config{.held_out = options.held_out};
    result_.split = calib::SplitFrames(config, recording.frame_count());
    CheckSettings(recording, result_.split);
    calib::CheckHeldOut(recording, result_.split);
    const std::vector<data_io::TimedPose> poses = data_io::PosesOfRecording(recording);
    used_ = GreyFrames(recording, poses, result_.split.used);
    held_out_ = GreyFrames(recording, poses, result_.split.held_out);
    const WaterChoice water = ChooseWater(given, recording.info().water);
    Say(water.note);
    Say(TakeDisplay(recording.info().scale, given_));
    explain_ = {.simulation = AcousticSimulation(options.rays, sonar, water.water, given_),
                .fit = options.fit,
                .hold_noise = options.hold_noise,
                .poses = options.poses,
                .on_step = options.on_step};
    result_.rays = {explain_.simulation.fan.cols, explain_.simulation.fan.rows};
    simulator_.emplace(scene, sonar, explain_.simulation);
    Say(sim::CheckSceneIsSeen(*simulator_, data_io::PosesAlone(poses), result_.split.used));
    result_.explanation = calib::Explain(scene, sonar, used_, held_out_, given_, explain_);
    if (options.comparison.object) geometry_.emplace(simulator_->caster(), sonar);
  }

  ExplainedRecording Run() {
    Judge();
    result_.cause_names = {"not bright", "not explained"};
    for (std::size_t f = 0; f < held_out_.size(); ++f) result_.maps.push_back(MapOf(f));
    CountShares();
    return std::move(result_);
  }

 private:
  void Say(const std::string& sentence) const {
    if (options_.on_note && !sentence.empty()) options_.on_note(sentence);
  }

  // Speckled sample of a step's model in each held-out frame.
  std::vector<PolarImage> Drawn(const calib::ExplainedStep& step) const {
    std::vector<PolarImage> images;
    for (std::size_t f = 0; f < held_out_.size(); ++f) {
      const Pose& pose = step.poses_held_out[f];
      const std::vector<PingPose>& pings = held_out_[f].pings;
      images.push_back(
          pings.empty()
              ? simulator_->RenderEchoes(simulator_->TraceEchoes(pose), step.parameters,
                                         kFirstSample + held_out_[f].index,
                                         simulator_->TraceGhosts(pose, step.parameters))
              : simulator_->RenderPings(pose, pings, step.parameters, kFirstSample + held_out_[f].index));
      ChangeScale(held_out_[f].image.scale, images.back());
    }
    return images;
  }

  // Images of a step's model in the held-out frames.
  struct Shown {
    std::vector<PolarImage> expected;
    std::vector<PolarImage> draws;  // empty if the step models no speckle
  };

  // Held-out frames that use only the pixels around the object.
  std::vector<calib::GreyFrame> AboutObject() const {
    const metrics::CompareOptions& rule = options_.comparison;
    const std::optional<Mask>& valid = recording_.info().valid;
    std::vector<calib::GreyFrame> about = held_out_;
    for (calib::GreyFrame& frame : about) {
      std::optional<Mask> region = rule.region;
      if (geometry_) {
        const metrics::PixelBox box = geometry_->ObjectBox(frame.world_from_sonar, *rule.object);
        region = Both(region, metrics::MaskOf(box, frame.image.value.rows(), frame.image.value.cols()));
      }
      const Mask object = metrics::Segment(frame.image, rule.segmentation, region ? &*region : nullptr,
                                           valid ? &*valid : nullptr)
                              .object;
      const Mask near = metrics::Dilated(object, kAboutBins, kAboutBeams);
      if (frame.use.empty()) frame.use.assign(near.size(), 1);
      for (std::size_t i = 0; i < near.size(); ++i) {
        if (near.values()[i] == 0) frame.use[i] = 0;
      }
    }
    return about;
  }

  void Judge() {
    about_object_ = AboutObject();
    result_.judged.frames = result_.split.held_out;
    for (const int frame : result_.split.held_out) result_.by_frame.push_back({.frames = {frame}});
    std::vector<std::size_t> all(held_out_.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    for (const calib::ExplainedStep& step : result_.explanation.steps) {
      const Shown shown{calib::ExpectedGrey(step, held_out_),
                        step.knows_speckle ? Drawn(step) : std::vector<PolarImage>{}};
      JudgeStep(shown, step.poses_held_out, all,
                {.likelihood = step.held_out,
                 .gain = step.gain,
                 .error = step.error_held_out,
                 .error_change = step.error_change,
                 .verdict = step.verdict},
                result_.judged);
      if (&step == &result_.explanation.steps.back()) {
        result_.metrics_after = Compared(held_out_, shown.expected, step.poses_held_out);
        if (!shown.draws.empty())
          result_.sample_metrics_after = Compared(held_out_, shown.draws, step.poses_held_out);
      }
      for (const std::size_t f : all)
        JudgeStep(shown, step.poses_held_out, {f}, step.by_frame[f], result_.by_frame[f]);
    }
  }

  void JudgeStep(const Shown& shown, const std::vector<Pose>& poses_held_out,
                 const std::vector<std::size_t>& of, const calib::JudgedFrame& by,
                 JudgedSteps& judged) const {
    judged.nats_per_pixel.push_back(by.likelihood.PerPixel());
    judged.gain.push_back(by.gain);
    judged.median_error.push_back(by.error.PerPixel());
    judged.error_change.push_back(by.error_change);
    judged.verdict.push_back(by.verdict);
    std::vector<calib::GreyFrame> frames;
    std::vector<calib::GreyFrame> about;
    std::vector<PolarImage> recorded;
    std::vector<PolarImage> expected;
    std::vector<PolarImage> draws;
    for (const std::size_t f : of) {
      about.push_back(about_object_[f]);
      frames.push_back(held_out_[f]);
      recorded.push_back(held_out_[f].image);
      expected.push_back(shown.expected[f]);
      if (!shown.draws.empty()) draws.push_back(shown.draws[f]);
    }
    StepFigures figures{.intensity_error = MeanDifference(recorded, expected, frames)};
    figures.about_error = MeanDifference(recorded, expected, about);
    std::vector<Pose> poses;
    for (const std::size_t f : of) poses.push_back(poses_held_out[f]);
    const metrics::ViewSummary of_expected = Pooled(frames, expected, poses);
    figures.union_error = of_expected.Over(metrics::IntensityDomain::kUnion).mean_absolute.value;
    figures.overlap_error = of_expected.Over(metrics::IntensityDomain::kOverlap).mean_absolute.value;
    const metrics::ViewSummary of_shown = draws.empty() ? of_expected : Pooled(frames, draws, poses);
    figures.iou = of_shown.At("iou").value;
    figures.ns_over_nr = of_shown.At("ns_over_nr").value;
    if (!draws.empty()) {
      judged.floor_error = MeanDifference(draws, expected, frames);
      judged.about_floor_error = MeanDifference(draws, expected, about);
    }
    judged.figures.push_back(figures);
  }

  metrics::ViewSummary Pooled(const std::vector<calib::GreyFrame>& frames,
                              const std::vector<PolarImage>& images, const std::vector<Pose>& poses) const {
    return Compared(frames, images, poses).aggregate.micro.polar;
  }

  // Compares the frames with images that were simulated from `poses`.
  metrics::MetricsReport Compared(const std::vector<calib::GreyFrame>& frames,
                                  const std::vector<PolarImage>& images,
                                  const std::vector<Pose>& poses) const {
    CompareRecordingsOptions judge{
        .compare = options_.comparison, .as_displayed = true, .noise_floor = false};
    for (std::size_t f = 0; geometry_ && f < poses.size(); ++f)
      judge.boxes[static_cast<int>(f)] = geometry_->ObjectBox(poses[f], *judge.compare.object);
    metrics::MetricsReport report = CompareRecordings(AsRecording(recording_, frames, nullptr),
                                                      AsRecording(recording_, frames, &images), judge);
    for (std::size_t f = 0; f < frames.size(); ++f) report.frames[f].index = frames[f].index;
    return report;
  }

  std::uint8_t NameIndex(const sim::EchoCause& cause) {
    const auto found = std::find(result_.cause_names.begin(), result_.cause_names.end(), cause.name);
    const auto index = static_cast<std::uint8_t>(found - result_.cause_names.begin());
    if (found == result_.cause_names.end()) {
      SONARCAL_CHECK(result_.cause_names.size() < 256, "{} causes", result_.cause_names.size());
      result_.cause_names.push_back(cause.name);
    }
    return index;
  }

  CauseMap MapOf(std::size_t f) {
    constexpr double kHalfWidths = 1.5;
    const calib::ExplainedStep& last = result_.explanation.steps.back();
    const calib::GreyFrame& frame = held_out_[f];
    const sim::EchoCauses causes = sim::CausesOf(*simulator_, last.poses_held_out[f], last.parameters);
    const Grid<int> largest = causes.Largest();
    const PolarAxes& axes = frame.image.axes;
    const std::vector<calib::RecordedPower> powers = calib::RecordedPowers(frame.image, given_.display);
    Grid<double> recorded(axes.range_bins, axes.beam_count());
    Grid<double> expected(axes.range_bins, axes.beam_count());
    for (std::size_t i = 0; i < recorded.size(); ++i) {
      recorded.values()[i] = powers[i].power;
      for (const sim::EchoCause& cause : causes.causes) expected.values()[i] += cause.power.values()[i];
    }
    const auto half = [&](double width, double spacing) {
      return static_cast<int>(std::lround(kHalfWidths * std::max(1.0, width / spacing)));
    };
    const ParameterSet complete = sim::WithResponse(simulator_->sonar(), last.parameters);
    const int half_bins = half(complete.pulse.length_m, axes.range_bin_m());
    const int half_beams = half(complete.beam.azimuth_width_deg, DegFromRad(axes.beam_spacing_rad()));
    const Grid<double> recorded_about = BoxMean(recorded, 2 * half_bins + 1, 2 * half_beams + 1);
    const Grid<double> expected_about = BoxMean(expected, 2 * half_bins + 1, 2 * half_beams + 1);
    std::vector<std::uint8_t> names;
    for (const sim::EchoCause& cause : causes.causes) names.push_back(NameIndex(cause));
    CauseMap map{.index = frame.index,
                 .cause = Grid<std::uint8_t>(axes.range_bins, axes.beam_count()),
                 .lobe_of = Grid<int>(axes.range_bins, axes.beam_count()),
                 .recorded = frame.image};
    for (std::size_t i = 0; i < recorded.size(); ++i) {
      map.lobe_of.values()[i] = -1;
      const double noise = causes.causes.front().power.values()[i];
      const bool counts = frame.use.empty() || frame.use[i] != 0;
      if (!counts || !(recorded_about.values()[i] > kBrightRatio * noise)) continue;
      if (recorded_about.values()[i] > kUnexplainedRatio * expected_about.values()[i]) {
        map.cause.values()[i] = kUnexplained;
        continue;
      }
      const int cause = largest.values()[i];
      map.cause.values()[i] = names[cause];
      if (causes.causes[cause].kind == sim::CauseKind::kAzimuthLobe)
        map.lobe_of.values()[i] = causes.lobe_of.values()[i];
    }
    return map;
  }

  void CountShares() {
    result_.cause_shares.assign(result_.cause_names.size(), 0.0);
    double bright = 0.0;
    for (const CauseMap& map : result_.maps) {
      for (const std::uint8_t cause : map.cause.values()) {
        if (cause == kNotBright) continue;
        result_.cause_shares[cause] += 1.0;
        bright += 1.0;
      }
    }
    for (double& share : result_.cause_shares) share = bright > 0.0 ? share / bright : 0.0;
  }

  const RecordingSource& recording_;
  const ExplainRecordingOptions& options_;
  ParameterSet given_;
  calib::ExplainOptions explain_;
  std::vector<calib::GreyFrame> used_;
  std::vector<calib::GreyFrame> held_out_;
  std::vector<calib::GreyFrame> about_object_;
  std::optional<sim::Simulator> simulator_;
  std::optional<SceneGeometry> geometry_;  // with --object
  ExplainedRecording result_;
};

}  // namespace

ExplainedRecording ExplainRecording(const RecordingSource& recording, const Scene& scene,
                                    const ParameterSet& given, const ExplainRecordingOptions& options) {
  RecordingExplainer explainer(recording, scene, given, options);
  return explainer.Run();
}

ExplainRecordingOptions ExplainOptions::For(const RecordingSource& recording) const {
  ExplainRecordingOptions explain{.rays = rays, .poses = poses};
  explain.comparison = comparison.For(recording.info().sonar.axes);
  explain.hold_noise = hold_noise;
  if (!held_out.empty()) explain.held_out = held_out.In(recording.frame_count(), kHeldOutFrame);
  explain.fit.max_iterations = max_iterations;
  explain.fit.threads = rays.threads;
  return explain;
}

ExplainedRecording Explain(const RecordingSource& recording, const Scene& scene, const ParameterSet& start,
                           const ExplainOptions& options, const Listener& listener) {
  const ThreadLimit threads(options.rays.threads);
  ExplainRecordingOptions explain = options.For(recording);
  explain.on_note = listener.message;
  explain.on_step = [&](calib::ExplainedPart part) {
    listener.Message("fitting: " + std::string(ToString(part)));
  };
  explain.fit.stop = listener.stop;
  return ExplainRecording(recording, scene, start, explain);
}

}  // namespace sonarcal::workflow
