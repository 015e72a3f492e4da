#include "calib/joint_steps.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "calib/identifiability.h"
#include "calib/parameters/fit_options.h"
#include "calib/problem_builder.h"

namespace sonarcal::calib {
namespace {

// Damping, from a full Gauss-Newton step to a short step downhill. Strong damping is needed because nothing
// is linear if edges move by more than the width of pulse and beam.
constexpr double kLeastDamping = 1e-3;
constexpr int kTries = 7;
constexpr double kHarder = 8.0;

class Stepper {
 public:
  Stepper(AcousticFrameModel& model, const std::vector<CatalogEntry>& catalog, const std::vector<int>& active,
          const std::function<void(ParameterValues&)>& settle)
      : model_(model), catalog_(catalog), active_(active), settle_(settle) {
    for (const int entry : active) {
      if (IsGeometric(catalog[entry])) geometric_.push_back(entry);
    }
  }

  // Traces at `values`. Returns the cost there.
  double CostAbout(const ParameterValues& values) {
    model_.Linearise(values, {});
    return CostHere(values);
  }

  // Cost in the model about the last traced point.
  double CostHere(const ParameterValues& values) const {
    double cost = CostAt(model_, values, model_.frame_count());
    for (const int entry : active_) cost += 0.5 * std::pow(catalog_[entry].FromPrior(values[entry]), 2);
    return cost;
  }

  // Traces at `values`, with derivatives.
  void Linearise(const ParameterValues& values) { model_.Linearise(values, geometric_); }

  struct Found {
    ParameterValues values;
    double cost = 0.0;
  };

  // Moves the directions that the frames do not determine back to their priors, if this costs nothing.
  std::optional<Found> Return(const ParameterValues& values, double cost, double roughness) {
    const NormalEquations equations =
        Accumulate(model_, catalog_, {.active = active_, .values = values}, FitOptions{});
    const Eigen::MatrixXd open = Directions(equations.information).open;
    if (open.cols() == 0) return std::nullopt;
    Eigen::VectorXd off(static_cast<Eigen::Index>(active_.size()));
    for (std::size_t k = 0; k < active_.size(); ++k)
      off(static_cast<Eigen::Index>(k)) = catalog_[active_[k]].FromPrior(values[active_[k]]);
    Found trial{.values = Moved(values, -Scales().cwiseProduct(open * (open.transpose() * off))),
                .cost = 0.0};
    trial.cost = CostAbout(trial.values);
    if (!(trial.cost < cost + roughness)) return std::nullopt;
    return trial;
  }

  // Returns a step downhill from the point of linearisation. Nullopt if no damping finds one, or if none
  // promises enough gain.
  std::optional<Found> Step(const ParameterValues& values, double cost, double least, double roughness) {
    const NormalEquations equations =
        Accumulate(model_, catalog_, {.active = active_, .values = values}, FitOptions{});
    Eigen::MatrixXd information = equations.information;
    information.diagonal() += equations.prior;
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(equations.prior.size());
    for (const NormalEquations::Block& block : equations.blocks) gradient += block.score;
    for (std::size_t k = 0; k < active_.size(); ++k) {
      const auto& prior = catalog_[active_[k]].prior;
      if (prior)
        gradient(static_cast<Eigen::Index>(k)) +=
            catalog_[active_[k]].FromPrior(values[active_[k]]) / prior->sigma;
    }
    const Eigen::MatrixXd told = Scales().asDiagonal() * Directions(equations.information).told;
    for (int i = 0; i < kTries; ++i, damping_ *= kHarder) {
      Eigen::MatrixXd damped = information;
      damped.diagonal() *= 1.0 + damping_;
      const Eigen::VectorXd step =
          -told * (told.transpose() * damped * told).ldlt().solve(told.transpose() * gradient);
      const double promised = -gradient.dot(step) - 0.5 * step.dot(information * step);
      if (promised < least) return std::nullopt;
      Found trial{.values = Moved(values, step), .cost = 0.0};
      trial.cost = CostAbout(trial.values);
      // Refits the curves before the comparison: the trial is about poses, and curves may adapt.
      if (settle_) {
        settle_(trial.values);
        trial.cost = CostHere(trial.values);
      }
      if (!(trial.cost < cost + roughness)) continue;
      damping_ = std::max(damping_ / (kHarder * kHarder), kLeastDamping);
      return trial;
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
    double cost = CostAbout(mean);
    if (settle_) {
      settle_(mean);
      cost = CostHere(mean);
    }
    return cost < lowest->cost + roughness ? mean : lowest->values;
  }

 private:
  // Directions as columns, in units of the prior sigmas.
  struct Split {
    Eigen::MatrixXd told;  // directions with more information from the frames than from the prior
    // the others; steps along them would follow errors of the slopes from rays at edges
    Eigen::MatrixXd open;
  };
  Split Directions(const Eigen::MatrixXd& of_frames) const {
    const Eigen::VectorXd sigma = Scales();
    const double pixels_per_cell = model_.speckle_cell().bins * model_.speckle_cell().beams;
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(sigma.asDiagonal() * of_frames *
                                                                sigma.asDiagonal() / pixels_per_cell);
    // eigenvalues ascend
    const Eigen::Index open = (solver.eigenvalues().array() < 1.0 / kOpenShare).count();
    return {.told = solver.eigenvectors().rightCols(of_frames.rows() - open),
            .open = solver.eigenvectors().leftCols(open)};
  }

  Eigen::VectorXd Scales() const {
    Eigen::VectorXd sigma(static_cast<Eigen::Index>(active_.size()));
    for (std::size_t k = 0; k < active_.size(); ++k) {
      const CatalogEntry& of = catalog_[active_[k]];
      sigma(static_cast<Eigen::Index>(k)) = of.prior ? of.prior->sigma : of.typical_step;
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
  const std::function<void(ParameterValues&)>& settle_;
  std::vector<int> geometric_;
  double damping_ = kLeastDamping;
};

}  // namespace

bool TakeJointSteps(AcousticFrameModel& model, const std::vector<CatalogEntry>& catalog,
                    const std::vector<int>& active, const JointStepOptions& options,
                    const std::function<void(ParameterValues&)>& settle, ParameterValues& values,
                    const std::function<void(const std::string&)>& progress) {
  Stepper stepper(model, catalog, active, settle);
  double cost = stepper.CostAbout(values);
  const double roughness = options.roughness * std::sqrt(static_cast<double>(model.frame_count()));
  stepper.Linearise(values);
  if (const auto back = stepper.Return(values, cost, roughness)) {
    values = back->values;
    cost = back->cost;
  }
  std::vector<Stepper::Found> reached = {{values, cost}};
  bool ended = false;
  for (int step = 0; step < options.steps && !ended; ++step) {
    stepper.Linearise(values);
    const auto found = stepper.Step(values, cost, options.least, roughness);
    ended = !found;
    if (found) {
      if (progress) {
        progress(fmt::format("step {} of poses and curves: cost {:.1f}, before it {:.1f}", step + 1,
                             found->cost, cost));
      }
      values = found->values;
      cost = found->cost;
      reached.push_back(*found);
    }
  }
  values = stepper.AmongAlike(reached, roughness);
  stepper.Linearise(values);
  return ended;
}

}  // namespace sonarcal::calib
