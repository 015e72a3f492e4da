// The bytes of a Wavefront OBJ file, checked and reduced to what a mesh needs, so that they are fit for a
// parser that trusts its input.
//
// assimp (5.2) leaves out a vertex line that it does not understand, which shifts all indices after it; opens
// the files that an OBJ names; keeps a kilobyte for each group; and divides some hollow polygons into
// triangles that overlap (an L of six corners among them). None of this reaches it: the reduced text has
// vertices of three numbers, then for each material its triangles by positive index.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace sonarcal::data_io {

inline constexpr std::size_t kMaxObjTriangles = 5'000'000;  // larger meshes: glTF
inline constexpr std::size_t kMaxObjVertices = 10'000'000;
inline constexpr std::size_t kMaxObjMaterials = 4096;
inline constexpr std::size_t kMaxObjFaceCorners = 1000;  // dividing a polygon takes the square of them

struct ObjDocument {
  std::string text;                    // materials are named "0", "1", ...
  std::vector<std::string> materials;  // the names of those; "default" for faces without
  std::size_t triangles = 0;           // that the faces make
};

// `file` is the name that error sentences carry. Throws DataError, with the line, for numbers that are none
// or not finite, indices of vertices that are not there, faces of less than three corners, free-form
// geometry, statements that OBJ does not have, and sizes beyond the limits above.
ObjDocument ReduceObj(std::string_view bytes, const std::string& file);

}  // namespace sonarcal::data_io
