// The options by which simulate and fit say how a scene is sampled: rays, normals, absorption, threads.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "sim/simulator.h"

namespace CLI {
class App;
}

namespace sonarcal {

struct RayGridSize {
  int cols = 0;
  int rows = 0;
};

// "1500x1200". Throws UsageError where `text` is anything else.
RayGridSize ParseRayGridSize(const std::string& text);

struct RayOptions {
  std::optional<Sampling> sampling;  // absent: beams; SamplingFor, where only the model is known
  std::string rays;  // "WxH"; empty: 1500x1200 for frustum (the paper's), 2 a beam x 330 for beams
  RayWeight weight = RayWeight::kEven;
  NormalSource normals = NormalSource::kGeometric;
  AbsorptionFormula absorption = AbsorptionFormula::kAuto;
  int threads = 0;  // 0: all cores

  RayOptions() = default;
  explicit RayOptions(Sampling default_sampling) : sampling(default_sampling) {}

  // The one asked for; else for the paper's model `beams`, which need the fewest rays (docs/guide/rays.md). The
  // acoustic model has rays of its own, and the scatterers of the coherent one stand on the rays, of which
  // there are to be many: `frustum`.
  Sampling SamplingFor(EchoModel model) const;

  // Fan, trace, absorption and water of a simulation of this sonar by a model: `beams` are staggered for the
  // paper's. Throws UsageError for a wrong `rays`.
  SimulationOptions For(const SonarModel& sonar, const Water& water,
                        EchoModel model = EchoModel::kPaper) const;

  // The same for these parameters and their model. Of other models than the paper's rays are those of
  // sim/rays/acoustic_fan.h unless a pinhole is asked for, and the fan reaches as far as the beam hears,
  // however many rays are asked for; a pinhole's as far as it can.
  //
  // Both throw UsageError for fewer columns than beams, where each beam takes columns of its own.
  SimulationOptions For(const SonarModel& sonar, const Water& water, const ParameterSet& parameters) const;
};

// Adds --sampling, --rays, --ray-weight, --normals, --absorption and --threads.
void AddRayOptions(CLI::App& command, RayOptions& options);

// Adds --ray-weight alone.
void AddRayWeight(CLI::App& command, RayWeight& weight);

// Adds --absorption alone.
void AddAbsorption(CLI::App& command, AbsorptionFormula& absorption);

// Adds --ghost-order and --margin: how far rays go on from mirrors, and beyond the outer beams.
void AddReachOptions(CLI::App& command, int& ghost_order, std::optional<double>& margin_deg);

// Throws UsageError where a weight is chosen for a model that takes none: only the paper's sums over rays.
void CheckRayWeight(RayWeight weight, EchoModel model);

// Sentence about the number of rays if it differs from --rays, because each beam takes whole columns; else
// empty.
std::string RaysNote(const RayOptions& options, const Simulator& simulator);

std::string_view ToString(Sampling sampling);
std::string_view ToString(RayWeight weight);
std::string_view ToString(NormalSource normals);
std::string_view ToString(AbsorptionFormula formula);

// As resolved, for provenance: the grid is the one that is cast.
nlohmann::ordered_json RayOptionsJson(const RayOptions& options, const RayGridSize& grid);

// Holds the program to `threads` threads as long as it lives; 0 for all cores.
class ThreadLimit {
 public:
  explicit ThreadLimit(int threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  struct Control;
  std::unique_ptr<Control> control_;
};

}  // namespace sonarcal
