// Triangle mesh in world coordinates (metres, Z up). Each triangle has one named material.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

namespace sonarcal {

struct Scene {
  std::vector<Eigen::Vector3f> vertices_m;
  std::vector<Eigen::Vector3i> triangles;        // vertex indices, counter-clockwise seen from outside
  std::vector<std::uint16_t> triangle_material;  // index into material_names, one per triangle
  std::vector<std::string> material_names;       // unique

  // Index of a material. Appends the material if it is new.
  std::uint16_t MaterialIndex(const std::string& name);

  // Adds the triangles of another mesh; materials with the same name are merged.
  void Append(const Scene& other);

  // Throws DataError, naming `what`, if an index is out of range or a vertex is not finite.
  void Validate(const std::string& what) const;
};

}  // namespace sonarcal
