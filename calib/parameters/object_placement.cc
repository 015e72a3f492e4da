#include "calib/parameters/object_placement.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <numeric>

#include "core/types/error.h"

namespace sonarcal::calib {
namespace {

// Vertices of the triangles of a material. Vertices that other materials use too are copied first.
std::vector<std::size_t> VerticesOfMaterial(Scene& scene, std::size_t material) {
  std::vector<char> of_others(scene.vertices_m.size(), 0);
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    if (scene.triangle_material[i] == material) continue;
    for (const int vertex : scene.triangles[i]) of_others[vertex] = 1;
  }
  std::map<int, int> own;  // by vertex in the scene
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    if (scene.triangle_material[i] != material) continue;
    for (int& vertex : scene.triangles[i]) {
      const auto [found, added] = own.try_emplace(vertex, vertex);
      if (added && of_others[vertex] != 0) {
        found->second = static_cast<int>(scene.vertices_m.size());
        const Eigen::Vector3f copy = scene.vertices_m[vertex];
        scene.vertices_m.push_back(copy);
      }
      vertex = found->second;
    }
  }
  std::vector<std::size_t> vertices;
  for (const auto& [shared, vertex] : own) vertices.push_back(static_cast<std::size_t>(vertex));
  return vertices;
}

std::vector<std::size_t> VerticesOf(Scene& scene, const std::string& name) {
  const auto object = std::ranges::find(scene.objects, name, &SceneObject::name);
  if (object != scene.objects.end()) {
    std::vector<std::size_t> vertices(object->vertex_count);
    std::iota(vertices.begin(), vertices.end(), object->first_vertex);
    return vertices;
  }
  const auto material = std::ranges::find(scene.material_names, name);
  if (material == scene.material_names.end()) {
    std::vector<std::string> names = scene.material_names;
    for (const SceneObject& of : scene.objects) {
      if (std::ranges::find(names, of.name) == names.end()) names.push_back(of.name);
    }
    throw DataError("no object '{}' in the scene, expected one of {}", name, fmt::join(names, ", "));
  }
  return VerticesOfMaterial(scene, static_cast<std::size_t>(material - scene.material_names.begin()));
}

}  // namespace

PlaceableObject::PlaceableObject(Scene& scene, const std::string& name)
    : name_(name), vertices_(VerticesOf(scene, name)) {
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
