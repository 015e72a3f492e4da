// Fits beside the ray tracing that they rest on, in the same run, on SYNTHETIC recordings of the paper's tank
// by the model that is fitted, frames of 256 beams x 330 bins. Curves: 30 frames, 1500 x 1200 rays each, 12
// free parameters. Poses: 8 frames with default rays, poses and curves free, acoustic model.
#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "apps/workflow/kept_memory.h"
#include "calib/acoustic_fit.h"
#include "calib/fit.h"
#include "calib/parameters/pose_step.h"
#include "sim/rays/acoustic_fan.h"
#include "sim/scenes/scenes.h"
#include "sim/scenes/sonar_presets.h"
#include "sim/simulator.h"
#include "tests/benchmarks/benchmark_world.h"

namespace sonarcal::benchmarks {
namespace {

constexpr int kFrames = 30;

// Of all threads together.
double ProcessorSeconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

ParameterSet Truth() {
  ParameterSet truth;
  truth.model = EchoModel::kAcoustic;
  truth.source_level_db = 200.0;
  truth.display = {.db_min = 82.0, .db_max = 148.0};
  truth.materials["default"].gsab = {.a = 0.1, .b_deg = 4.0, .c = 0.001, .d = 1.4, .e = 0.004, .f_deg = 9.0};
  truth.materials["floor"].gsab = {.a = 0.1, .b_deg = 5.0, .c = 0.002, .d = 1.8, .e = 0.01, .f_deg = 12.0};
  truth.materials["mockup"].gsab = {.a = 0.12, .b_deg = 5.5, .c = 0.01, .d = 1.3, .e = 0.025, .f_deg = 17.0};
  truth.receiver.noise_db = 94.0;
  return truth;
}

// The poses of the paper's tank, and the same turned and tilted: floors and faces at all angles.
std::vector<Pose> Poses() {
  std::vector<Pose> poses;
  for (int i = 0; poses.size() < kFrames; ++i) {
    for (int set = 1; set <= 3; ++set) {
      for (const Pose& pose : sim::MockupTankPoses(set)) {
        if (poses.size() == kFrames) return poses;
        const double pitch_rad = RadFromDeg(-10.0 * i);
        poses.push_back(
            {pose.rotation * RotationFromYawPitchRoll(RadFromDeg(5.0 * i), pitch_rad, 0.0), pose.position_m});
      }
    }
  }
  return poses;
}

// Processor time to cast the rays of these poses without keeping their hits.
double CastSeconds(const sim::Simulator& simulator, const std::vector<Pose>& poses) {
  const double start = ProcessorSeconds();
  for (const Pose& pose : poses) {
    simulator.caster().CastRows(simulator.fan(), pose, simulator.sonar().axes.range_max_m,
                                [](const sim::RowHits& hits) { benchmark::DoNotOptimize(hits.range_m); });
  }
  return ProcessorSeconds() - start;
}

// Returns speckled samples, SYNTHETIC, seen from these poses.
std::vector<calib::AcousticFrame> Record(const sim::Simulator& simulator, const std::vector<Pose>& poses) {
  const ParameterSet truth = Truth();
  std::vector<calib::AcousticFrame> frames;
  for (const Pose& pose : poses) {
    const int index = static_cast<int>(frames.size());
    const PolarImage image = simulator.Render(pose, truth, index);
    frames.push_back(
        {.index = index, .world_from_sonar = pose, .recorded = calib::RecordedPowers(image, truth.display)});
  }
  return frames;
}

// Curves as a user would start them.
ParameterSet Initial() {
  ParameterSet initial = Truth();
  for (const char* material : {"floor", "mockup"}) {
    initial.materials[material].gsab = {
        .a = 0.05, .b_deg = 5.0, .c = 0.005, .d = 1.5, .e = 0.02, .f_deg = 15.0};
  }
  return initial;
}

void FitBesideTracing(benchmark::State& state) {
  workflow::KeepFreedMemory();  // as the program does
  const sim::SonarPreset& preset = sim::FindSonarPreset("p900-45");
  const sim::Simulator simulator(
      sim::MakeMockupTank(), preset.sonar,
      Options(preset,
              {.sampling = sim::Sampling::kBeams, .cols = 1500, .rows = 1200, .elevation_span_deg = 60.0}));
  const std::vector<Pose> poses = Poses();
  const std::vector<calib::AcousticFrame> frames = Record(simulator, poses);
  const ParameterSet initial = Initial();
  calib::FitConfig config;
  config.free = {"material.floor.*", "material.mockup.*"};

  while (state.KeepRunning()) {
    const double cast_cpu = CastSeconds(simulator, poses);
    const double start = Now();
    const double start_cpu = ProcessorSeconds();
    for (const Pose& pose : poses) benchmark::DoNotOptimize(simulator.TraceEchoes(pose).range_m.data());
    const double traced = Now();
    const double traced_cpu = ProcessorSeconds();
    const calib::AcousticFrameModel model(simulator, frames, initial);
    const double gathered = Now();
    const double gathered_cpu = ProcessorSeconds();
    const calib::ModelFit fit = calib::Fit(model, model.initial_values(), config);
    const double solved = Now();
    const double solved_cpu = ProcessorSeconds();
    if (!fit.usable) state.SkipWithError(fit.report.termination.c_str());
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    state.counters["trace_s"] = traced - start;
    state.counters["trace_and_gather_s"] = gathered - traced;
    state.counters["solve_s"] = solved - gathered;
    state.counters["solve_over_trace"] = (solved - gathered) / (traced - start);
    state.counters["gather_over_trace"] = (gathered - traced) / (traced - start);
    // Preparation without its tracing, and the fit.
    state.counters["rest_over_trace"] = (solved_cpu - traced_cpu) / (traced_cpu - start_cpu) - 1.0;
    state.counters["limit"] = 0.5;
    state.counters["cast_processor_s"] = cast_cpu;
    state.counters["rest_over_cast"] = (solved_cpu - traced_cpu) / cast_cpu - 1.0;
    state.counters["trace_processor_s"] = traced_cpu - start_cpu;
    state.counters["gather_processor_s"] = gathered_cpu - traced_cpu;
    state.counters["solve_processor_s"] = solved_cpu - gathered_cpu;
    state.counters["iterations"] = fit.report.iterations;
    state.counters["peak_memory_MiB"] = static_cast<double>(usage.ru_maxrss) / 1024.0;
  }
}
BENCHMARK(FitBesideTracing)->Iterations(1)->Unit(benchmark::kSecond);

ParameterSet PaperTruth() {
  ParameterSet truth = Parameters();
  truth.display = {.db_min = 100.0, .db_max = 160.0};
  truth.materials["default"].gsab = {.a = 80.0, .b_deg = 4.0, .c = 5.0, .d = 1.4, .e = 10.0, .f_deg = 9.0};
  truth.materials["floor"].gsab = {.a = 50.0, .b_deg = 5.0, .c = 70.0, .d = 1.5, .e = 40.0, .f_deg = 14.0};
  truth.materials["mockup"].gsab = {.a = 120.0, .b_deg = 3.0, .c = 30.0, .d = 1.0, .e = 60.0, .f_deg = 11.0};
  return truth;
}

void PaperFitBesideTracing(benchmark::State& state) {
  workflow::KeepFreedMemory();  // as the program does
  const sim::SonarPreset& preset = sim::FindSonarPreset("p900-45");
  const sim::Simulator simulator(sim::MakeMockupTank(), preset.sonar, Options(preset, kPaperRays));
  const ParameterSet truth = PaperTruth();
  const std::vector<Pose> poses = Poses();
  std::vector<PolarImage> recorded;
  for (std::size_t i = 0; i < poses.size(); ++i)
    recorded.push_back(simulator.Render(poses[i], truth, static_cast<int>(i)));
  ParameterSet initial = truth;
  for (const char* material : {"floor", "mockup"})
    initial.materials[material].gsab = {
        .a = 30.0, .b_deg = 5.0, .c = 20.0, .d = 1.5, .e = 20.0, .f_deg = 15.0};
  calib::FitConfig config;
  config.free = {"material.floor.*", "material.mockup.*"};

  while (state.KeepRunning()) {
    const double cast_cpu = CastSeconds(simulator, poses);
    const double start_cpu = ProcessorSeconds();
    for (const Pose& pose : poses) benchmark::DoNotOptimize(simulator.TraceEchoes(pose).range_m.data());
    const double traced_cpu = ProcessorSeconds();
    std::vector<calib::FitFrame> frames;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      frames.push_back({.index = static_cast<int>(i),
                        .echoes = simulator.GatherEchoes(poses[i]),
                        .measured = calib::MeasuredForFit(recorded[i]),
                        .level = calib::GreyLevel(recorded[i])});
    }
    const double gathered_cpu = ProcessorSeconds();
    const calib::FitResult fit =
        calib::FitPaperModel(frames, {simulator.sonar(), simulator.absorption_db_per_m()},
                             simulator.caster().material_names(), initial, config);
    const double solved_cpu = ProcessorSeconds();
    if (!fit.usable) state.SkipWithError(fit.report.termination.c_str());
    const double trace_cpu = traced_cpu - start_cpu;
    state.counters["cast_processor_s"] = cast_cpu;
    state.counters["rest_over_cast"] = (solved_cpu - traced_cpu) / cast_cpu - 1.0;
    state.counters["trace_processor_s"] = trace_cpu;
    state.counters["gather_processor_s"] = gathered_cpu - traced_cpu;
    state.counters["solve_processor_s"] = solved_cpu - gathered_cpu;
    state.counters["rest_over_trace"] = (solved_cpu - traced_cpu) / trace_cpu - 1.0;
    state.counters["limit"] = 0.5;
    state.counters["iterations"] = fit.report.iterations;
  }
}
BENCHMARK(PaperFitBesideTracing)->Iterations(1)->Unit(benchmark::kSecond);

// Recorded poses are wrong by 15 mm and 0.8 degrees in each component.
void PosesBesideTracing(benchmark::State& state) {
  workflow::KeepFreedMemory();  // as the program does
  constexpr std::size_t kWrongFrames = 8;
  constexpr calib::PosePrior kWrong = {.position_m = 0.015, .angle_deg = 0.8};
  const sim::SonarPreset& preset = sim::FindSonarPreset("p900-45");
  const sim::Simulator simulator(sim::MakeMockupTank(), preset.sonar,
                                 Options(preset, sim::AcousticFanOptions(preset.sonar, Truth())));
  std::vector<Pose> poses = Poses();
  poses.resize(kWrongFrames);
  std::vector<calib::AcousticFrame> frames = Record(simulator, poses);
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (calib::AcousticFrame& frame : frames) {
    calib::PoseStep named = calib::NamedValues(frame.world_from_sonar);
    for (int k = 0; k < calib::kPoseSteps; ++k)
      named(k) += normal(random) * (k < 3 ? kWrong.position_m : kWrong.angle_deg);
    frame.world_from_sonar = calib::PoseFromNamedValues(named);
  }
  const calib::FitConfig config{.free = std::vector<std::string>{"materials", "noise", "pose"},
                                .pose_prior = kWrong};
  calib::FitOptions options;
  options.starts = 1;

  while (state.KeepRunning()) {
    const double start = ProcessorSeconds();
    for (const Pose& pose : poses) benchmark::DoNotOptimize(simulator.TraceEchoes(pose).range_m.data());
    const double traced = ProcessorSeconds();
    const calib::AcousticFit fit = calib::FitAcousticModel(simulator, frames, Initial(), config, options);
    const double fitted = ProcessorSeconds();
    if (!fit.usable) state.SkipWithError(fit.report.termination.c_str());
    double square_m2 = 0.0;
    double was_m2 = 0.0;
    for (std::size_t i = 0; i < poses.size(); ++i) {
      square_m2 += (fit.world_from_sonar[i].position_m - poses[i].position_m).squaredNorm();
      was_m2 += (frames[i].world_from_sonar.position_m - poses[i].position_m).squaredNorm();
    }
    state.counters["trace_processor_s"] = traced - start;
    state.counters["fit_processor_s"] = fitted - traced;
    state.counters["fit_over_trace"] = (fitted - traced) / (traced - start);
    state.counters["limit"] = 40;
    state.counters["position_error_before_mm"] = 1e3 * std::sqrt(was_m2 / static_cast<double>(poses.size()));
    state.counters["position_error_mm"] = 1e3 * std::sqrt(square_m2 / static_cast<double>(poses.size()));
  }
}
BENCHMARK(PosesBesideTracing)->Iterations(1)->Unit(benchmark::kSecond);

// Preparation of a fit of the paper's model, with its own rays. Without the fit itself.
void PaperGatherBesideTracing(benchmark::State& state) {
  const sim::SonarPreset& preset = sim::FindSonarPreset("p900-45");
  const sim::Simulator simulator(sim::MakeMockupTank(), preset.sonar, Options(preset, kPaperRays));
  while (state.KeepRunning()) {
    double trace_s = 0.0;
    double gather_s = 0.0;
    for (const Pose& pose : Poses()) {
      const double start = ProcessorSeconds();
      const sim::EchoList echoes = simulator.TraceEchoes(pose);
      const double traced = ProcessorSeconds();
      benchmark::DoNotOptimize(sim::GatherEchoes(echoes, preset.sonar.axes).cells.data());
      trace_s += traced - start;
      gather_s += ProcessorSeconds() - traced;
    }
    state.counters["trace_processor_s"] = trace_s;
    state.counters["gather_processor_s"] = gather_s;
    state.counters["gather_over_trace"] = gather_s / trace_s;
  }
}
BENCHMARK(PaperGatherBesideTracing)->Iterations(1)->Unit(benchmark::kSecond);

}  // namespace
}  // namespace sonarcal::benchmarks
