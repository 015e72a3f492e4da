#include "calib/standard_target/target_position.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <utility>

#include "calib/poses/equally_good.h"
#include "core/types/units.h"

namespace sonarcal::calib {
namespace {

constexpr double kMaxElevationErrorRad = RadFromDeg(1.0);

double ElevationRad(const TargetSight& sight, const Eigen::Vector3d& position_m) {
  const Eigen::Vector3d in_sonar = sight.world_from_sonar.Inverse() * position_m;
  return std::asin(in_sonar.z() / in_sonar.norm());
}

// Errors are in units of the tolerance.
class Locator {
 public:
  Locator(const std::vector<TargetSight>& sights, const SightTolerance& tolerance)
      : sights_(sights), tolerance_(tolerance) {}

  // Refines positions at several elevations of several sights, and returns the one of the lowest cost.
  Eigen::Vector3d Search() const {
    constexpr double kStepRad = 0.1;
    constexpr int kSteps = 4;  // on either side of the image plane
    constexpr std::size_t kSightsToStart = 8;
    const std::size_t step = std::max<std::size_t>(1, sights_.size() / kSightsToStart);
    Eigen::Vector3d best = Eigen::Vector3d::Zero();
    double lowest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < sights_.size(); i += step) {
      for (int k = -kSteps; k <= kSteps; ++k) {
        const Eigen::Vector3d position_m = Refine(At(sights_[i], k * kStepRad));
        const double cost = StepAt(position_m).cost;
        if (cost < lowest) {
          best = position_m;
          lowest = cost;
        }
      }
    }
    return best;
  }

  std::vector<TargetSight> AgreeingWith(const Eigen::Vector3d& position_m) const {
    std::vector<TargetSight> agreeing;
    std::ranges::copy_if(sights_, std::back_inserter(agreeing),
                         [&](const TargetSight& sight) { return Agrees(sight, position_m); });
    return agreeing;
  }

  // Least squares among `agreeing`, from a start; absent if these do not determine the position.
  std::optional<TargetPosition> Refined(const std::vector<TargetSight>& agreeing,
                                        const Eigen::Vector3d& start_m) const {
    const Locator among_them(agreeing, tolerance_);
    const Eigen::Vector3d position_m = among_them.Refine(start_m);
    if (!among_them.Determines(position_m)) return {};
    TargetPosition result{.position_m = position_m, .mirror_m = among_them.MirrorOf(position_m)};
    if (result.mirror_m && !among_them.HasElevationsOf(position_m, *result.mirror_m)) return {};
    double count = 0.0;
    for (const TargetSight& sight : sights_) {
      result.agrees.push_back(Agrees(sight, position_m));
      if (result.agrees.back()) {
        const Eigen::Vector2d error = ErrorOf(sight, position_m);
        result.range_error_m += error(0) * error(0);
        result.azimuth_error_rad += error(1) * error(1);
        count += 1.0;
      }
      result.elevation_rad.push_back(ElevationRad(sight, position_m));
    }
    result.range_error_m = tolerance_.range_m * std::sqrt(result.range_error_m / count);
    result.azimuth_error_rad = tolerance_.azimuth_rad * std::sqrt(result.azimuth_error_rad / count);
    return result;
  }

 private:
  struct Step {
    double cost = 0.0;
    double squares = 0.0;
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    Eigen::Vector3d slope = Eigen::Vector3d::Zero();
  };

  static Eigen::Vector3d At(const TargetSight& sight, double elevation_rad) {
    return sight.world_from_sonar *
           (sight.range_m * Eigen::Vector3d(std::cos(elevation_rad) * std::sin(sight.azimuth_rad),
                                            std::cos(elevation_rad) * std::cos(sight.azimuth_rad),
                                            std::sin(elevation_rad)));
  }

  // Errors of range and azimuth: predicted minus recorded.
  Eigen::Vector2d ErrorOf(const TargetSight& sight, const Eigen::Vector3d& position_m) const {
    const Eigen::Vector3d at = sight.world_from_sonar.Inverse() * position_m;
    return {(at.norm() - sight.range_m) / tolerance_.range_m,
            std::remainder(std::atan2(at.x(), at.y()) - sight.azimuth_rad, 2.0 * std::numbers::pi) /
                tolerance_.azimuth_rad};
  }

  bool Agrees(const TargetSight& sight, const Eigen::Vector3d& position_m) const {
    return ErrorOf(sight, position_m).squaredNorm() <= 1.0;
  }

