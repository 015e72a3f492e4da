// Options for sampling a scene: rays, normals, absorption, threads.
//
// ChooseRays takes sampling and weight from a recording that the paper's model simulated. The paper gives
// each ray the same weight, so the two samplings give different images (docs/guide/rays.md), and a fit with
// the other sampling is biased.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "core/types/option.h"
#include "core/types/recording.h"
#include "sim/simulator.h"

namespace sonarcal::workflow {

inline constexpr RayGridSize kFrustumRays = {1500, 1200};  // as in the paper

struct RayOptions {
  std::optional<sim::Sampling> sampling;  // absent: SamplingFor
  std::optional<RayGridSize> rays;
  std::optional<sim::RayWeight> ray_weight;  // absent: weight()
  sim::NormalSource normals = sim::NormalSource::kGeometric;
  sim::AbsorptionFormula absorption = sim::AbsorptionFormula::kAuto;
  int threads = 0;  // 0: all cores

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor&& visit) {
    visit(
        OptionInfo{.name = "sampling",
                   .help = "Arrangement of the rays: a pinhole grid as in the paper, or equal angles within "
                           "each beam",
                   .by_default = self.sampling
                                     ? std::string(ToString(*self.sampling))
                                     : "beams; in a fit to a recording made by the paper's model: that of "
                                       "the recording"},
        self.sampling);
    visit(OptionInfo{.name = "rays",
                     .help = "Columns x rows of rays over the field of view",
                     .by_default = "by sonar and model; 1500x1200 for frustum"},
          self.rays);
    visit(OptionInfo{.name = "ray_weight",
                     .help = "Weight of a ray in the paper's model: equal, as in the paper, or by its solid "
                             "angle, for which both samplings give the same image",
                     .by_default =
                         "even; in a fit to a recording made by the paper's model: that of the recording"},
          self.ray_weight);
    visit(
        OptionInfo{.name = "normals",
                   .help = "Surface normals: from the mesh, or from differences of the depth image as in the "
                           "paper"},
        self.normals);
    visit(OptionInfo{.name = "absorption",
                     .help =
                         "Absorption formula: the paper's (ainslie-mccolm), francois-garrison, or auto: the "
                         "paper's within its limits, else francois-garrison"},
          self.absorption);
    visit(OptionInfo{.name = "threads", .help = "Threads to use, 0 for all cores", .min = 0, .max = 1024},
          self.threads);
  }

  RayOptions() = default;
  explicit RayOptions(sim::Sampling default_sampling) : sampling(default_sampling) {}

  // Returns the requested sampling, else the one whose default number of rays serves the model. Paper:
  // `beams`, which need the fewest rays (docs/guide/rays.md). Others: `frustum`, which For replaces by a fan
  // of `beams` if it is given the parameters.
  sim::Sampling SamplingFor(EchoModel model) const;

  // Returns the requested weight, else that of the paper.
  sim::RayWeight weight() const { return ray_weight.value_or(sim::RayWeight::kEven); }

  // Returns fan, trace, absorption and water for a simulation of this sonar by a model. For the paper's model
  // `beams` are staggered.
  sim::SimulationOptions For(const SonarModel& sonar, const Water& water,
                             EchoModel model = EchoModel::kPaper) const;

  // As above, for these parameters and their model. Except for the paper's model, the rays are those of
  // sim/rays/acoustic_fan.h unless a frustum is requested. That fan covers all elevations that the beam
  // receives, for any number of rays; a frustum covers as much as it can.
  //
  // Both throw UsageError if there are fewer columns than beams and each beam needs columns of its own.
  sim::SimulationOptions For(const SonarModel& sonar, const Water& water,
                             const ParameterSet& parameters) const;
};

// Describes the options for the azimuth that is cast and for ghosts.
template <typename Order, typename Margin, typename Visitor>
void VisitReach(Order& ghost_order, Margin& margin_deg, Visitor&& visit) {
  visit(OptionInfo{.name = "ghost_order",
                   .help = "Max number of reflections on one leg by the parameters' mirrors: 1 or 2",
                   .min = 1,
                   .max = 2},
        ghost_order);
  visit(OptionInfo{.name = "margin",
                   .help = "Azimuth cast beyond the outer beams, degrees",
                   .unit = "deg",
                   .by_default = "0 for paper, else 3 beam widths, max 20"},
        margin_deg);
}

// Throws UsageError if a ray weight is chosen for a model other than the paper's. Only that model sums over
// rays.
void CheckRayWeight(std::optional<sim::RayWeight> weight, EchoModel model);

// Returns a sentence about the number of rays if it differs from --rays because each beam takes whole
// columns. Otherwise returns an empty text.
std::string RaysNote(const RayOptions& options, const sim::Simulator& simulator);

// Limits the program to `threads` threads during its lifetime; 0: all cores.
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

struct RaysForFit {
  RayOptions rays;      // as they will be cast
  std::string note;     // what was taken from the recording; empty: nothing
  std::string warning;  // how the requested rays differ from the recording's; empty: they agree
};

// Returns the rays for a fit of `model`. The recording gives what the caller does not.
RaysForFit ChooseRays(const RayOptions& asked, const RecordingInfo& info, EchoModel model);

}  // namespace sonarcal::workflow
