// What a simulator of a large scene takes beyond its mesh, at its peak: Embree's tree and what building it
// takes, the triangles' normals, and a frame of 1500 x 1200 rays.
//
// "The mesh" is the Scene as it was read: 12 bytes a vertex, 12 a triangle for its corners, 2 for its
// material. It is there before the measure begins, is handed over to the simulator, and is not counted.
#include <benchmark/benchmark.h>
#include <malloc.h>

#include <fstream>
#include <string>
#include <utility>

#include "tests/benchmarks/benchmark_world.h"

namespace sonarcal::benchmarks {
namespace {

constexpr double kMiB = 1024.0 * 1024.0;

// A line of /proc/self/status, in MiB.
double StatusMiB(const std::string& name) {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    double kib = 0.0;
    if (word == name + ":" && status >> kib) return kib / 1024.0;
  }
  return 0.0;
}

void Memory(benchmark::State& state) {
  const sim::SonarPreset& preset = sim::FindSonarPreset("p900-45");
  while (state.KeepRunning()) {
    Scene scene = Tank(static_cast<int>(state.range(0)) / 2);
    malloc_trim(0);                               // what making the scene took and gave back
    std::ofstream("/proc/self/clear_refs") << 5;  // the peak starts from what is there now
    const double before = StatusMiB("VmRSS");
    const auto triangles = static_cast<double>(scene.triangles.size());
    const double mesh_bytes = 12.0 * static_cast<double>(scene.vertices_m.size()) + 14.0 * triangles;
    const sim::Simulator simulator(std::move(scene), preset.sonar, Options(preset, kPaperRays));
    const PolarImage image = simulator.Render(sim::MockupTankPoses(3).front(), Parameters());
    benchmark::DoNotOptimize(image.value.values().data());
    state.counters["triangles"] = triangles;
    state.counters["mesh_MiB"] = mesh_bytes / kMiB;
    state.counters["after_MiB"] = StatusMiB("VmRSS") - before;
    state.counters["peak_MiB"] = StatusMiB("VmHWM") - before;
    state.counters["limit"] = 1024.0;
  }
}
BENCHMARK(Memory)->Arg(10'000'000)->Iterations(1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace sonarcal::benchmarks
