// What a mesh is, measured: for tests of the shapes that scenes are built from.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <map>
#include <numeric>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/types/scene.h"

namespace sonarcal::testing {

using DirectedEdge = std::pair<int, int>;

inline std::map<DirectedEdge, int> DirectedEdges(const Scene& mesh) {
  std::map<DirectedEdge, int> count;
  for (const Eigen::Vector3i& triangle : mesh.triangles) {
    for (int i = 0; i < 3; ++i) ++count[{triangle[i], triangle[(i + 1) % 3]}];
  }
  return count;
}

// Each edge belongs to two triangles that run along it in opposite directions.
inline bool IsClosed(const Scene& mesh) {
  const std::map<DirectedEdge, int> edges = DirectedEdges(mesh);
  for (const auto& [edge, count] : edges) {
    if (count != 1 || !edges.contains({edge.second, edge.first})) return false;
  }
  return !edges.empty();
}

// Vertices - edges + faces of a closed mesh: 2 for a ball, 0 for a ring.
inline int EulerCharacteristic(const Scene& mesh) {
  std::set<int> used;
  for (const Eigen::Vector3i& triangle : mesh.triangles) used.insert(triangle.begin(), triangle.end());
  return static_cast<int>(used.size()) - static_cast<int>(DirectedEdges(mesh).size() / 2) +
         static_cast<int>(mesh.triangles.size());
}

inline std::array<Eigen::Vector3d, 3> Corners(const Scene& mesh, const Eigen::Vector3i& triangle) {
  return {mesh.vertices_m[triangle[0]].cast<double>(), mesh.vertices_m[triangle[1]].cast<double>(),
          mesh.vertices_m[triangle[2]].cast<double>()};
}

// Positive where the triangles of a closed mesh face outwards.
inline double SignedVolumeM3(const Scene& mesh) {
  double volume_m3 = 0.0;
  for (const Eigen::Vector3i& triangle : mesh.triangles) {
    const auto [a, b, c] = Corners(mesh, triangle);
    volume_m3 += a.dot(b.cross(c)) / 6.0;
  }
  return volume_m3;
}

inline Eigen::AlignedBox3d Bounds(const Scene& mesh) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3f& vertex_m : mesh.vertices_m) box.extend(vertex_m.cast<double>());
  return box;
}

// The connected pieces of a mesh, each with all vertices of the whole.
inline std::vector<Scene> Pieces(const Scene& mesh) {
  std::vector<int> root(mesh.vertices_m.size());
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&](int vertex) {
    while (root[vertex] != vertex) vertex = root[vertex] = root[root[vertex]];
    return vertex;
  };
  for (const Eigen::Vector3i& triangle : mesh.triangles) {
    root[find(triangle[1])] = find(triangle[0]);
    root[find(triangle[2])] = find(triangle[0]);
  }
  std::map<int, Scene> pieces;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    Scene& piece = pieces[find(mesh.triangles[i][0])];
    piece.triangles.push_back(mesh.triangles[i]);
    piece.triangle_material.push_back(mesh.triangle_material[i]);
  }
  std::vector<Scene> result;
  for (auto& [vertex, piece] : pieces) {
    piece.vertices_m = mesh.vertices_m;
    piece.material_names = mesh.material_names;
    result.push_back(std::move(piece));
  }
  return result;
}

// The smallest positive distance at which a ray meets the mesh, whichever way the triangle faces; negative
// for none. Slow and plain, so that nothing of the ray caster under test is trusted here.
inline double FirstHitM(const Scene& mesh, const Eigen::Vector3d& origin_m,
                        const Eigen::Vector3d& direction) {
  double nearest_m = -1.0;
  for (const Eigen::Vector3i& triangle : mesh.triangles) {
    const auto [a, b, c] = Corners(mesh, triangle);
    Eigen::Matrix3d columns;
    columns << a - b, a - c, direction;
    if (columns.determinant() == 0.0) continue;
    const Eigen::Vector3d solution = columns.inverse() * (a - origin_m);
    const double t_m = solution[2];
    const bool inside = solution[0] >= 0.0 && solution[1] >= 0.0 && solution[0] + solution[1] <= 1.0;
    if (inside && t_m > 0.0 && (nearest_m < 0.0 || t_m < nearest_m)) nearest_m = t_m;
  }
  return nearest_m;
}

}  // namespace sonarcal::testing