  // Cauchy's loss: a sight that does not agree pulls little.
  Step StepAt(const Eigen::Vector3d& position_m) const {
    Step step;
    for (const TargetSight& sight : sights_) {
      const Eigen::Vector3d at = sight.world_from_sonar.Inverse() * position_m;
      const double across = std::max(at.head<2>().squaredNorm(), 1e-12);
      Eigen::Matrix<double, 2, 3> rows;
      rows.row(0) = at.transpose() / (std::max(at.norm(), 1e-6) * tolerance_.range_m);
      rows.row(1) = Eigen::RowVector3d(at.y(), -at.x(), 0.0) / (across * tolerance_.azimuth_rad);
      rows = rows * sight.world_from_sonar.rotation.conjugate().toRotationMatrix();
      const Eigen::Vector2d error = ErrorOf(sight, position_m);
      const double weight = 1.0 / (1.0 + error.squaredNorm());
      step.cost += std::log1p(error.squaredNorm());
      step.squares += error.squaredNorm();
      step.information += weight * rows.transpose() * rows;
      step.slope += weight * rows.transpose() * error;
    }
    return step;
  }

  // Damped Gauss-Newton steps from a start.
  Eigen::Vector3d Refine(Eigen::Vector3d position_m) const {
    double damping = 1e-3;
    Step at = StepAt(position_m);
    for (int i = 0; i < 50; ++i) {
      Eigen::Matrix3d damped = at.information;
      damped.diagonal() *= 1.0 + damping;
      const Eigen::Vector3d move = -damped.ldlt().solve(at.slope);
      const Step next = StepAt(position_m + move);
      if (next.cost <= at.cost) {
        position_m += move;
        at = next;
        damping *= 0.3;
        if (move.norm() < 1e-7) break;
      } else {
        damping *= 10.0;
        if (damping > 1e9) break;
      }
    }
    return position_m;
  }

  double VarianceAt(const Step& step) const {
    constexpr double kLeastError = 0.1;  // of the tolerance
    const double freedom = 2.0 * static_cast<double>(sights_.size()) - 3.0;
    return std::max(kLeastError * kLeastError, step.squares / freedom);
  }

  bool Determines(const Eigen::Vector3d& position_m) const {
    const Step at = StepAt(position_m);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(at.information);
    const double weakest_m = std::sqrt(VarianceAt(at) / axes.eigenvalues()(0));
    return weakest_m < kMaxElevationErrorRad * sights_.front().range_m;
  }

  // The mirror image of a position in the mean image plane, refined, if it is elsewhere and agrees as well.
  std::optional<Eigen::Vector3d> MirrorOf(const Eigen::Vector3d& position_m) const {
    Eigen::Vector3d sum_m = Eigen::Vector3d::Zero();
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    for (const TargetSight& sight : sights_) {
      sum_m += sight.world_from_sonar.position_m;
      normal += sight.world_from_sonar.rotation * Eigen::Vector3d::UnitZ();
    }
    normal.normalize();
    const Eigen::Vector3d away_m = position_m - sum_m / static_cast<double>(sights_.size());
    const Eigen::Vector3d mirror_m = Refine(position_m - 2.0 * away_m.dot(normal) * normal);
    if ((mirror_m - position_m).norm() < kMaxElevationErrorRad * sights_.front().range_m) return {};
    const Step at = StepAt(position_m);
    const double worse_nats = 0.5 * (StepAt(mirror_m).squares - at.squares) / VarianceAt(at);
    return worse_nats < kMaxWorseNats ? std::optional(mirror_m) : std::nullopt;
  }

  // True if the elevations of two positions have the same size in each sight.
  bool HasElevationsOf(const Eigen::Vector3d& position_m, const Eigen::Vector3d& other_m) const {
    return std::ranges::all_of(sights_, [&](const TargetSight& sight) {
      return std::abs(std::abs(ElevationRad(sight, position_m)) - std::abs(ElevationRad(sight, other_m))) <
             kMaxElevationErrorRad;
    });
  }

  const std::vector<TargetSight>& sights_;
  SightTolerance tolerance_;
};

}  // namespace

TargetLocation LocateTarget(const std::vector<TargetSight>& sights, const SightTolerance& tolerance) {
  if (sights.size() < 3)
    return {{}, fmt::format("{} frames with a pose show the sphere, expected 3", sights.size())};
  const Locator locator(sights, tolerance);
  const Eigen::Vector3d position_m = locator.Search();
  const std::vector<TargetSight> agreeing = locator.AgreeingWith(position_m);
  if (agreeing.size() < 3 || 2 * agreeing.size() < sights.size()) {
    return {{},
            fmt::format(
                "the poses of only {} of {} frames agree with a sphere that stands still, within {:.3f} m "
                "and {:.2f} degrees",
                agreeing.size(), sights.size(), tolerance.range_m, DegFromRad(tolerance.azimuth_rad))};
  }
  std::optional<TargetPosition> position = locator.Refined(agreeing, position_m);
  if (!position)
    return {
        {},
        "the poses do not tell the elevation of the sphere within a degree (raise, lower or roll the sonar)"};
  return {std::move(position), {}};
}

}  // namespace sonarcal::calib
