#include "data_io/scenes/scene_assembler.h"

#include <algorithm>
#include <array>
#include <utility>

#include "core/types/error.h"

namespace sonarcal::data_io {
namespace {

// Corners of triangle i of a sequence.
std::array<std::size_t, 3> CornersOf(TriangleMode mode, std::size_t i) {
  switch (mode) {
    case TriangleMode::kStrip:
      return {i, i + 1 + i % 2, i + 2 - i % 2};
    case TriangleMode::kFan:
      return {i + 1, i + 2, 0};
    case TriangleMode::kSeparate:
      break;
  }
  return {3 * i, 3 * i + 1, 3 * i + 2};
}

}  // namespace

void SceneAssembler::AddVertex(const Eigen::Vector3d& world_m) {
  if (scene_.vertices_m.size() >= kMaxSceneVertices) {
    throw DataError("{}: more than {} vertices", file_, kMaxSceneVertices);
  }
  const Eigen::Vector3f vertex_m = world_m.cast<float>();
  if (!vertex_m.allFinite()) {
    throw DataError("{}: a vertex at ({}, {}, {}) m in the world, expected finite coordinates", file_,
                    world_m.x(), world_m.y(), world_m.z());
  }
  scene_.vertices_m.push_back(vertex_m);
}

void SceneAssembler::AddTriangles(TriangleMode mode, const std::vector<std::uint32_t>& corners,
                                  const VertexRange& vertices, bool mirrored, int material) {
  const bool separate = mode == TriangleMode::kSeparate;
  if (separate && corners.size() % 3 != 0) {
    throw DataError("{}: {} corners of triangles, expected a multiple of 3", file_, corners.size());
  }
  // Counts corners, not triangles: a mesh repeated by many nodes may have no triangle and still take very
  // long.
  corners_seen_ += corners.size();
  const std::size_t count = separate ? corners.size() / 3 : std::max<std::size_t>(corners.size(), 2) - 2;
  if (corners_seen_ > 3 * kMaxSceneTriangles || count > kMaxSceneTriangles - scene_.triangles.size()) {
    throw DataError("{}: more than {} triangles", file_, kMaxSceneTriangles);
  }
  for (const std::uint32_t corner : corners) {
    if (corner >= vertices.count) {
      throw DataError("{}: a triangle names vertex {} of {}", file_, corner, vertices.count);
    }
  }
  for (std::size_t i = 0; i < count; ++i) {
    Eigen::Vector3i triangle;
    const std::array<std::size_t, 3> places = CornersOf(mode, i);
    for (int k = 0; k < 3; ++k) triangle[k] = static_cast<int>(vertices.first + corners[places[k]]);
    const bool stitch =
        triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0];
    if (stitch && !separate) continue;  // joins strips; not a real triangle
    if (mirrored) std::swap(triangle[1], triangle[2]);
    scene_.triangles.push_back(triangle);
    material_of_triangle_.push_back(material);
  }
}

void SceneAssembler::NameObject(const std::string& name, std::size_t first_vertex) {
  const std::size_t count = vertex_count() - first_vertex;
  if (!name.empty() && count > 0) scene_.objects.push_back({name, first_vertex, count});
}

Scene SceneAssembler::Finish(const std::vector<std::string>& names) {
  const std::size_t none = names.size();
  const auto slot = [&](int material) { return material < 0 ? none : static_cast<std::size_t>(material); };
  std::vector<bool> used(none + 1, false);
  for (const int material : material_of_triangle_) {
    if (material >= 0 && slot(material) >= none)
      throw DataError("{}: material {} of {} is named", file_, material, none);
    used[slot(material)] = true;
  }
  std::vector<std::uint16_t> scene_material(none + 1, 0);
  for (std::size_t i = 0; i <= none; ++i) {
    if (!used[i]) continue;
    const std::string unnamed = i == none ? "default" : "material_" + std::to_string(i);
    scene_material[i] = scene_.MaterialIndex(i == none || names[i].empty() ? unnamed : names[i]);
  }
  for (const int material : material_of_triangle_) {
    scene_.triangle_material.push_back(scene_material[slot(material)]);
  }
  scene_.Validate(file_);
  return std::move(scene_);
}

}  // namespace sonarcal::data_io
