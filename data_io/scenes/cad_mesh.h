// Meshes of Wavefront OBJ, STL and PLY files, in the unit and the axes of the file.
//
// No library reads these files here. assimp (5.2) skips an OBJ vertex that it cannot parse, which shifts all
// later indices, divides some concave polygons into overlapping triangles, and reads an STL text that breaks
// off as a shorter mesh. These readers refuse such files and name the line or byte.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace sonarcal::data_io {

inline constexpr std::size_t kMaxObjTriangles = 5'000'000;  // use glTF for larger meshes
inline constexpr std::size_t kMaxObjVertices = 10'000'000;
inline constexpr std::size_t kMaxFaceCorners = 1000;  // the time to divide a polygon grows with the square
inline constexpr std::size_t kMaxStlSolids = 4096;
inline constexpr std::size_t kMaxPlyHeaderLines = 1000;
inline constexpr std::size_t kMaxPlyHeaderLine = 4096;  // bytes

struct CadMesh {
  std::vector<std::string> materials;                 // names; "default" for faces without one
  std::vector<std::vector<Eigen::Vector3f>> corners;  // of each material; each three make a triangle
};

// Reads an OBJ file. `file` is the name used in error messages. Throws DataError, with the line, for
// numbers that are malformed or not finite, indices of missing vertices, faces of fewer than three corners,
// polygons whose sides cross, free-form geometry, unknown statements, and sizes beyond the limits above.
CadMesh ReadObjMesh(std::string_view bytes, const std::string& file);

// Reads an STL file of one material, "default". A binary file has 80 bytes of header, a count and 50 bytes
// per triangle, little-endian. A text file has "solid NAME", facets of three vertices, "endsolid NAME", up to
// kMaxStlSolids times. Some binary files begin with "solid" too, so a file is binary if its size matches its
// count. Throws DataError for a file that is cut short or longer than its count, for text of another form
// (with the line), and for more than kMaxSceneTriangles triangles. Coordinates may be NaN or infinite.
CadMesh ReadStlMesh(std::string_view bytes, const std::string& file);

// Reads a PLY file, version 1.0, of one material, "default": ascii, binary_little_endian or
// binary_big_endian. Vertices are the element "vertex" with the properties x, y and z of any type. Faces are
// the element "face" with a list "vertex_indices" or "vertex_index" of any integer types; polygons are
// divided. Other elements and properties are skipped. Throws DataError, with line or byte, for a header of
// another form, counts that the file cannot hold, data behind the last element, coordinates that are not
// finite, faces of fewer than three corners or of missing vertices, polygons whose sides cross, and more than
// kMaxSceneVertices vertices, kMaxSceneTriangles triangles or kMaxFaceCorners corners per face.
CadMesh ReadPlyMesh(std::string_view bytes, const std::string& file);

}  // namespace sonarcal::data_io
