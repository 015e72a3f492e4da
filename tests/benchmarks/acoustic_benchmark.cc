// A frame of the acoustic model in one pass over its rays beside the same rays cast alone, and traced to a
// list of echoes that are shaded one at a time, in turn.
#include <benchmark/benchmark.h>

#include <vector>

#include "sim/rays/acoustic_fan.h"
#include "tests/benchmarks/benchmark_world.h"

namespace sonarcal::benchmarks {
namespace {

void AcousticFrame(benchmark::State& state) {
  constexpr int kRounds = 9;
  const sim::SonarPreset& preset = sim::FindSonarPreset("p900-45");
  ParameterSet parameters = Parameters();
  parameters.model = EchoModel::kAcoustic;
  sim::SimulationOptions options = Options(preset, sim::AcousticFanOptions(preset.sonar, parameters));
  options.noise = false;
  const sim::Simulator simulator(sim::MakeMockupTank(sim::MockupTankOfSize(sim::SizeVariant::kStandard)),
                                 preset.sonar, options);
  const Pose pose = sim::MockupTankPoses(3).front();
  const auto seconds = [&](const auto& run) {
    const double began = Now();
    run();
    return Now() - began;
  };
  for (auto unused : state) {
    std::vector<double> cast;
    std::vector<double> one_pass;
    std::vector<double> list;
    std::vector<double> of_cast;
    std::vector<double> of_list;
    for (int round = 0; round < kRounds; ++round) {
      cast.push_back(seconds([&] {
        benchmark::DoNotOptimize(
            simulator.caster().Cast(simulator.fan(), pose, preset.sonar.axes.range_max_m).range_m.data());
      }));
      one_pass.push_back(seconds(
          [&] { benchmark::DoNotOptimize(simulator.Render(pose, parameters).value.values().data()); }));
      list.push_back(seconds([&] {
        const PolarImage image = simulator.RenderEchoes(simulator.TraceEchoes(pose), parameters);
        benchmark::DoNotOptimize(image.value.values().data());
      }));
      of_cast.push_back(one_pass.back() / cast.back());
      of_list.push_back(one_pass.back() / list.back());
    }
    state.counters["frame_ms"] = 1e3 * Median(one_pass);
    state.counters["rays_alone_ms"] = 1e3 * Median(cast);
    state.counters["list_ms"] = 1e3 * Median(list);
    state.counters["of_rays_alone"] = Median(of_cast);
    state.counters["of_list"] = Median(of_list);
    state.counters["rays"] = static_cast<double>(simulator.fan().size());
  }
}
BENCHMARK(AcousticFrame)->Iterations(1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace sonarcal::benchmarks
