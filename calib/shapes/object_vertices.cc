#include "calib/shapes/object_vertices.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

#include "core/text/nearest_word.h"
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

// Divides each triangle of `inside` vertices that has a long edge once. New vertices are appended, and belong
// to the inside. Returns false if no edge was long.
bool DivideOnce(Scene& scene, std::vector<char>& inside, float max_edge_m) {
  std::map<std::pair<int, int>, int> middles;  // by edge
  const auto middle_of = [&](int a, int b) {
    const Eigen::Vector3f from = scene.vertices_m[a];
    const Eigen::Vector3f to = scene.vertices_m[b];
    if ((from - to).norm() <= max_edge_m) return -1;
    const Eigen::Vector3f middle = 0.5F * (from + to);
    // Far from the origin floats are so far apart that a half may be about as long as the whole.
    constexpr float kMaxOfWhole = 0.75F;
    if (std::max((middle - from).norm(), (to - middle).norm()) > kMaxOfWhole * (to - from).norm()) return -1;
    const auto [found, added] = middles.try_emplace(std::minmax(a, b), 0);
    if (added) {
      found->second = static_cast<int>(scene.vertices_m.size());
      scene.vertices_m.push_back(middle);
      inside.push_back(1);
    }
    return found->second;
  };
  const std::size_t count = scene.triangles.size();
  for (std::size_t i = 0; i < count; ++i) {
    Eigen::Vector3i t = scene.triangles[i];
    if (inside[t(0)] == 0 || inside[t(1)] == 0 || inside[t(2)] == 0) continue;
    Eigen::Vector3i m(middle_of(t(0), t(1)), middle_of(t(1), t(2)), middle_of(t(2), t(0)));
    const auto divided = (m.array() >= 0).count();
    if (divided == 0) continue;
    // Turns the triangle so that its first edge is divided and, of two, the last is not; of one, only the
    // first.
    while (m(0) < 0 || (divided == 2 && m(2) >= 0)) {
      t = Eigen::Vector3i(t(1), t(2), t(0));
      m = Eigen::Vector3i(m(1), m(2), m(0));
    }
    std::vector<Eigen::Vector3i> parts;
    if (divided == 1) parts = {{t(0), m(0), t(2)}, {m(0), t(1), t(2)}};
    if (divided == 2) parts = {{t(0), m(0), t(2)}, {m(0), m(1), t(2)}, {m(0), t(1), m(1)}};
    if (divided == 3)
      parts = {{t(0), m(0), m(2)}, {m(0), t(1), m(1)}, {m(2), m(1), t(2)}, {m(0), m(1), m(2)}};
    scene.triangles[i] = parts.front();
    for (std::size_t k = 1; k < parts.size(); ++k) {
      scene.triangles.push_back(parts[k]);
      const std::uint16_t material = scene.triangle_material[i];
      scene.triangle_material.push_back(material);
    }
  }
  return !middles.empty();
}

// Moves the vertices from `first_added` on behind those of the object, so that its vertices stay consecutive.
void MoveBehind(Scene& scene, std::size_t object, std::size_t first_added) {
  const std::size_t added = scene.vertices_m.size() - first_added;
  const SceneObject of = scene.objects[object];
  const std::size_t end = of.first_vertex + of.vertex_count;
  const auto at = [&](std::size_t index) {
    return scene.vertices_m.begin() + static_cast<std::ptrdiff_t>(index);
  };
  std::rotate(at(end), at(first_added), scene.vertices_m.end());
  for (Eigen::Vector3i& triangle : scene.triangles) {
    for (int& vertex : triangle) {
      const auto index = static_cast<std::size_t>(vertex);
      if (index >= first_added) {
        vertex = static_cast<int>(end + index - first_added);
      } else if (index >= end) {
        vertex = static_cast<int>(index + added);
      }
    }
  }
  std::vector<SceneObject> kept;
  for (SceneObject other : scene.objects) {
    const std::size_t end_of_other = other.first_vertex + other.vertex_count;
    if (other.first_vertex >= end) {
      other.first_vertex += added;
    } else if (other.first_vertex <= of.first_vertex && end_of_other >= end) {
      other.vertex_count += added;
    } else if (other.first_vertex >= of.first_vertex) {
      continue;  // a part of the object, whose new vertices are not consecutive
    }
    kept.push_back(other);
  }
  scene.objects = std::move(kept);
}

}  // namespace

std::vector<std::size_t> VerticesOfObject(Scene& scene, const std::string& name) {
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
    throw DataError("no object '{}' in the scene{}", name, ExpectedWord(name, names));
  }
  return VerticesOfMaterial(scene, static_cast<std::size_t>(material - scene.material_names.begin()));
}

Scene MeshOfVertices(const Scene& scene, const std::vector<std::size_t>& vertices) {
  Scene mesh;
  mesh.material_names = scene.material_names;
  std::vector<int> index(scene.vertices_m.size(), -1);
  for (const std::size_t vertex : vertices) {
    index[vertex] = static_cast<int>(mesh.vertices_m.size());
    mesh.vertices_m.push_back(scene.vertices_m[vertex]);
  }
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    const Eigen::Vector3i& t = scene.triangles[i];
    const Eigen::Vector3i of(index[t(0)], index[t(1)], index[t(2)]);
    if (of.minCoeff() < 0) continue;
    mesh.triangles.push_back(of);
    mesh.triangle_material.push_back(scene.triangle_material[i]);
  }
  return mesh;
}

double SurfaceAreaM2(const Scene& mesh) {
  double area_m2 = 0.0;
  for (const Eigen::Vector3i& t : mesh.triangles) {
    const Eigen::Vector3f a = mesh.vertices_m[t(0)];
    area_m2 += 0.5 * double{(mesh.vertices_m[t(1)] - a).cross(mesh.vertices_m[t(2)] - a).norm()};
  }
  return area_m2;
}

void DivideObject(Scene& scene, const std::string& name, double max_edge_m) {
  const std::vector<std::size_t> vertices = VerticesOfObject(scene, name);
  const std::size_t first_added = scene.vertices_m.size();
  std::vector<char> inside(first_added, 0);
  for (const std::size_t vertex : vertices) inside[vertex] = 1;
  while (DivideOnce(scene, inside, static_cast<float>(max_edge_m))) {
  }
  if (scene.vertices_m.size() == first_added) return;
  const auto object = std::ranges::find(scene.objects, name, &SceneObject::name);
  if (object != scene.objects.end())
    MoveBehind(scene, static_cast<std::size_t>(object - scene.objects.begin()), first_added);
}

}  // namespace sonarcal::calib
