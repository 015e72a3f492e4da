#include "core/types/scene.h"

#include <algorithm>
#include <limits>

#include "core/types/error.h"

namespace sonarcal {

std::uint16_t Scene::MaterialIndex(const std::string& name) {
  const auto found = std::find(material_names.begin(), material_names.end(), name);
  if (found != material_names.end()) return static_cast<std::uint16_t>(found - material_names.begin());
  if (material_names.size() >= std::numeric_limits<std::uint16_t>::max()) {
    throw DataError("a scene with more than {} materials", std::numeric_limits<std::uint16_t>::max());
  }
  material_names.push_back(name);
  return static_cast<std::uint16_t>(material_names.size() - 1);
}

void Scene::Append(const Scene& other) {
  const int first_vertex = static_cast<int>(vertices_m.size());
  std::vector<std::uint16_t> material_map;
  for (const std::string& name : other.material_names) material_map.push_back(MaterialIndex(name));
  vertices_m.insert(vertices_m.end(), other.vertices_m.begin(), other.vertices_m.end());
  for (const SceneObject& object : other.objects)
    objects.push_back({object.name, object.first_vertex + first_vertex, object.vertex_count});
  for (const Eigen::Vector3i& triangle : other.triangles) {
    triangles.emplace_back(triangle.array() + first_vertex);
  }
  for (const std::uint16_t material : other.triangle_material)
    triangle_material.push_back(material_map[material]);
}

void Scene::Validate(const std::string& what) const {
  if (triangles.empty()) throw DataError("{}: no triangles, expected a mesh", what);
  SONARCAL_CHECK(triangles.size() == triangle_material.size(), "{} triangles, {} materials", triangles.size(),
                 triangle_material.size());
  for (std::size_t i = 0; i < vertices_m.size(); ++i) {
    if (!vertices_m[i].allFinite()) throw DataError("{}: vertex {} is not finite", what, i);
  }
  const int vertex_count = static_cast<int>(vertices_m.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (triangles[i].minCoeff() < 0 || triangles[i].maxCoeff() >= vertex_count) {
      throw DataError("{}: triangle {} names a vertex beyond the {} present", what, i, vertex_count);
    }
    if (triangle_material[i] >= material_names.size()) {
      throw DataError("{}: triangle {} names a material that does not exist", what, i);
    }
  }
}

}  // namespace sonarcal
