// Predicts the smoothed grey image of a target at a pose, compares it with a recorded one and refines the
// pose. Part of the pose search (calib/poses/pose_search.h).
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "calib/poses/damped_steps.h"
#include "calib/poses/pose_search.h"
#include "sim/physics/speckle.h"

namespace sonarcal::calib {

// Part of an image: range bins and beams from the first up to, but not including, the last.
struct ImageBox {
  int first_bin = 0;
  int last_bin = 0;
  int first_beam = 0;
  int last_beam = 0;
};

// Limits of the place of the target's middle.
struct PlaceBounds {
  Interval range_m;
  Interval azimuth_rad;
  Interval elevation_rad;
};

// Position of the middle of the target in the coordinates of the image, its turn, and strengths.
struct MatchState {
  Eigen::Vector3d place = {1.0, 0.0, 0.0};                       // range (m), azimuth, elevation (rad)
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  // sonar_from_body
  double gain_db = 0.0;
  double floor_gain_db = 0.0;
  Grid<float> predicted = {};
  double cost = 0.0;

  TargetPose AsTargetPose() const;
  Pose SonarFromBody() const { return AsTargetPose().SonarFromTarget(); }
};

MatchState StateAt(const Pose& sonar_from_body);

// Echo power of the target and of the floor, without their gains. The floor is empty if there is none.
struct EchoPowers {
  Grid<double> target;
  Grid<double> floor;
};

class PoseMatcher {
 public:
  // `caster` and `options` must outlive the matcher. The range bins, and the rays both ways, are divided by
  // `max_factor`, or by the number of bins in the box if that is smaller.
  PoseMatcher(std::shared_ptr<const sim::RayCaster> caster, const SonarModel& sonar, const Water& water,
              const PolarImage& measured, const ParameterSet& parameters, const MeshSymmetry& symmetry,
              const PoseSearchOptions& options, const ImageBox& box, const PlaceBounds& bounds,
              int max_factor);

  const Grid<float>& measured() const { return measured_; }
  const PolarAxes& axes() const { return simulator_->sonar().axes; }

  EchoPowers Echoes(const Pose& sonar_from_body) const;
  // Expected display of echoes and noise floor, smoothed, full scale 1. A gain belongs to the target or to
  // the floor and does not change the noise.
  Grid<float> Displayed(const EchoPowers& echoes, double gain_db, double floor_gain_db) const;
  // Predicts the image and its cost.
  void Evaluate(MatchState& state) const;
  // Takes the best of gains every 5 dB within `reach_db` of those of the state.
  void TakeBestGain(MatchState& state, double reach_db) const;
  // Moves the state so that the middle of its echo lies on the middle of the recorded one.
  void TakeBestPlace(MatchState& state) const;

  // Refines an evaluated state with Levenberg-Marquardt. `hold_elevation` fixes that coordinate.
  void Refine(MatchState& state, int max_iterations, bool hold_elevation = false) const;

  // One sentence for each coordinate of the place at its bound.
  std::vector<std::string> AtBounds(const MatchState& state) const;

  // Difference of two predictions' log-likelihoods, and of its standard deviation (Vuong 1989): the sums of
  // squared differences over blocks of several speckle cells are taken as independent.
  struct Comparison {
    double nats = 0.0;
    double sigmas = 0.0;
  };
  Comparison Compare(const MatchState& best, const MatchState& other) const;

 private:
  static constexpr int kCoordinates = 8;
  using Step = Eigen::Matrix<double, kCoordinates, 1>;

  MatchState Moved(const MatchState& from, const Eigen::VectorXd& step) const;
  std::pair<Eigen::Vector3d, Eigen::Vector3d> PlaceLimits() const;
  QuadraticCost NormalAt(const MatchState& state) const;
  double Cost(const Grid<float>& predicted) const;
  // Middle of what exceeds the noise: range and azimuth. Absent: nothing does.
  std::optional<Eigen::Vector2d> MiddleOf(const Grid<float>& image, double threshold) const;
  sim::AcousticGeometry geometry() const { return {simulator_->sonar(), simulator_->absorption_db_per_m()}; }

  const PoseSearchOptions& options_;
  int factor_;
  Pose body_from_mesh_;
  ParameterSet parameters_;
  std::optional<ParameterSet> of_target_;  // with a floor: the floor is silent
  std::optional<ParameterSet> of_floor_;
  PlaceBounds bounds_;
  std::unique_ptr<sim::Simulator> simulator_;
  Grid<double> noise_;
  std::optional<sim::MeanDisplayTable> mean_display_;
  Grid<float> measured_;
  Grid<float> weight_;
  double weight_sum_ = 0.0;
  double noise_value_ = 0.0;  // mean of the smoothed display without an echo
  Step unit_;                 // steps over which the image changes by a comparable amount
  std::array<bool, kCoordinates> held_ = {};
};

}  // namespace sonarcal::calib
