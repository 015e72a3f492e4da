// A frame of the acoustic model in one pass over its rays beside the same rays cast alone, Embree alone with
// the same kernels and with the processor's own, and rays traced to a list of echoes that are shaded one at a
// time, in turn.
#include <benchmark/benchmark.h>

#include <vector>

#include "apps/workflow/kept_memory.h"
#include "sim/rays/acoustic_fan.h"
#include "tests/benchmarks/benchmark_world.h"
#include "tests/benchmarks/embree_alone.h"

namespace sonarcal::benchmarks {
namespace {

void AcousticFrame(benchmark::State& state) {
  workflow::KeepFreedMemory();  // as the program does
  constexpr int kRounds = 9;
  const sim::SonarPreset& preset = sim::FindSonarPreset("p900-45");
  ParameterSet parameters = Parameters();
  parameters.model = EchoModel::kAcoustic;
  sim::SimulationOptions options = Options(preset, sim::AcousticFanOptions(preset.sonar, parameters));
  options.noise = false;
  const Scene scene = sim::MakeMockupTank(sim::MockupTankOfSize(sim::SizeVariant::kStandard));
  const sim::Simulator simulator(scene, preset.sonar, options);
  const Pose pose = sim::MockupTankPoses(3).front();
  const double max_range_m = preset.sonar.axes.range_max_m;
  const EmbreeAlone same_kernels(scene, simulator.fan(), pose, max_range_m, kSimulatorKernels);
  const EmbreeAlone own_kernels(scene, simulator.fan(), pose, max_range_m);
  const auto seconds = [&](const auto& run) {
    const double began = Now();
    run();
    return Now() - began;
  };
  while (state.KeepRunning()) {
    std::vector<double> cast;
    std::vector<double> one_pass;
    std::vector<double> list;
    std::vector<double> embree;
    std::vector<double> embree_own;
    std::vector<double> of_cast;
    std::vector<double> of_embree;
    std::vector<double> of_embree_own;
    std::vector<double> of_list;
    for (int round = 0; round < kRounds; ++round) {
      cast.push_back(seconds([&] {
        benchmark::DoNotOptimize(simulator.caster().Cast(simulator.fan(), pose, max_range_m).range_m.data());
      }));
      // The fastest queries of these kernels.
      embree.push_back(same_kernels.Seconds(RayOrder::kTiles, 8, true));
      embree_own.push_back(own_kernels.Seconds(RayOrder::kTiles, 16, true));
      one_pass.push_back(seconds(
          [&] { benchmark::DoNotOptimize(simulator.Render(pose, parameters).value.values().data()); }));
      list.push_back(seconds([&] {
        const PolarImage image = simulator.RenderEchoes(simulator.TraceEchoes(pose), parameters);
        benchmark::DoNotOptimize(image.value.values().data());
      }));
      of_cast.push_back(one_pass.back() / cast.back());
      of_embree.push_back(one_pass.back() / embree.back());
      of_embree_own.push_back(one_pass.back() / embree_own.back());
      of_list.push_back(one_pass.back() / list.back());
    }
    state.counters["frame_ms"] = 1e3 * Median(one_pass);
    state.counters["rays_alone_ms"] = 1e3 * Median(cast);
    state.counters["list_ms"] = 1e3 * Median(list);
    state.counters["of_rays_alone"] = Median(of_cast);
    state.counters["embree_ms"] = 1e3 * Median(embree);
    state.counters["embree_own_kernels_ms"] = 1e3 * Median(embree_own);
    state.counters["of_embree"] = Median(of_embree);
    state.counters["limit"] = 1.3;
    state.counters["of_embree_own_kernels"] = Median(of_embree_own);
    state.counters["of_list"] = Median(of_list);
    state.counters["rays"] = static_cast<double>(simulator.fan().size());
  }
}
BENCHMARK(AcousticFrame)->Iterations(1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace sonarcal::benchmarks
