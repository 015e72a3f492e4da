// Checks the bytes of a Wavefront OBJ file and reduces them to the mesh, so that they are safe for a parser
// that trusts its input.
//
// assimp (5.2) skips a vertex line that it does not understand, which shifts all later indices. It opens the
// files that an OBJ names, and uses a kilobyte per group. It divides some concave polygons into overlapping
// triangles (e.g. an L with six corners). The reduced text avoids this: it has vertices of three numbers,
// then for each material its triangles with positive indices.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace sonarcal::data_io {

inline constexpr std::size_t kMaxObjTriangles = 5'000'000;  // use glTF for larger meshes
inline constexpr std::size_t kMaxObjVertices = 10'000'000;
inline constexpr std::size_t kMaxObjMaterials = 4096;
// dividing a polygon takes time of the square of the corners
inline constexpr std::size_t kMaxObjFaceCorners = 1000;

struct ObjDocument {
  std::string text;                    // materials are named "0", "1", ...
  std::vector<std::string> materials;  // names of these materials; "default" for faces without
  std::size_t triangles = 0;           // number of triangles from all faces
};

// `file` is the name used in error messages. Throws DataError, with the line, for invalid or non-finite
// numbers, indices of missing vertices, faces with fewer than three corners, free-form geometry, unknown
// statements, and sizes beyond the limits above.
ObjDocument ReduceObj(std::string_view bytes, const std::string& file);

}  // namespace sonarcal::data_io
