#include "calib/joint_steps.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "calib/identifiability.h"
#include "calib/problem_builder.h"

namespace sonarcal::calib {
namespace {

// Damping (Levenberg), in units of the information of the priors: a step goes hardly farther than a prior's
// standard deviation over the root of the damping. It shortens steps along directions that the frames
// determine weakly, where nothing is linear if edges move by more than the width of pulse and beam. Strongly
// determined directions keep their whole step.
constexpr double kLeastDamping = 1.0;
constexpr int kTries = 8;
constexpr double kHarder = 8.0;

// Number of steps that end the search if they lower the cost by less than its roughness together. Points of a
// flat valley are averaged, so more than one.
constexpr int kStepsInValley = 4;

// The roughness of the cost is measured again when the cost fell to this fraction: where the scene fits
// badly, each ray counts for more.
constexpr double kRoughAgain = 0.9;

class Stepper {
 public:
  Stepper(AcousticFrameModel& model, const std::vector<CatalogEntry>& catalog, const std::vector<int>& active,
          const JointStepOptions& options)
      : model_(model), catalog_(catalog), active_(active), options_(options) {
    for (const int entry : active) {
      if (IsGeometric(catalog[entry])) geometric_.push_back(entry);
    }
  }

  // Traces at `values`. Returns the cost there, with priors.
  double TracedCost(const ParameterValues& values) const { return options_.cost(values) + OfPriors(values); }

  // Returns the cost at the point of linearisation, with priors, without tracing. The model bins its echoes,
  // so this differs from the traced cost. The difference is nearly the same for all curves.
  double CostAtPoint(const ParameterValues& values) const {
    return CostAt(model_, values, model_.frame_count()) + OfPriors(values);
  }

  // Gathers the echoes at `values`, with derivatives.
  void Linearise(const ParameterValues& values) { model_.Linearise(values, geometric_); }

  struct Found {
    ParameterValues values;
    double cost = 0.0;
  };

  // Returns a step from the point of linearisation to a cost below `limit`. Nullopt if no damping finds one,
  // or if none promises a gain of `least`.
  std::optional<Found> Step(const ParameterValues& values, double least, double limit) {
    const Directions along = DirectionsAt(values);
    const auto step_with = [&](double pull) {
      const Eigen::ArrayXd share = along.told + pull * (1.0 - along.told);
      return Eigen::ArrayXd(-share * along.slope / (along.curvature + damping_ * along.told));
    };
    const auto promised = [&](const Eigen::ArrayXd& step) {
      return -(along.slope * step + 0.5 * along.curvature * step.square()).sum();
    };
    bool pulls = true;  // whether the step also goes towards the priors
    for (int i = 0; i < kTries; ++i) {
      const Eigen::ArrayXd step = step_with(pulls ? pull_ : 0.0);
      if (promised(step) < least) return std::nullopt;
      Found trial{.values = Moved(values, Scales().cwiseProduct(along.vectors * step.matrix())), .cost = 0.0};
      trial.cost = TracedCost(trial.values);
      if (trial.cost < limit) {
        if (pulls) pull_ = std::min(1.0, 2.0 * pull_);
        damping_ = std::max(damping_ / (kHarder * kHarder), kLeastDamping);
        return trial;
      }
      if (pulls) {
        pull_ /= kHarder;
      } else {
        damping_ *= kHarder;
      }
      pulls = promised(step_with(0.0)) < least;  // then only the way to the priors is left
    }
    return std::nullopt;
  }

  // Returns the mean of the points whose costs are equal within the roughness, unless tracing shows a higher
  // cost there. These points differ by random errors of the slopes, from rays at edges. Their mean is closer
  // to the bottom of the valley than each of them.
  ParameterValues AmongAlike(const std::vector<Found>& reached, double roughness) {
    const auto lowest = std::min_element(reached.begin(), reached.end(),
                                         [](const Found& a, const Found& b) { return a.cost < b.cost; });
    std::vector<const Found*> alike;
    for (const Found& found : reached) {
      if (found.cost <= lowest->cost + roughness) alike.push_back(&found);
    }
    if (alike.size() == 1) return lowest->values;
    ParameterValues mean = lowest->values;
    for (const int entry : active_) {
      double sum = 0.0;
      for (const Found* found : alike) sum += catalog_[entry].CoordinateFromValue(found->values[entry]);
      mean[entry] = catalog_[entry].ValueFromCoordinate(sum / static_cast<double>(alike.size()));
    }
    return TracedCost(mean) < lowest->cost + roughness ? mean : lowest->values;
  }

 private:
  double OfPriors(const ParameterValues& values) const { return CostOfPriors(catalog_, active_, values); }

  // Directions in which the cost is a sum of parabolas, in units of the prior sigmas.
  struct Directions {
    Eigen::MatrixXd vectors;  // columns
    Eigen::ArrayXd slope;     // of the cost
    Eigen::ArrayXd curvature;
    Eigen::ArrayXd told;  // 1 where the frames determine the direction, 0 where priors alone count
  };

