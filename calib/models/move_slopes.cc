#include "calib/models/move_slopes.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/types/units.h"
#include "sim/ghosts/ghost_power.h"
#include "sim/physics/receiver.h"

namespace sonarcal::calib {
namespace {

constexpr int kDecimationOfSlopes = 2;
constexpr int kMinRowsOfSlopes = 400;
constexpr int kMinRows = 400;

// Fewer columns of rays would make steps of a beam's response.
constexpr double kColumnsPerBeamWidth = 4.0;

int DecimationOfRows(const sim::RayFanOptions& fan, int decimation, int min_rows) {
  return std::clamp(fan.rows / min_rows, 1, decimation);
}

sim::RayFanOptions Divided(const SonarModel& sonar, sim::RayFanOptions fan, double rows_by, double cols_by) {
  const double width_deg = sonar.azimuth_beam_width_deg;
  const double field_deg = DegFromRad(sonar.axes.field_of_view_rad());
  const int least =
      width_deg > 0.0 ? static_cast<int>(std::ceil(kColumnsPerBeamWidth * field_deg / width_deg)) : fan.cols;
  fan.cols = std::max(std::min(fan.cols, least), static_cast<int>(fan.cols / cols_by));
  fan.rows = std::max(1, static_cast<int>(fan.rows / rows_by));
  return fan;
}

int DecimationOfSlopes(const sim::RayFanOptions& fan) {
  return DecimationOfRows(fan, kDecimationOfSlopes, kMinRowsOfSlopes);
}

// Moves and turns of sim::EchoSlopes by component of a PoseStep: right, ahead, up; roll, pitch, yaw.
constexpr std::array<int, kPoseSteps> kMoveOfStep = {0, 1, 2, 4, 3, 5};

void Add(const Grid<double>& from, double factor, Grid<float>& to) {
  for (std::size_t i = 0; i < to.size(); ++i) to.values()[i] += static_cast<float>(factor * from.values()[i]);
}

// The two fans differ in their grids.
constexpr double kOtherGrid = 1.15;

// `coarser`: divides rows and columns once more.
sim::RayFan FanOfSlopes(const sim::Simulator& simulator, double coarser) {
  const sim::RayFanOptions& all = simulator.options().fan;
  const double by = coarser * DecimationOfSlopes(all);
  sim::RayFanOptions fan = Divided(simulator.sonar(), all, by, by);
  fan.sampling = sim::Sampling::kBeams;
  return {simulator.sonar(), fan};
}

// Replaces slopes by their mean with those by other rays, without directions that both do not share: whose
// mean square, as a share of the power with its noise, is less than kMinRatio times the square of half the
// difference.
void MeanWhereAlike(const sim::AlongMoves& others, const Grid<double>& power, const Grid<double>& noise,
                    sim::AlongMoves& slopes) {
  constexpr double kMinRatio = 3.5;
  constexpr int kMoves = sim::kSonarMoves;
  using Matrix = Eigen::Matrix<double, kMoves, kMoves>;
  using Vector = Eigen::Matrix<double, kMoves, 1>;
  Matrix means = Matrix::Zero();
  Matrix differences = Matrix::Zero();
  for (std::size_t i = 0; i < power.size(); ++i) {
    const double level = power.values()[i] + noise.values()[i];
    Vector mean;
    Vector difference;
    for (int k = 0; k < kMoves; ++k) {
      const double one = slopes[k].values()[i] / level;
      const double other = others[k].values()[i] / level;
      mean(k) = 0.5 * (one + other);
      difference(k) = 0.5 * (one - other);
    }
    means += mean * mean.transpose();
    differences += difference * difference.transpose();
  }
  // Directions v with means v = ratio differences v, in units in which the differences are alike.
  const Vector scale = means.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  constexpr double kLeast = 1e-9;
  const Matrix scaled = scale.asDiagonal() * differences * scale.asDiagonal() + kLeast * Matrix::Identity();
  const Matrix scaled_means = scale.asDiagonal() * means * scale.asDiagonal();
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix> solver(scaled_means, scaled);
  // Projection of the slopes: v is orthonormal in `scaled`, so that the coordinates of a slope s are v^T s.
  const Vector keep = (solver.eigenvalues().array() >= kMinRatio).cast<double>();
  const Matrix& v = solver.eigenvectors();
  const Matrix projection =
      scale.cwiseInverse().asDiagonal() * scaled * v * keep.asDiagonal() * v.transpose() * scale.asDiagonal();
  for (std::size_t i = 0; i < power.size(); ++i) {
    Vector mean;
    for (int k = 0; k < kMoves; ++k) mean(k) = 0.5 * (slopes[k].values()[i] + others[k].values()[i]);
    const Vector kept = projection * mean;
    for (int k = 0; k < kMoves; ++k) slopes[k].values()[i] = static_cast<float>(kept(k));
  }
}

// Adds the slopes of ghosts, from differences: their paths turn at mirrors.
void AddGhosts(const sim::Simulator& simulator, const sim::RayFan& fan, const Pose& pose,
               const ParameterSet& parameters, MoveSlopes& slopes) {
  const int decimation = DecimationOfSlopes(simulator.options().fan);
  const sim::GhostList at_pose = simulator.TraceGhosts(pose, parameters, decimation);
  if (at_pose.echoes.empty()) return;
  const auto power_of = [&](const sim::GhostList& ghosts, double range_offset_m) {
    SonarModel sonar = simulator.sonar();
    sonar.axes.range_min_m += range_offset_m;
    sonar.axes.range_max_m += range_offset_m;
    const sim::AcousticGeometry geometry{sonar, simulator.absorption_db_per_m()};
    sim::ScatterMap scatter = sim::EmptyScatterMap(fan, geometry, parameters);
    sim::AddGhosts(ghosts, geometry, parameters, scatter);
    return sim::EchoPowerImage(scatter, geometry, parameters);
  };
  const Grid<double> power = power_of(at_pose, 0.0);
  for (std::size_t i = 0; i < power.size(); ++i) slopes.power.values()[i] += power.values()[i];
  const PolarAxes& axes = simulator.sonar().axes;
  for (int k = 0; k < kPoseSteps; ++k) {
    const double step = PoseDifference(axes, k);
    for (const double by : {step, -step}) {
      PoseStep move = PoseStep::Zero();
      move(k) = by;
      const sim::GhostList moved = simulator.TraceGhosts(MovePose(pose, move), parameters, decimation);
      Add(power_of(moved, 0.0), 0.5 / by, slopes.along[k]);
    }
  }
  const double step_m = PoseDifference(axes, 0);
  for (const double by_m : {step_m, -step_m}) Add(power_of(at_pose, by_m), 0.5 / by_m, slopes.range_offset);
}

// An offset makes the range of a pixel larger, which makes its echoes nearer and changes its gain.
Grid<float> AlongRangeOffset(const sim::EchoSlopes& echoes, const sim::AcousticGeometry& geometry,
                             const ParameterSet& parameters) {
  constexpr double kStepM = 1e-3;
  Grid<float> slopes(echoes.power.rows(), echoes.power.cols());
  for (int bin = 0; bin < slopes.rows(); ++bin) {
    const auto gain_db = [&](double by_m) {
      return sim::TimeVariedGainDb(parameters.receiver.time_varied_gain,
                                   geometry.sonar.axes.range_centre_m(bin) + by_m,
                                   geometry.absorption_db_per_m);
    };
    const double nepers_per_m = kNeperPerDb * (gain_db(kStepM) - gain_db(-kStepM)) / (2.0 * kStepM);
    for (int beam = 0; beam < slopes.cols(); ++beam) {
      slopes(bin, beam) =
          static_cast<float>(nepers_per_m * echoes.power(bin, beam)) - echoes.farther(bin, beam);
    }
  }
  return slopes;
}

}  // namespace

sim::RayFanOptions Decimated(const SonarModel& sonar, const sim::RayFanOptions& fan, int decimation) {
  const int by = DecimationOfRows(fan, decimation, kMinRows);
  return Divided(sonar, fan, by, by);
}

Grid<float> MoveSlopes::AlongPlacement(int part, const PlaceableObject& object,
                                       const ObjectPlacement& placement, int component,
                                       const Pose& world_from_sonar) const {
  constexpr double kDifference = 1e-5;
  ObjectPlacement further = placement;
  further.step(component) += kDifference;
  const Pose from = PoseFromNamedValues(placement.step);
  const Pose to = PoseFromNamedValues(further.step);
  // Rigid motion of the object in the world, per unit of the component: a turn, and the velocity of the point
  // of the object that is at the sonar.
  const Eigen::AngleAxisd turn(to.rotation * from.rotation.conjugate());
  const Eigen::Vector3d turn_rad = turn.angle() / kDifference * turn.axis();
  const Eigen::Vector3d centre_m = object.centre_m() + from.position_m;
  const Eigen::Vector3d shift_m = (to.position_m - from.position_m) / kDifference +
                                  turn_rad.cross(world_from_sonar.position_m - centre_m);
  const Eigen::Vector3d shift = world_from_sonar.rotation.conjugate() * shift_m;
  const Eigen::Vector3d rotation = world_from_sonar.rotation.conjugate() * turn_rad;
  Grid<float> slope(power.rows(), power.cols());
  for (int move = 0; move < sim::kSonarMoves; ++move) {
    const auto factor = static_cast<float>(move < 3 ? shift(move) : rotation(move - 3));
    for (std::size_t i = 0; i < slope.size(); ++i)
      slope.values()[i] += factor * of_part[part][move].values()[i];
  }
  return slope;
}

MoveSlopes SlopesOfMoves(const sim::Simulator& simulator, const Pose& world_from_sonar,
                         const ParameterSet& parameters, const sim::SceneParts& parts) {
  const sim::AcousticGeometry geometry{simulator.sonar(), simulator.absorption_db_per_m()};
  const auto by_fan = [&](double coarser) {
    return sim::SlopesAlongMoves(simulator.caster(), FanOfSlopes(simulator, coarser), world_from_sonar,
                                 geometry, parameters, parts);
  };
  sim::EchoSlopes echoes = by_fan(1.0);
  const sim::EchoSlopes others = by_fan(kOtherGrid);
  const Grid<double> noise = sim::NoiseFloorPower(geometry, parameters);
  MeanWhereAlike(others.along, echoes.power, noise, echoes.along);
  for (int part = 0; part < parts.count; ++part)
    MeanWhereAlike(others.of_part[part], echoes.power, noise, echoes.of_part[part]);
  MoveSlopes slopes;
  slopes.range_offset = AlongRangeOffset(echoes, geometry, parameters);
  slopes.power = std::move(echoes.power);
  slopes.of_part = std::move(echoes.of_part);
  for (int k = 0; k < kPoseSteps; ++k) {
    slopes.along[k] = std::move(echoes.along[kMoveOfStep[k]]);
    if (k < 3) continue;
    for (float& value : slopes.along[k].values()) value *= static_cast<float>(RadFromDeg(1.0));
  }
  AddGhosts(simulator, FanOfSlopes(simulator, 1.0), world_from_sonar, parameters, slopes);
  return slopes;
}

}  // namespace sonarcal::calib
