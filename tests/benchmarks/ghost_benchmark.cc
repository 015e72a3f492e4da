// A frame of the acoustic model in a tank whose six planes are mirrors beside the same frame without them, in
// turn, by the rays that either gets by default.
#include <benchmark/benchmark.h>

#include <vector>

#include "apps/workflow/kept_memory.h"
#include "sim/rays/acoustic_fan.h"
#include "tests/benchmarks/benchmark_world.h"

namespace sonarcal::benchmarks {
namespace {

void TankGhosts(benchmark::State& state) {
  workflow::KeepFreedMemory();  // as the program does
  constexpr int kRounds = 9;
  const sim::SonarPreset& preset = sim::FindSonarPreset("p900-45");
  sim::MockupTankOptions tank = sim::MockupTankOfSize(sim::SizeVariant::kStandard);
  tank.tank.surface = true;
  ParameterSet without = Parameters();
  without.model = EchoModel::kAcoustic;
  ParameterSet with = without;
  with.mirrors = {{"floor", {10.5}}, {"wall", {6.0}}, {"surface", {0.7}}};
  sim::SimulationOptions options = Options(preset, sim::AcousticFanOptions(preset.sonar, without));
  options.noise = false;
  // One each, as a simulator keeps what frames of the same parameters share.
  const sim::Simulator simulator(sim::MakeMockupTank(tank), preset.sonar, options);
  const sim::Simulator mirrored(simulator.shared_caster(), preset.sonar, options);
  const Pose pose = sim::MockupTankPoses(3).front();
  const auto seconds = [&](const sim::Simulator& of, const ParameterSet& parameters) {
    const double began = Now();
    const PolarImage image = of.Render(pose, parameters);
    benchmark::DoNotOptimize(image.value.values().data());
    return Now() - began;
  };
  while (state.KeepRunning()) {
    seconds(simulator, without);
    seconds(mirrored, with);
    std::vector<double> direct;
    std::vector<double> ghosts;
    std::vector<double> ratio;
    for (int round = 0; round < kRounds; ++round) {
      direct.push_back(seconds(simulator, without));
      ghosts.push_back(seconds(mirrored, with));
      ratio.push_back(ghosts.back() / direct.back());
    }
    state.counters["direct_ms"] = 1e3 * Median(direct);
    state.counters["with_ghosts_ms"] = 1e3 * Median(ghosts);
    state.counters["ratio"] = Median(ratio);
    state.counters["limit"] = 2.0;
    state.counters["echoes"] = static_cast<double>(mirrored.TraceGhosts(pose, with).echoes.size());
  }
}
BENCHMARK(TankGhosts)->Iterations(1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace sonarcal::benchmarks
