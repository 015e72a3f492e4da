// Chooses the frames of a long recording that a fit needs. No image is read: the expected information of
// each frame decides (calib/selection/frame_information.h).
//
// Frames are added one by one. Each is the one that raises log det(1 + sum of information) most
// (D-optimality, Fedorov 1972). The greedy choice reaches at least 1 - 1/e of the best increase (Nemhauser et
// al. 1978). Information is in units of the priors' standard deviations, so that the prior is the unit
// matrix. Half the increase is the gain in nats: the sum of the logarithms by which the standard errors fall.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "core/types/pose.h"

namespace sonarcal::calib {

// Returns the expected information of a frame at a pose from which `frames_before` frames are chosen already:
// symmetric, positive semidefinite, of the same size for all poses.
using InformationOfPose = std::function<Eigen::MatrixXd(int pose, int frames_before)>;

struct ChooseByInformationOptions {
  int max_frames = 24;
  // The choice ends if another frame lowers the standard errors of the determined parameters by a smaller
  // part than this, on average.
  double min_gain = 0.02;
};

struct InformationChoice {
  std::vector<int> poses;     // one for each frame, in the order of choice
  std::vector<double> gains;  // nats, one for each frame
  // Part by which the best frame left out would lower the standard errors; 0 if no frame is left.
  double next_gain = 0.0;
  bool ended_by_gain = false;  // false: by the max number of frames, or because none is left
};

// `frames_of_pose`: number of frames per pose. Evaluates each pose once, and once more for each frame chosen.
// The same input gives the same choice; of equal frames the first is taken.
InformationChoice ChooseByInformation(const std::vector<int>& frames_of_pose,
                                      const InformationOfPose& information_of,
                                      const ChooseByInformationOptions& options = {});

// Half of log det(1 + information), nats.
double InformationNats(const Eigen::MatrixXd& information);

// Distance between poses, m: the way of the sonar, plus that of a point at `reach_m` as the sonar turns.
double PoseDistanceM(const Pose& a, const Pose& b, double reach_m);

// Returns the frames that lie away from the fitted ones: those that are not fitted, without poses of fitted
// frames, and of these the half with the largest distance from the nearest fitted pose, in their order.
// Without other poses it returns all frames that are not fitted.
std::vector<int> FramesAwayFrom(const std::vector<int>& fitted, const std::vector<Pose>& poses,
                                double reach_m);

}  // namespace sonarcal::calib
