// Assembles a scene from the parts of a file and enforces its limits.
//
// Materials keep their numbers of the file until Finish, which names those that have triangles.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "core/types/scene.h"

namespace sonarcal::data_io {

inline constexpr std::size_t kMaxSceneVertices = 30'000'000;
inline constexpr std::size_t kMaxSceneTriangles = 20'000'000;

// Conversion of a sequence of corners to triangles: glTF 2.0, section 3.7.2.1.
enum class TriangleMode { kSeparate, kStrip, kFan };

// Range of the vertices added so far.
struct VertexRange {
  std::size_t first = 0;
  std::size_t count = 0;
};

class SceneAssembler {
 public:
  // `file` is the name used in error messages.
  explicit SceneAssembler(std::string file) : file_(std::move(file)) {}

  std::size_t vertex_count() const { return scene_.vertices_m.size(); }

  // Throws DataError if a coordinate is not finite as a float, or there are too many vertices.
  void AddVertex(const Eigen::Vector3d& world_m);

  // Adds triangles whose corners are numbered from 0 within `vertices`. `mirrored` reverses their
  // orientation. `material` is negative for none. Throws DataError for a corner beyond `vertices`, an
  // incomplete triangle, or too many of them.
  void AddTriangles(TriangleMode mode, const std::vector<std::uint32_t>& corners, const VertexRange& vertices,
                    bool mirrored, int material);

  // Names the vertices from `first_vertex` up to the last one added. Has no effect without a name or
  // vertices.
  void NameObject(const std::string& name, std::size_t first_vertex);

  // Returns the scene; call once. `names` are those of the file's materials: "" becomes "material_N", no
  // material "default", and materials with one name are merged. Names without triangles are dropped; the
  // others keep their order, with "default" last. Throws DataError if there are no triangles.
  Scene Finish(const std::vector<std::string>& names);

 private:
  std::string file_;
  Scene scene_;
  std::size_t corners_seen_ = 0;
  std::vector<int> material_of_triangle_;
};

}  // namespace sonarcal::data_io
