#include "apps/reproduce/synthetic_comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <numeric>

#include "apps/workflow/simulate.h"
#include "data_io/parameters/parameters_io.h"
#include "sim/paper/paper_values.h"
#include "sim/rays/acoustic_fan.h"
#include "sim/scenes/sonar_presets.h"

namespace sonarcal::reproduce {
namespace {

struct DataSetPoses {
  std::vector<data_io::TimedPose> poses;  // of all data sets, one after the other
  std::vector<int> data_set;              // of each pose
};

DataSetPoses PosesOf(const SyntheticCase& synthetic) {
  DataSetPoses all;
  for (std::size_t set = 0; set < synthetic.data_sets.size(); ++set) {
    for (const Pose& pose : synthetic.environment->poses(synthetic.data_sets[set].pose_set)) {
      all.poses.push_back({.time_s = static_cast<double>(all.poses.size()), .world_from_sonar = pose});
      all.data_set.push_back(static_cast<int>(set));
    }
  }
  return all;
}

// Seconds to simulate a frame as the paper does: trace, shade, bin.
double SecondsPerFrame(const sim::Simulator& simulator, const std::vector<data_io::TimedPose>& poses,
                       const std::vector<int>& frames, const ParameterSet& parameters) {
  const auto start = std::chrono::steady_clock::now();
  for (const int frame : frames) simulator.Render(poses[frame].world_from_sonar, parameters, frame);
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() /
         static_cast<double>(frames.size());
}

std::vector<metrics::FrameMetrics> OfFrames(const metrics::MetricsReport& report,
                                            const std::vector<int>& frames) {
  std::vector<metrics::FrameMetrics> chosen;
  for (const metrics::FrameMetrics& metrics : report.frames) {
    if (std::find(frames.begin(), frames.end(), metrics.index) != frames.end()) chosen.push_back(metrics);
  }
  return chosen;
}

workflow::RecordingFit Fitted(const SyntheticComparison& result, const ParameterSet& initial,
                              const workflow::FitRecordingOptions& options) {
  if (options.on_note) options.on_note(fmt::format("fitting the {} model", ToString(initial.model)));
  workflow::RecordingFit fit = workflow::FitRecording(*result.recording, result.scene, initial, options);
  if (!fit.fit.usable) {
    throw DataError("{}: the fit of the {} model ended without a usable solution: {}", result.plan.name,
                    ToString(initial.model), fit.fit.report.termination);
  }
  return fit;
}

// The rays that the acoustic model wants.
workflow::FitRecordingOptions ForAcoustic(workflow::FitRecordingOptions fit, bool quick) {
  fit.rays.rays.reset();
  if (quick) fit.rays.rays = RayGridSize{256, 600};
  fit.fit.function_tolerance = calib::FitOptions().function_tolerance;
  fit.fit.down_weight = true;
  return fit;
}

// Records all poses.
void Record(const SyntheticCase& synthetic, const sim::SonarPreset& preset, const SyntheticOptions& options,
            const std::vector<data_io::TimedPose>& poses, SyntheticComparison& result) {
  sim::SimulationOptions recorder;
  recorder.water = preset.water;
  result.absorption = sim::AbsorptionStatement(recorder.absorption, preset.sonar.frequency_hz, preset.water);
  recorder.noise = true;
  recorder.seed = options.seed;
  // In elevation as far as a beam hears.
  recorder.fan = sim::AcousticFanOptions(preset.sonar, result.truth);
  recorder.fan.azimuth_margin_deg = 0.0;
  recorder.fan.cols = preset.sonar.axes.beam_count() * synthetic.recorder_cols_per_beam;
  recorder.fan.rows = options.quick ? 300 : synthetic.recorder_rows;
  const sim::Simulator simulator(result.scene, preset.sonar, recorder);
  result.recording = workflow::SimulateRecording(simulator, poses, result.truth, "", [&](int done) {
    if (options.on_frame) options.on_frame(done, static_cast<int>(poses.size()));
  });
}

workflow::FitRecordingOptions FitOptionsOf(const SyntheticCase& synthetic, const SyntheticOptions& options,
                                           int frame_count) {
  workflow::FitRecordingOptions fit;
  fit.rays.threads = options.threads;
  if (options.quick) fit.rays.rays = RayGridSize{256, 200};
  fit.comparison = ObjectRules(synthetic);
  fit.truth = synthetic.truth;
  fit.fit.starts = 1;
  fit.fit.test_others = !options.quick;
  fit.fit.max_iterations = options.quick ? 10 : synthetic.max_iterations;
  fit.fit.function_tolerance = synthetic.function_tolerance;
  fit.fit.progress = options.on_note;
  fit.on_note = options.on_note;
  fit.config.held_out.emplace();
  const std::vector<int>& fitted = synthetic.fitted_frames;
  for (int frame = 0; frame < frame_count; ++frame) {
    if (std::find(fitted.begin(), fitted.end(), frame) == fitted.end()) fit.config.held_out->push_back(frame);
  }
  return fit;
}

}  // namespace

const SyntheticCase& SyntheticOf(const CasePlan& plan) {
  const auto* synthetic = std::get_if<SyntheticCase>(&plan.study);
  if (synthetic == nullptr) throw DataError("{}: expected a synthetic case", plan.folder.string());
  return *synthetic;
}

// As `fit --object` and `compare --object` do.
metrics::CompareOptions ObjectRules(const SyntheticCase& synthetic) {
  metrics::CompareOptions rules;
  rules.object = metrics::ObjectSearch{.material = synthetic.object_material};
  rules.segmentation = metrics::SegmentationInBox();
  return rules;
}

SyntheticComparison CompareSynthetic(const CasePlan& plan, const SyntheticOptions& options) {
  const SyntheticCase& synthetic = SyntheticOf(plan);
  SyntheticComparison result;
  result.plan = plan;
  result.scene = synthetic.environment->make(options.text_sizes ? synthetic.text_scene : synthetic.scene);
  result.truth = synthetic.truth;
  const DataSetPoses all = PosesOf(synthetic);
  const sim::SonarPreset& preset = sim::FindSonarPreset(synthetic.sonar);
  result.initial = sim::PaperValues(preset.sonar, result.scene.material_names);
  result.acoustic_initial = synthetic.acoustic_start;
  Record(synthetic, preset, options, all.poses, result);

  const workflow::FitRecordingOptions fit =
      FitOptionsOf(synthetic, options, static_cast<int>(all.poses.size()));
  result.fit = Fitted(result, result.initial, fit);
  result.acoustic = Fitted(result, result.acoustic_initial, ForAcoustic(fit, options.quick));

  workflow::RayOptions paper_rays(sim::Sampling::kFrustum);
  if (options.quick) paper_rays.rays = RayGridSize{300, 240};
  const sim::Simulator paper(result.scene, preset.sonar, paper_rays.For(preset.sonar, preset.water));
  result.paper_rays = {paper.fan().cols(), paper.fan().rows()};
  for (std::size_t set = 0; set < synthetic.data_sets.size(); ++set) {
    SyntheticDataSet data;
    for (const int frame : result.fit.fit.report.frames_held_out) {
      if (all.data_set[frame] == static_cast<int>(set)) data.frames.push_back(frame);
    }
    data.before = metrics::AggregateFrames(OfFrames(result.fit.before, data.frames));
    data.after = metrics::AggregateFrames(OfFrames(result.fit.after, data.frames));
    data.acoustic_expected = metrics::AggregateFrames(OfFrames(result.acoustic.after, data.frames));
    data.acoustic_sample =
        metrics::AggregateFrames(OfFrames(result.acoustic.sample_after.value(), data.frames));
    data.simulation_time_s = SecondsPerFrame(paper, all.poses, data.frames, result.initial);
    result.data_sets.push_back(std::move(data));
  }
  return result;
}

}  // namespace sonarcal::reproduce
