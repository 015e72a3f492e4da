// The bytes of an STL file, checked to be what they claim, so that they are fit for a parser that makes do
// with less: assimp takes a text file that breaks off for a shorter mesh.
//
// Binary: 80 bytes of header, a count, 50 bytes a triangle, little-endian. Text: "solid NAME", facets of
// three vertices, "endsolid NAME", up to kMaxStlSolids times. Some binary files begin with "solid" too, so
// the form is told by the size that the count makes.
#pragma once

#include <cstddef>
#include <string>

namespace sonarcal::data_io {

inline constexpr std::size_t kMaxStlSolids = 4096;

struct StlDocument {
  std::string bytes;  // a binary file's header, which may carry colours, is blanked
  std::size_t triangles = 0;
};

// `file` is the name that error sentences carry. Throws DataError for what is cut short or longer than it
// says, for text that is not made as above (with the line), and for more triangles than a scene may have.
StlDocument CheckStl(std::string bytes, const std::string& file);

}  // namespace sonarcal::data_io
