// A scene and the pose of its sonar, in the form of other simulators: one OBJ file per material, and angles
// about fixed axes.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "apps/export/export_account.h"
#include "apps/export/simulator_configs.h"

namespace sonarcal::exporting {

struct ScenePart {
  std::string material;  // as in the scene
  std::string name;      // letters, digits, '_' and '-' only; unique in the scene
  ExportedFile file;     // OBJ: metres, Z up, one normal per triangle
};

// Splits the scene of the source by material. Materials without triangles are left out. Empty without a
// scene.
std::vector<ScenePart> ScenePartsOf(const ExportSource& source);

// Pose of the sonar in the world, or the identity if the source has none.
Pose SonarPoseOf(const ExportSource& source);

// Angles of R = Rz(yaw) Ry(pitch) Rx(roll), as used by SDF and by Stonefish: (roll, pitch, yaw), rad.
Eigen::Vector3d RollPitchYaw(const Eigen::Matrix3d& rotation);

// Three numbers with spaces between them.
std::string VectorText(const Eigen::Vector3d& vector);

}  // namespace sonarcal::exporting
