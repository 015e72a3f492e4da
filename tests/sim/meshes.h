// Plain meshes for the tests of sim/: written here, so that a scene under test owes nothing to the scene
// builders under test elsewhere.
#pragma once

#include <cmath>
#include <string>

#include "core/types/scene.h"
#include "core/types/units.h"

namespace sonarcal::testing {

inline void AddTriangle(Scene& scene, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                        const Eigen::Vector3d& c, const std::string& material) {
  const int first = static_cast<int>(scene.vertices_m.size());
  for (const Eigen::Vector3d& vertex : {a, b, c}) scene.vertices_m.emplace_back(vertex.cast<float>());
  scene.triangles.emplace_back(first, first + 1, first + 2);
  scene.triangle_material.push_back(scene.MaterialIndex(material));
}

// The parallelogram corner, corner + u, corner + u + v, corner + v; its normal is u x v.
inline void AddQuad(Scene& scene, const Eigen::Vector3d& corner, const Eigen::Vector3d& u,
                    const Eigen::Vector3d& v, const std::string& material) {
  AddTriangle(scene, corner, corner + u, corner + u + v, material);
  AddTriangle(scene, corner, corner + u + v, corner + v, material);
}

inline void AddBox(Scene& scene, const Eigen::Vector3d& low, const Eigen::Vector3d& high,
                   const std::string& material) {
  const Eigen::Vector3d size = high - low;
  const Eigen::Vector3d x(size.x(), 0, 0);
  const Eigen::Vector3d y(0, size.y(), 0);
  const Eigen::Vector3d z(0, 0, size.z());
  AddQuad(scene, low, y, x, material);
  AddQuad(scene, low, x, z, material);
  AddQuad(scene, low, z, y, material);
  AddQuad(scene, high, -x, -y, material);
  AddQuad(scene, high, -z, -x, material);
  AddQuad(scene, high, -y, -z, material);
}

// A sphere of `rings` bands of latitude and 2 rings of longitude, vertices on the sphere.
inline void AddSphere(Scene& scene, const Eigen::Vector3d& centre, double radius, int rings,
                      const std::string& material) {
  const auto at = [&](int ring, int sector) -> Eigen::Vector3d {
    const double polar = kPi * ring / rings;
    const double around = kPi * sector / rings;
    return centre + radius * Eigen::Vector3d(std::sin(polar) * std::cos(around),
                                             std::sin(polar) * std::sin(around), std::cos(polar));
  };
  for (int ring = 0; ring < rings; ++ring) {
    for (int sector = 0; sector < 2 * rings; ++sector) {
      if (ring + 1 < rings) {
        AddTriangle(scene, at(ring, sector), at(ring + 1, sector), at(ring + 1, sector + 1), material);
      }
      if (ring > 0) {
        AddTriangle(scene, at(ring, sector), at(ring + 1, sector + 1), at(ring, sector + 1), material);
      }
    }
  }
}

}  // namespace sonarcal::testing
