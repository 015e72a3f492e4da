#include "calib/parameters/object_placement.h"

#include <Eigen/Geometry>

#include "calib/shapes/object_vertices.h"

namespace sonarcal::calib {

PlaceableObject::PlaceableObject(Scene& scene, const std::string& name)
    : vertices_(VerticesOfObject(scene, name)) {
  Eigen::AlignedBox3d box;
  for (const std::size_t vertex : vertices_) box.extend(scene.vertices_m[vertex].cast<double>());
  centre_m_ = box.center();
}

void PlaceableObject::Place(const ObjectPlacement& placement, Scene& scene) const {
  const Pose move = PoseFromNamedValues(placement.step);
  for (const std::size_t vertex : vertices_) {
    const Eigen::Vector3d from_centre =
        placement.scale.cwiseProduct(scene.vertices_m[vertex].cast<double>() - centre_m_);
    scene.vertices_m[vertex] = (centre_m_ + move * from_centre).cast<float>();
  }
}

}  // namespace sonarcal::calib
