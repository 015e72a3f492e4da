#include "calib/selection/frame_choice.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <limits>
#include <utility>

#include "core/types/error.h"

namespace sonarcal::calib {
namespace {

Eigen::MatrixXd WithPrior(const Eigen::MatrixXd& information) {
  return information + Eigen::MatrixXd::Identity(information.rows(), information.cols());
}

double HalfLogDet(const Eigen::LLT<Eigen::MatrixXd>& factor) {
  return factor.matrixLLT().diagonal().array().log().sum();
}

// Number of parameters that the information determines: each counts by the part of its variance that is gone.
double DeterminedCount(const Eigen::MatrixXd& information) {
  const Eigen::Index size = information.rows();
  const Eigen::MatrixXd variance = WithPrior(information).llt().solve(Eigen::MatrixXd::Identity(size, size));
  return static_cast<double>(size) - variance.trace();
}

}  // namespace

double InformationNats(const Eigen::MatrixXd& information) {
  return HalfLogDet(WithPrior(information).llt());
}

InformationChoice ChooseByInformation(const std::vector<int>& frames_of_pose,
                                      const InformationOfPose& information_of,
                                      const ChooseByInformationOptions& options) {
  constexpr double kEqual = 1e-9;  // nats; smaller differences are rounding
  const int poses = static_cast<int>(frames_of_pose.size());
  std::vector<Eigen::MatrixXd> information;
  information.reserve(frames_of_pose.size());
  for (int pose = 0; pose < poses; ++pose) information.push_back(information_of(pose, 0));
  std::vector<int> chosen_of_pose(frames_of_pose.size(), 0);
  InformationChoice choice;
  if (poses == 0) return choice;
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(information.front().rows(), information.front().cols());
  while (true) {
    const double before = InformationNats(sum);
    int best = -1;
    double best_gain = -1.0;
    for (int pose = 0; pose < poses; ++pose) {
      if (chosen_of_pose[pose] == frames_of_pose[pose]) continue;
      SONARCAL_CHECK(information[pose].rows() == sum.rows(), "information of pose {} has {} rows, not {}",
                     pose, information[pose].rows(), sum.rows());
      const double gain = InformationNats(sum + information[pose]) - before;
      if (gain > best_gain + kEqual) {
        best = pose;
        best_gain = gain;
      }
    }
    choice.next_gain = 0.0;
    if (best < 0) return choice;
    const double determined = std::max(1.0, DeterminedCount(sum + information[best]));
    choice.next_gain = best_gain / determined;
    if (static_cast<int>(choice.poses.size()) >= options.max_frames) return choice;
    if (!choice.poses.empty() && choice.next_gain < options.min_gain) {
      choice.ended_by_gain = true;
      return choice;
    }
    sum += information[best];
    choice.poses.push_back(best);
    choice.gains.push_back(best_gain);
    if (++chosen_of_pose[best] < frames_of_pose[best])
      information[best] = information_of(best, chosen_of_pose[best]);
  }
}

double PoseDistanceM(const Pose& a, const Pose& b, double reach_m) {
  return (a.position_m - b.position_m).norm() + reach_m * a.rotation.angularDistance(b.rotation);
}

std::vector<int> FramesAwayFrom(const std::vector<int>& fitted, const std::vector<Pose>& poses,
                                double reach_m) {
  std::vector<std::pair<double, int>> others;  // by distance
  std::vector<int> rest;
  std::vector<char> is_fitted(poses.size(), 0);
  for (const int frame : fitted) is_fitted[frame] = 1;
  for (int frame = 0; frame < static_cast<int>(poses.size()); ++frame) {
    if (is_fitted[frame] != 0) continue;
    rest.push_back(frame);
    double nearest_m = std::numeric_limits<double>::infinity();
    bool is_same = false;
    for (const int of : fitted) {
      nearest_m = std::min(nearest_m, PoseDistanceM(poses[of], poses[frame], reach_m));
      is_same = is_same || IsSamePose(poses[of], poses[frame]);
    }
    if (!is_same) others.emplace_back(nearest_m, frame);
  }
  if (others.empty()) return rest;
  std::ranges::stable_sort(others, [](const auto& a, const auto& b) { return a.first > b.first; });
  others.resize((others.size() + 1) / 2);
  std::vector<int> away;
  for (const auto& [distance_m, frame] : others) away.push_back(frame);
  std::ranges::sort(away);
  return away;
}

}  // namespace sonarcal::calib
