// How a scene is sampled: rays, normals, absorption, threads.
//
// Sampling of a recording that the paper's model simulated. The paper gives each ray the same weight, so the
// two samplings have different images (docs/guide/rays.md), and a fit with the other sampling is biased.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "core/types/option.h"
#include "core/types/recording.h"
#include "sim/simulator.h"

namespace sonarcal::workflow {

inline constexpr RayGridSize kFrustumRays = {1500, 1200};  // the paper's

struct RayOptions {
  std::optional<sim::Sampling> sampling;  // absent: SamplingFor
  std::optional<RayGridSize> rays;
  sim::RayWeight ray_weight = sim::RayWeight::kEven;
  sim::NormalSource normals = sim::NormalSource::kGeometric;
  sim::AbsorptionFormula absorption = sim::AbsorptionFormula::kAuto;
  int threads = 0;  // 0: all cores

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor&& visit) {
    visit(
        OptionInfo{.name = "sampling",
                   .help = "Arrangement of the rays: a pinhole grid as in the paper, or equal angles within "
                           "each beam",
                   .by_default = "beams; frustum for the coherent model"},
        self.sampling);
    visit(OptionInfo{.name = "rays",
                     .help = "Columns x rows of rays over the field of view",
                     .by_default = "by sonar and model; 1500x1200 for frustum"},
          self.rays);
    visit(OptionInfo{.name = "ray_weight",
                     .help = "Weight of a ray in the paper's model: equal, as in the paper, or by its solid "
                             "angle, for which both samplings give the same image"},
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

  // The one asked for; else for the paper's model `beams`, which need the fewest rays (docs/guide/rays.md). The
  // acoustic model has rays of its own, and the scatterers of the coherent one stand on the rays, of which
  // there are to be many: `frustum`.
  sim::Sampling SamplingFor(EchoModel model) const;

  // Fan, trace, absorption and water of a simulation of this sonar by a model: `beams` are staggered for the
  // paper's.
  sim::SimulationOptions For(const SonarModel& sonar, const Water& water,
                             EchoModel model = EchoModel::kPaper) const;

  // The same for these parameters and their model. Of other models than the paper's rays are those of
  // sim/rays/acoustic_fan.h unless a pinhole is asked for, and the fan reaches as far as the beam hears,
  // however many rays are asked for; a pinhole's as far as it can.
  //
  // Both throw UsageError for fewer columns than beams, where each beam takes columns of its own.
  sim::SimulationOptions For(const SonarModel& sonar, const Water& water,
                             const ParameterSet& parameters) const;
};

// Options of the azimuth that is cast and of ghosts.
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

// Throws UsageError where a weight is chosen for a model that takes none: only the paper's sums over rays.
void CheckRayWeight(sim::RayWeight weight, EchoModel model);

// Sentence about the number of rays if it differs from --rays, because each beam takes whole columns; else
// empty.
std::string RaysNote(const RayOptions& options, const sim::Simulator& simulator);

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

struct RaysForFit {
  RayOptions rays;      // as they are to be cast
  std::string note;     // what was taken from the recording; empty: nothing
  std::string warning;  // how the requested rays differ from the recording's; empty: they agree
};

// Returns the rays for a fit of `model`. The recording gives what the caller does not.
RaysForFit ChooseRays(const RayOptions& asked, const RecordingInfo& info, EchoModel model);

}  // namespace sonarcal::workflow