  // Placements follow priors alone along directions that the frames do not determine (kOpenShare): there the
  // slopes of images are mostly errors, from rays that appear and disappear at edges. Curves stay there. The
  // way to their priors is far from linear, such as that of a term that contributes nothing.
  Directions DirectionsAt(const ParameterValues& values) const {
    const CostSlopes slopes = SlopesOfCost(model_, catalog_, {.active = active_, .values = values});
    Eigen::VectorXd off = Eigen::VectorXd::Zero(slopes.gradient.size());
    Eigen::VectorXd placements_off = off;
    for (std::size_t k = 0; k < active_.size(); ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      off(i) = catalog_[active_[k]].FromPrior(values[active_[k]]);
      if (IsGeometric(catalog_[active_[k]])) placements_off(i) = off(i);
    }
    const Eigen::VectorXd sigma = Scales();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(sigma.asDiagonal() * slopes.information *
                                                                sigma.asDiagonal());
    const Eigen::ArrayXd told =
        (solver.eigenvalues().array() >= model_.speckle_cell().pixels() / kOpenShare).cast<double>();
    const Eigen::MatrixXd& vectors = solver.eigenvectors();
    const auto along = [&](const Eigen::VectorXd& slope) {
      return (vectors.transpose() * slope).array().eval();
    };
    return {.vectors = vectors,
            .slope = told * along(sigma.cwiseProduct(slopes.gradient) + off) +
                     (1.0 - told) * along(placements_off),
            .curvature = told * solver.eigenvalues().array() + 1.0,
            .told = told};
  }

  Eigen::VectorXd Scales() const {
    Eigen::VectorXd sigma(static_cast<Eigen::Index>(active_.size()));
    for (std::size_t k = 0; k < active_.size(); ++k) {
      sigma(static_cast<Eigen::Index>(k)) = catalog_[active_[k]].StepSigma();
    }
    return sigma;
  }

  ParameterValues Moved(const ParameterValues& values, const Eigen::VectorXd& by) const {
    ParameterValues moved = values;
    for (std::size_t k = 0; k < active_.size(); ++k) {
      const CatalogEntry& of = catalog_[active_[k]];
      const double value = of.ValueFromCoordinate(of.CoordinateFromValue(values[active_[k]]) +
                                                  by(static_cast<Eigen::Index>(k)));
      moved[active_[k]] = std::clamp(value, of.lower, of.upper);
    }
    return moved;
  }

  AcousticFrameModel& model_;
  const std::vector<CatalogEntry>& catalog_;
  const std::vector<int>& active_;
  const JointStepOptions& options_;
  std::vector<int> geometric_;
  double damping_ = kLeastDamping;
  double pull_ = 1.0;  // share of the way to the priors that the last step could go
};

}  // namespace

bool TakeJointSteps(AcousticFrameModel& model, const std::vector<CatalogEntry>& catalog,
                    const std::vector<int>& active, const JointStepOptions& options, ParameterValues& values,
                    const std::function<void(const std::string&)>& progress) {
  Stepper stepper(model, catalog, active, options);
  std::vector<Stepper::Found> reached = {{values, stepper.TracedCost(values)}};
  double roughness = options.roughness(values);
  double rough_at = reached.front().cost;
  double lowest = rough_at;
  double of_valley = rough_at;  // cost at its entrance
  int in_valley = 0;            // steps
  bool ended = false;
  for (int step = 0; step < options.steps && !ended; ++step) {
    stepper.Linearise(values);
    if (step > 0 && options.settle) {
      ParameterValues settled = values;
      options.settle(settled);
      const double gain = stepper.CostAtPoint(values) - stepper.CostAtPoint(settled);
      if (gain > 0.0) {
        values = std::move(settled);
        reached.back() = {values, reached.back().cost - gain};
        lowest = std::min(lowest, reached.back().cost);
      }
    }
    // The first one is taken for any gain: directions that the frames do not determine go to their priors.
    const auto found = stepper.Step(values, step == 0 ? 0.0 : options.least, lowest + roughness);
    ended = !found;
    if (!found) continue;
    if (progress) {
      progress(fmt::format("step {} of poses and curves: cost {:.1f}, before it {:.1f}", step + 1,
                           found->cost, reached.back().cost));
    }
    values = found->values;
    reached.push_back(*found);
    lowest = std::min(lowest, found->cost);
    const bool lower = found->cost < of_valley - std::max(options.least, roughness);
    in_valley = lower ? 0 : in_valley + 1;
    if (lower) of_valley = found->cost;
    ended = in_valley >= kStepsInValley;
    if (lowest < kRoughAgain * rough_at) {
      rough_at = lowest;
      roughness = options.roughness(values);
    }
  }
  values = stepper.AmongAlike(reached, roughness);
  return ended;
}

}  // namespace sonarcal::calib
