// Steps of Gauss and Newton, damped (Levenberg, Marquardt), that are taken only where a cost falls. Slopes
// are the caller's: the images that they are differences of are traced, so that one set may serve several
// steps.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <utility>

namespace sonarcal::calib {

// Quadratic model of a cost around a state: cost(step) = cost - score . step + 1/2 step . information . step.
struct QuadraticCost {
  Eigen::MatrixXd information;
  Eigen::VectorXd score;
};

// Takes a step to a lower cost: `trial_at(step)` gives the state there, `State::cost` its cost. Raises the
// damping tenfold until the cost falls, at most four times, and lowers it after success. Ends if the model
// promises a fall of less than `least`. Returns by how much the cost fell; 0 if no damping made it fall, and
// then the state is kept.
template <typename State, typename TrialAt>
double DampedStep(const QuadraticCost& normal, double least, const TrialAt& trial_at, double& damping,
                  State& state) {
  constexpr int kTries = 5;
  constexpr double kMinDamping = 1e-6;
  for (int i = 0; i < kTries; ++i, damping *= 10.0) {
    Eigen::MatrixXd damped = normal.information;
    damped.diagonal() *= 1.0 + damping;
    const Eigen::VectorXd step = damped.ldlt().solve(normal.score);
    if (!(normal.score.dot(step) - 0.5 * step.dot(normal.information * step) >= least)) return 0.0;
    State trial = trial_at(step);
    if (!(trial.cost < state.cost)) continue;
    const double fall = state.cost - trial.cost;
    state = std::move(trial);
    damping = std::max(0.2 * damping, kMinDamping);
    return fall;
  }
  return 0.0;
}

}  // namespace sonarcal::calib
