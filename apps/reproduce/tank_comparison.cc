#include "apps/reproduce/tank_comparison.h"

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

constexpr int kFramesPerSet = 4;
// One frame of each of the first two data sets is fitted; all others, the third set's included, are held out.
constexpr std::array<int, 2> kFittedFrames = {0, 5};

// The tank as the recording has it: power coefficients a unit of area, of the order published for concrete,
// steel and sand at such frequencies, and a display that shows 66 dB.
ParameterSet SyntheticTruth() {
  ParameterSet truth;
  truth.model = EchoModel::kCoherent;
  truth.source_level_db = 200.0;
  truth.display = {.db_min = 82.0, .db_max = 148.0};
  truth.materials["floor"].gsab = {.a = 0.1, .b_deg = 5.0, .c = 0.002, .d = 1.8, .e = 0.01, .f_deg = 11.0};
  truth.materials["wall"].gsab = {.a = 0.126, .b_deg = 3.5, .c = 0.001, .d = 1.4, .e = 0.004, .f_deg = 9.0};
  truth.materials["mockup"].gsab = {.a = 0.126, .b_deg = 5.5, .c = 0.01, .d = 1.3, .e = 0.025, .f_deg = 17.0};
  truth.receiver.noise_db = 94.0;
  // In azimuth the array has the side lobes of its taper. In elevation it has none: they lift the floor at
  // near range to where the paper's model, which knows no elevation pattern, has no answer.
  truth.beam.elevation_pattern = ElevationPattern::kGaussian;
  return truth;
}

// What one knows of such a sonar, for the acoustic model: display, beam and pulse; and that no surface is a
// mirror or black.
ParameterSet AcousticInitial(const ParameterSet& truth, const SonarModel& sonar) {
  ParameterSet initial;
  initial.model = EchoModel::kAcoustic;
  initial.source_level_db = truth.source_level_db;
  initial.display = truth.display;
  initial.beam = truth.beam;
  initial.pulse.length_m = sonar.axes.range_bin_m();
  for (const char* material : {"floor", "wall", "mockup"}) {
    initial.materials[material].gsab = {
        .a = 0.05, .b_deg = 5.0, .c = 0.005, .d = 1.5, .e = 0.02, .f_deg = 15.0};
  }
  return initial;
}

std::vector<data_io::TimedPose> AllPoses() {
  std::vector<data_io::TimedPose> poses;
  for (int set = 1; set <= kTankDataSets; ++set) {
    for (const Pose& pose : sim::PaperTankPoses(set)) {
      poses.push_back({.time_s = static_cast<double>(poses.size()), .world_from_sonar = pose});
    }
  }
  return poses;
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

workflow::RecordingFit Fitted(const TankComparison& tank, const ParameterSet& initial,
                              const workflow::FitRecordingOptions& options) {
  if (options.on_note) options.on_note(fmt::format("fitting the {} model", ToString(initial.model)));
  workflow::RecordingFit fit = workflow::FitRecording(*tank.recording, tank.scene, initial, options);
  if (!fit.fit.usable) {
    throw DataError("the fit of the tank by the {} model ended without a usable solution: {}",
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

}  // namespace

// As `fit --object mockup` and `compare --object mockup` do.
metrics::CompareOptions TankRules() {
  metrics::CompareOptions rules;
  rules.object = metrics::ObjectSearch{.material = "mockup"};
  rules.segmentation = metrics::SegmentationInBox();
  return rules;
}

TankComparison CompareTank(const TankComparisonOptions& options) {
  TankComparison tank;
  tank.scene = sim::MakePaperTank(sim::PaperTankOfPaper(options.size));
  tank.truth = SyntheticTruth();
  const std::vector<data_io::TimedPose> poses = AllPoses();
  const sim::SonarPreset& preset = sim::FindSonarPreset("p900-45");
  tank.initial = sim::PaperValues(preset.sonar, {"floor", "wall", "mockup"});
  tank.acoustic_initial = AcousticInitial(tank.truth, preset.sonar);

  sim::SimulationOptions recorder;
  recorder.water = preset.water;
  tank.absorption = sim::AbsorptionStatement(recorder.absorption, preset.sonar.frequency_hz, preset.water);
  recorder.noise = true;
  recorder.seed = options.seed;
  // Two scatterers a beam of 0.18 degrees, in elevation as far as a beam hears.
  recorder.fan = sim::AcousticFanOptions(preset.sonar, tank.truth);
  recorder.fan.azimuth_margin_deg = 0.0;
  recorder.fan.cols = preset.sonar.axes.beam_count() * 2;
  recorder.fan.rows = options.quick ? 300 : 1000;
  const sim::Simulator recording_simulator(tank.scene, preset.sonar, recorder);
  tank.recording = workflow::SimulateRecording(recording_simulator, poses, tank.truth, "", [&](int done) {
    if (options.on_frame) options.on_frame(done, static_cast<int>(poses.size()));
  });

  workflow::FitRecordingOptions fit;
  fit.rays.threads = options.threads;
  if (options.quick) fit.rays.rays = RayGridSize{256, 200};
  fit.comparison = options.comparison;
  fit.truth = tank.truth;
  fit.fit.starts = 1;
  fit.fit.max_iterations = options.quick ? 10 : 40;
  fit.fit.function_tolerance = 1e-5;
  fit.fit.progress = options.on_note;
  fit.on_note = options.on_note;
  fit.config.held_out.emplace();
  for (int frame = 0; frame < static_cast<int>(poses.size()); ++frame) {
    if (std::find(kFittedFrames.begin(), kFittedFrames.end(), frame) == kFittedFrames.end()) {
      fit.config.held_out->push_back(frame);
    }
  }
  tank.fit = Fitted(tank, tank.initial, fit);
  tank.acoustic = Fitted(tank, tank.acoustic_initial, ForAcoustic(fit, options.quick));

  workflow::RayOptions paper_rays(sim::Sampling::kFrustum);
  if (options.quick) paper_rays.rays = RayGridSize{300, 240};
  const sim::Simulator paper(tank.scene, preset.sonar, paper_rays.For(preset.sonar, preset.water));
  tank.paper_rays = {paper.fan().cols(), paper.fan().rows()};
  for (int set = 0; set < kTankDataSets; ++set) {
    TankDataSet& data = tank.data_sets[set];
    for (const int frame : tank.fit.fit.report.frames_held_out) {
      if (frame / kFramesPerSet == set) data.frames.push_back(frame);
    }
    data.before = metrics::AggregateFrames(OfFrames(tank.fit.before, data.frames));
    data.after = metrics::AggregateFrames(OfFrames(tank.fit.after, data.frames));
    data.acoustic_expected = metrics::AggregateFrames(OfFrames(tank.acoustic.after, data.frames));
    data.acoustic_sample =
        metrics::AggregateFrames(OfFrames(tank.acoustic.sample_after.value(), data.frames));
    data.simulation_time_s = SecondsPerFrame(paper, poses, data.frames, tank.initial);
  }
  return tank;
}

}  // namespace sonarcal::reproduce
