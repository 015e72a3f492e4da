// Checks the bytes of an STL file, so that they are safe for a parser with fewer checks: assimp accepts a
// truncated text file as a shorter mesh.
//
// Binary: 80 bytes of header, a count, 50 bytes per triangle, little-endian. Text: "solid NAME", facets of
// three vertices, "endsolid NAME", up to kMaxStlSolids times. Some binary files also begin with "solid", so
// the form is detected by the size that the count implies.
#pragma once

#include <cstddef>
#include <string>

namespace sonarcal::data_io {

inline constexpr std::size_t kMaxStlSolids = 4096;

struct StlDocument {
  std::string bytes;  // the header of a binary file, which may contain colours, is blanked
  std::size_t triangles = 0;
};

// `file` is the name used in error messages. Throws DataError if the file is shorter or longer than it
// states, if text has another structure (with the line), or for more triangles than a scene may have.
StlDocument CheckStl(std::string bytes, const std::string& file);

}  // namespace sonarcal::data_io
