#include "calib/standard_target/target_position.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "core/types/units.h"

namespace sonarcal::calib {
namespace {

constexpr double kAzimuthErrorRad = 1e-3;
constexpr double kRangeErrorShare = 1e-3;

struct Step {
  double cost = 0.0;
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Eigen::Vector3d slope = Eigen::Vector3d::Zero();
};

Step StepAt(const std::vector<TargetSight>& sights, const Eigen::Vector3d& position_m) {
  Step step;
  for (const TargetSight& sight : sights) {
    const Eigen::Vector3d at = sight.world_from_sonar.Inverse() * position_m;
    const Eigen::Matrix3d sonar_from_world = sight.world_from_sonar.rotation.conjugate().toRotationMatrix();
    const double range_error_m = kRangeErrorShare * sight.range_m;
    const double across = at.head<2>().squaredNorm();
    Eigen::Matrix<double, 2, 3> rows;
    rows.row(0) = at.transpose() / (at.norm() * range_error_m);
    rows.row(1) = Eigen::RowVector3d(at.y(), -at.x(), 0.0) / (across * kAzimuthErrorRad);
    const Eigen::Vector2d residual((at.norm() - sight.range_m) / range_error_m,
                                   (std::atan2(at.x(), at.y()) - sight.azimuth_rad) / kAzimuthErrorRad);
    rows = rows * sonar_from_world;
    step.cost += residual.squaredNorm();
    step.information += rows.transpose() * rows;
    step.slope += rows.transpose() * residual;
  }
  return step;
}

// Damped Gauss-Newton steps from a start.
Eigen::Vector3d Refine(const std::vector<TargetSight>& sights, Eigen::Vector3d position_m) {
  double damping = 1e-3;
  Step at = StepAt(sights, position_m);
  for (int i = 0; i < 100; ++i) {
    Eigen::Matrix3d damped = at.information;
    damped.diagonal() *= 1.0 + damping;
    const Eigen::Vector3d move = -damped.ldlt().solve(at.slope);
    const Step next = StepAt(sights, position_m + move);
    if (next.cost <= at.cost) {
      position_m += move;
      at = next;
      damping *= 0.3;
      if (move.norm() < 1e-7) break;
    } else {
      damping *= 10.0;
      if (damping > 1e12) break;
    }
  }
  return position_m;
}

}  // namespace

std::optional<TargetPosition> LocateTarget(const std::vector<TargetSight>& sights) {
  if (sights.size() < 3) return {};
  constexpr double kStartElevationRad = 0.17;  // 10 degrees
  std::optional<Eigen::Vector3d> best;
  double lowest = 0.0;
  const TargetSight& first = sights.front();
  for (const double elevation_rad : {-kStartElevationRad, kStartElevationRad}) {
    const Eigen::Vector3d start =
        first.world_from_sonar *
        (first.range_m * Eigen::Vector3d(std::cos(elevation_rad) * std::sin(first.azimuth_rad),
                                         std::cos(elevation_rad) * std::cos(first.azimuth_rad),
                                         std::sin(elevation_rad)));
    const Eigen::Vector3d position_m = Refine(sights, start);
    const double cost = StepAt(sights, position_m).cost;
    if (!best || cost < lowest) {
      best = position_m;
      lowest = cost;
    }
  }
  const Step at = StepAt(sights, *best);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(at.information);
  const double freedom = std::max(1.0, 2.0 * static_cast<double>(sights.size()) - 3.0);
  const double inflation = std::max(1.0, at.cost / freedom);
  const double weakest_m = std::sqrt(inflation / axes.eigenvalues()(0));
  if (!(weakest_m < RadFromDeg(1.0) * first.range_m)) return {};
  TargetPosition result{.position_m = *best};
  for (const TargetSight& sight : sights) {
    const Eigen::Vector3d in_sonar = sight.world_from_sonar.Inverse() * *best;
    const double azimuth_error_rad = std::atan2(in_sonar.x(), in_sonar.y()) - sight.azimuth_rad;
    result.range_error_m += std::pow(in_sonar.norm() - sight.range_m, 2);
    result.azimuth_error_rad += azimuth_error_rad * azimuth_error_rad;
    result.elevation_rad.push_back(std::asin(in_sonar.z() / in_sonar.norm()));
  }
  const auto count = static_cast<double>(sights.size());
  result.range_error_m = std::sqrt(result.range_error_m / count);
  result.azimuth_error_rad = std::sqrt(result.azimuth_error_rad / count);
  return result;
}

}  // namespace sonarcal::calib
