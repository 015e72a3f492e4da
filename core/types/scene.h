// Triangle mesh in world coordinates (metres, Z up). Each triangle has one named material. Parts of the mesh
// may have names too: the nodes of a scene file.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace sonarcal {

// A named part of a scene: consecutive vertices, which no triangle of another part uses.
struct SceneObject {
  std::string name;
  std::size_t first_vertex = 0;
  std::size_t vertex_count = 0;
};

struct Scene {
  std::vector<Eigen::Vector3f> vertices_m;
  std::vector<Eigen::Vector3i> triangles;        // vertex indices, counter-clockwise seen from outside
  std::vector<std::uint16_t> triangle_material;  // index into material_names, one per triangle
  std::vector<std::string> material_names;       // unique
  std::vector<SceneObject> objects = {};         // a part of another part has an entry of its own

  // Index of a material. Appends the material if it is new.
  std::uint16_t MaterialIndex(const std::string& name);

  // Adds the triangles of another mesh; materials with the same name are merged.
  void Append(const Scene& other);

  // Throws DataError, naming `what`, if an index is out of range or a vertex is not finite.
  void Validate(const std::string& what) const;
};

}  // namespace sonarcal
