// A part of a scene that stands elsewhere than the scene file says, such as a mock-up that was lowered by
// hand.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calib/parameters/pose_step.h"
#include "core/types/scene.h"

namespace sonarcal::calib {

// Change of the placement, in world coordinates: m, then degrees of roll about Y, pitch about X and yaw about
// Z, as for a pose. Rotation and scale are about the centre of the object's bounding box.
struct ObjectPlacement {
  PoseStep step = PoseStep::Zero();
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();
};

class PlaceableObject {
 public:
  // `name`: a named part of the scene, otherwise a material. Gives a material vertices of its own where
  // it shares them with another. Throws DataError if there is neither.
  PlaceableObject(Scene& scene, const std::string& name);

  // Moves the vertices of `scene`, which holds the object where the scene file says.
  void Place(const ObjectPlacement& placement, Scene& scene) const;

  const Eigen::Vector3d& centre_m() const { return centre_m_; }  // as the scene file says

 private:
  std::vector<std::size_t> vertices_;
  Eigen::Vector3d centre_m_;
};

}  // namespace sonarcal::calib
