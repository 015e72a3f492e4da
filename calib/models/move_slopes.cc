#include "calib/models/move_slopes.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/types/units.h"
#include "sim/ghosts/ghost_power.h"
#include "sim/physics/receiver.h"

namespace sonarcal::calib {
namespace {

constexpr int kDecimationOfSlopes = 2;
constexpr int kMinRows = 400;

// Fewer columns of rays would make steps of a beam's response.
constexpr double kColumnsPerBeamWidth = 4.0;

int DecimationOfRows(const sim::RayFanOptions& fan, int decimation) {
  return std::clamp(fan.rows / kMinRows, 1, decimation);
}

// Moves and turns of sim::EchoSlopes by component of a PoseStep: right, ahead, up; roll, pitch, yaw.
constexpr std::array<int, kPoseSteps> kMoveOfStep = {0, 1, 2, 4, 3, 5};

void Add(const Grid<double>& from, double factor, Grid<float>& to) {
  for (std::size_t i = 0; i < to.size(); ++i) to.values()[i] += static_cast<float>(factor * from.values()[i]);
}

sim::RayFan FanOfSlopes(const sim::Simulator& simulator) {
  sim::RayFanOptions fan = Decimated(simulator.sonar(), simulator.options().fan, kDecimationOfSlopes);
  fan.sampling = sim::Sampling::kBeams;
  return {simulator.sonar(), fan};
}

// Adds the slopes of ghosts, from differences: their paths turn at mirrors.
void AddGhosts(const sim::Simulator& simulator, const sim::RayFan& fan, const Pose& pose,
               const ParameterSet& parameters, MoveSlopes& slopes) {
  const int decimation = DecimationOfRows(simulator.options().fan, kDecimationOfSlopes);
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
  const int by = DecimationOfRows(fan, decimation);
  const double width_deg = sonar.azimuth_beam_width_deg;
  const double field_deg = DegFromRad(sonar.axes.field_of_view_rad());
  const int least =
      width_deg > 0.0 ? static_cast<int>(std::ceil(kColumnsPerBeamWidth * field_deg / width_deg)) : fan.cols;
  sim::RayFanOptions divided = fan;
  divided.cols = std::max(std::min(fan.cols, least), fan.cols / by);
  divided.rows = std::max(1, fan.rows / by);
  return divided;
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
  const sim::RayFan fan = FanOfSlopes(simulator);
  sim::EchoSlopes echoes =
      sim::SlopesAlongMoves(simulator.caster(), fan, world_from_sonar, geometry, parameters, parts);
  MoveSlopes slopes;
  slopes.range_offset = AlongRangeOffset(echoes, geometry, parameters);
  slopes.power = std::move(echoes.power);
  slopes.of_part = std::move(echoes.of_part);
  for (int k = 0; k < kPoseSteps; ++k) {
    slopes.along[k] = std::move(echoes.along[kMoveOfStep[k]]);
    if (k < 3) continue;
    for (float& value : slopes.along[k].values()) value *= static_cast<float>(RadFromDeg(1.0));
  }
  AddGhosts(simulator, fan, world_from_sonar, parameters, slopes);
  return slopes;
}

}  // namespace sonarcal::calib
