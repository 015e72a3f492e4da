// A whole frame of the paper's model beside Embree alone, tracing exactly the same rays with whichever of its
// queries is fastest, in the same run and in turn: with the kernels that the simulator uses, its rays in rows
// and in the tiles that the frame casts, and with the processor's own kernels. 1500 x 1200 rays, errors of
// range and azimuth sampled, polar and fan image. Ratios stand beside the limit they are held to.
#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <cmath>
#include <ctime>
#include <vector>

#include "apps/workflow/rays/ray_errors.h"
#include "core/imaging/fan_image.h"
#include "sim/rays/paper_fan.h"
#include "sim/scenes/environments.h"
#include "tests/benchmarks/benchmark_world.h"
#include "tests/benchmarks/embree_alone.h"

namespace sonarcal::benchmarks {
namespace {

void FrameBesideEmbree(benchmark::State& state, const Scene& scene, const Pose& pose,
                       sim::RayFanOptions rays) {
  constexpr int kRounds = 15;
  const sim::SonarPreset& preset = sim::FindSonarPreset("p900-45");
  const sim::Simulator simulator(scene, preset.sonar, Options(preset, rays));
  const ParameterSet parameters = Parameters();
  const FanMap map(preset.sonar.axes, FanAxesFor(preset.sonar.axes, {}));
  const double max_range_m = preset.sonar.axes.range_max_m;
  const EmbreeAlone same_kernels(scene, simulator.fan(), pose, max_range_m, kSimulatorKernels);
  const EmbreeAlone own_kernels(scene, simulator.fan(), pose, max_range_m);
  while (state.KeepRunning()) {
    FastestQuery in_rows(RayOrder::kRows);
    FastestQuery in_tiles(RayOrder::kTiles);
    FastestQuery own_in_rows(RayOrder::kRows);
    std::vector<double> frame;
    for (int round = 0; round < kRounds; ++round) {
      in_rows.Measure(same_kernels);
      in_tiles.Measure(same_kernels);
      own_in_rows.Measure(own_kernels);
      const double began = Now();
      const PolarImage image = simulator.Render(pose, parameters, round);
      const FanImage fan = map.Apply(image);
      benchmark::DoNotOptimize(fan.value.values().data());
      frame.push_back(Now() - began);
    }
    const auto [name, fastest] = in_rows.Best();
    const auto [name_in_tiles, fastest_in_tiles] = in_tiles.Best();
    const auto [own_name, own_fastest] = own_in_rows.Best();
    state.SetLabel(
        fmt::format("Embree query of {} rays; in tiles {}; own kernels {}", name, name_in_tiles, own_name));
    state.counters["triangles"] = static_cast<double>(scene.triangles.size());
    state.counters["frame_ms"] = 1e3 * Median(frame);
    state.counters["embree_ms"] = 1e3 * fastest;
    state.counters["frame_over_embree"] = Median(frame) / fastest;
    state.counters["embree_in_tiles_ms"] = 1e3 * fastest_in_tiles;
    state.counters["frame_over_embree_in_tiles"] = Median(frame) / fastest_in_tiles;
    state.counters["limit"] = 1.15;
    state.counters["embree_own_kernels_ms"] = 1e3 * own_fastest;
    state.counters["frame_over_own_kernels"] = Median(frame) / own_fastest;
    state.counters["Mrays_per_s"] = 1e-6 * simulator.fan().size() / Median(frame);
  }
}

void TankFrame(benchmark::State& state) {
  FrameBesideEmbree(state, Tank(300'000), sim::MockupTankPoses(3).front(), kPaperRays);
}
BENCHMARK(TankFrame)->Iterations(1)->Unit(benchmark::kMillisecond);

void JacketFrame(benchmark::State& state) {
  const sim::Environment& jacket = sim::FindEnvironment("jacket");
  FrameBesideEmbree(state, jacket.make({}), jacket.viewpoints().front(), kPaperRays);
}
BENCHMARK(JacketFrame)->Iterations(1)->Unit(benchmark::kMillisecond);

// Rays and triangles by factors.
double FrameSeconds(const sim::Simulator& simulator, const Pose& pose) {
  constexpr int kRounds = 9;
  const ParameterSet parameters = Parameters();
  std::vector<double> seconds;
  for (int round = 0; round < kRounds; ++round) {
    const double began = Now();
    const PolarImage image = simulator.Render(pose, parameters, round);
    benchmark::DoNotOptimize(image.value.values().data());
    seconds.push_back(Now() - began);
  }
  return Median(seconds);
}

// Median processor time of a frame on however many threads: it does not grow while others use the machine.
double FrameCpuSeconds(const sim::Simulator& simulator, const Pose& pose) {
  constexpr int kRounds = 31;
  std::vector<double> seconds;
  for (int round = 0; round < kRounds; ++round) {
    const std::clock_t began = std::clock();
    const PolarImage image = simulator.Render(pose, Parameters(), round);
    benchmark::DoNotOptimize(image.value.values().data());
    seconds.push_back(static_cast<double>(std::clock() - began) / CLOCKS_PER_SEC);
  }
  return Median(seconds);
}

// One thread against two, in turn; and Embree alone the same, which tells what the machine's second core is
// worth just now. A frame of a single row of rays is what does not run in parallel: tables and sums. By
// Amdahl's law it leaves no more than `bound`.
void TwoThreads(benchmark::State& state) {
  constexpr int kRounds = 9;
  const sim::SonarPreset& preset = sim::FindSonarPreset("p900-45");
  const Scene scene = Tank(300'000);
  const Pose pose = sim::MockupTankPoses(3).front();
  const sim::Simulator simulator(scene, preset.sonar, Options(preset, kPaperRays));
  sim::RayFanOptions row = kPaperRays;
  row.rows = 1;
  const sim::Simulator one_row(scene, preset.sonar, Options(preset, row));
  const EmbreeAlone embree(scene, simulator.fan(), pose, preset.sonar.axes.range_max_m, kSimulatorKernels);
  const ParameterSet parameters = Parameters();
  while (state.KeepRunning()) {
    std::vector<double> frame[2];
    std::vector<double> alone[2];
    for (int round = 0; round < kRounds; ++round) {
      for (const int threads : {1, 2}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                        static_cast<std::size_t>(threads));
        alone[threads - 1].push_back(embree.Seconds(RayOrder::kTiles, 16, true));
        const double began = Now();
        const PolarImage image = simulator.Render(pose, parameters, round);
        benchmark::DoNotOptimize(image.value.values().data());
        frame[threads - 1].push_back(Now() - began);
      }
    }
    state.counters["one_ms"] = 1e3 * Median(frame[0]);
    state.counters["two_ms"] = 1e3 * Median(frame[1]);
    state.counters["speed_up"] = Median(frame[0]) / Median(frame[1]);
    state.counters["limit"] = 1.8;
    state.counters["embree_speed_up"] = Median(alone[0]) / Median(alone[1]);
    const double serial = FrameCpuSeconds(one_row, pose);
    state.counters["serial_ms"] = 1e3 * serial;
    state.counters["bound"] = 2.0 / (1.0 + serial / FrameCpuSeconds(simulator, pose));
  }
}
BENCHMARK(TwoThreads)->Iterations(1)->Unit(benchmark::kMillisecond);

std::vector<Pose> AllTankPoses() {
  std::vector<Pose> poses;
  for (int set = 1; set <= 3; ++set) {
    for (const Pose& pose : sim::MockupTankPoses(set)) poses.push_back(pose);
  }
  return poses;
}

// Share of the pixels of an image with these rays that lie within a grey level of the dense image, on a
// display of 60 dB up to the brightest echo of the poses: what `sonarcal rays --display-db 60` prints.
double ShareWithinOneGrey(const sim::Simulator& simulator, const std::vector<Pose>& poses) {
  workflow::RayErrorOptions options;
  options.samplings = {simulator.options().fan.sampling};
  options.grids = {{simulator.options().fan.cols, simulator.options().fan.rows}};
  ParameterSet parameters = Parameters();
  const SonarModel& sonar = simulator.sonar();
  parameters.display = workflow::DisplayUpToBrightest(simulator.caster(), sonar, parameters,
                                                      simulator.options(), poses, options.dense, 60.0);
  return workflow::MeasureRayErrors(simulator.caster(), sonar, parameters, simulator.options(), poses,
                                    options)
      .counts.front()
      .within_one;
}

// The rays that `beams` get by default beside the paper's, in turn.
void DefaultSampling(benchmark::State& state) {
  const sim::SonarPreset& preset = sim::FindSonarPreset("p900-45");
  const sim::Simulator papers(Tank(300'000), preset.sonar, Options(preset, kPaperRays));
  const sim::Simulator by_default(Tank(300'000), preset.sonar,
                                  Options(preset, sim::PaperFanOptions(preset.sonar)));
  const Pose pose = sim::MockupTankPoses(3).front();
  while (state.KeepRunning()) {
    std::vector<double> ratio;
    std::vector<double> seconds;
    for (int round = 0; round < 5; ++round) {
      seconds.push_back(FrameSeconds(by_default, pose));
      ratio.push_back(seconds.back() / FrameSeconds(papers, pose));
    }
    state.counters["rays"] = by_default.fan().size();
    state.counters["frame_ms"] = 1e3 * Median(seconds);
    state.counters["frame_over_1500x1200"] = Median(ratio);
    state.counters["limit"] = 0.2;
    state.counters["within_one_grey"] = ShareWithinOneGrey(by_default, AllTankPoses());
    state.counters["min_within"] = 0.999;
  }
}
BENCHMARK(DefaultSampling)->Iterations(1)->Unit(benchmark::kMillisecond);

void Rays(benchmark::State& state) {
  const sim::SonarPreset& preset = sim::FindSonarPreset("p900-45");
  sim::RayFanOptions rays = kPaperRays;
  rays.cols = static_cast<int>(state.range(0));
  rays.rows = static_cast<int>(state.range(0)) * 4 / 5;
  const sim::Simulator simulator(Tank(300'000), preset.sonar, Options(preset, rays));
  while (state.KeepRunning()) {
    const double seconds = FrameSeconds(simulator, sim::MockupTankPoses(3).front());
    state.counters["frame_ms"] = 1e3 * seconds;
    state.counters["ns_per_ray"] = 1e9 * seconds / simulator.fan().size();
  }
}
BENCHMARK(Rays)->Arg(375)->Arg(750)->Arg(1500)->Arg(3000)->Iterations(1)->Unit(benchmark::kMillisecond);

void Triangles(benchmark::State& state) {
  const sim::SonarPreset& preset = sim::FindSonarPreset("p900-45");
  const Scene scene = Tank(static_cast<int>(state.range(0)) / 2);
  const sim::Simulator simulator(scene, preset.sonar, Options(preset, kPaperRays));
  while (state.KeepRunning()) {
    state.counters["frame_ms"] = 1e3 * FrameSeconds(simulator, sim::MockupTankPoses(3).front());
    state.counters["triangles"] = static_cast<double>(scene.triangles.size());
  }
}
BENCHMARK(Triangles)
    ->RangeMultiplier(10)
    ->Range(10'000, 10'000'000)
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace sonarcal::benchmarks
