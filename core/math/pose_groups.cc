#include "core/math/pose_groups.h"

#include <array>
#include <cmath>
#include <limits>
#include <map>

namespace sonarcal {
namespace {

// Cell of a pose in a grid of the tolerances of IsSamePose: position, and one component of the direction.
using PoseCell = std::array<long, 4>;

PoseCell CellOf(const Pose& pose) {
  constexpr double kCell = 1e-3;  // m, and radians at most
  const Eigen::Vector3d ahead = pose.rotation * Eigen::Vector3d::UnitY();
  const double turned = ahead.dot(Eigen::Vector3d(0.6, 0.64, 0.48));
  const auto cell = [](double value) { return std::lround(std::floor(value / kCell)); };
  return {cell(pose.position_m.x()), cell(pose.position_m.y()), cell(pose.position_m.z()), cell(turned)};
}

// Calls `visit` with the cells at most one away from `cell`.
template <typename Visit>
void ForNeighbours(const PoseCell& cell, const Visit& visit) {
  constexpr int kNeighbours = 81;
  for (int i = 0; i < kNeighbours; ++i) {
    visit(PoseCell{cell[0] + i % 3 - 1, cell[1] + i / 3 % 3 - 1, cell[2] + i / 9 % 3 - 1,
                   cell[3] + i / 27 - 1});
  }
}

}  // namespace

std::vector<std::vector<int>> GroupByPose(const std::vector<Pose>& poses) {
  std::vector<std::vector<int>> groups;
  std::map<PoseCell, std::vector<int>> groups_of_cell;  // by the cell of their first pose
  for (int frame = 0; frame < static_cast<int>(poses.size()); ++frame) {
    const PoseCell cell = CellOf(poses[frame]);
    int same = std::numeric_limits<int>::max();
    ForNeighbours(cell, [&](const PoseCell& near) {
      const auto found = groups_of_cell.find(near);
      if (found == groups_of_cell.end()) return;
      for (const int group : found->second) {
        if (group < same && IsSamePose(poses[groups[group].front()], poses[frame])) same = group;
      }
    });
    if (same == std::numeric_limits<int>::max()) {
      groups_of_cell[cell].push_back(static_cast<int>(groups.size()));
      groups.push_back({frame});
    } else {
      groups[same].push_back(frame);
    }
  }
  return groups;
}

std::vector<int> FirstOfPose(const std::vector<Pose>& poses) {
  std::vector<int> first(poses.size());
  for (const std::vector<int>& group : GroupByPose(poses)) {
    for (const int pose : group) first[pose] = group.front();
  }
  return first;
}

}  // namespace sonarcal
