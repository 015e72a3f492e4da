// Small OBJ and STL files put together by hand: a box of 1 x 2 x 3 with a corner in the origin.
#pragma once

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace sonarcal::testing {

using Corner = std::array<float, 3>;
using Facet = std::array<Corner, 3>;

// Eight corners, counted through x, then y, then z; six faces, counter-clockwise seen from outside.
inline constexpr std::array<std::array<int, 4>, 6> kCubeFaces = {
    {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};

inline Corner CubeCorner(int i) {
  return {i & 1 ? 1.0F : 0.0F, i & 2 ? 2.0F : 0.0F, i & 4 ? 3.0F : 0.0F};
}

// Quads; the first has no material, the others "old steel #2".
inline std::string CubeObj() {
  std::string obj = "mtllib box.mtl\n";
  for (int i = 0; i < 8; ++i) {
    const Corner corner = CubeCorner(i);
    obj += fmt::format("v {} {} {}\n", corner[0], corner[1], corner[2]);
  }
  for (std::size_t i = 0; i < kCubeFaces.size(); ++i) {
    if (i == 1) obj += "usemtl old steel #2 \n";
    const auto& f = kCubeFaces[i];
    obj += fmt::format("f {} {} {} {}\n", f[0] + 1, f[1] + 1, f[2] + 1, f[3] + 1);
  }
  return obj;
}

inline std::vector<Facet> CubeFacets() {
  std::vector<Facet> facets;
  for (const auto& face : kCubeFaces) {
    facets.push_back({CubeCorner(face[0]), CubeCorner(face[1]), CubeCorner(face[2])});
    facets.push_back({CubeCorner(face[0]), CubeCorner(face[2]), CubeCorner(face[3])});
  }
  return facets;
}

inline std::string TextStl(const std::vector<Facet>& facets) {
  std::string text = "solid a box\n";
  for (const Facet& facet : facets) {
    text += "  facet normal 0 0 0\n    outer loop\n";
    for (const Corner& c : facet) text += fmt::format("      vertex {} {} {:e}\n", c[0], c[1], c[2]);
    text += "    endloop\n  endfacet\n";
  }
  return text + "endsolid a box\n";
}

inline std::string BinaryStl(const std::vector<Facet>& facets, const std::string& header = "a box") {
  std::string bytes = header;
  bytes.resize(80, ' ');
  const auto append = [&](const auto& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
  };
  append(static_cast<std::uint32_t>(facets.size()));
  for (const Facet& facet : facets) {
    append(Corner{0.0F, 0.0F, 0.0F});
    for (const Corner& corner : facet) append(corner);
    append(std::uint16_t{0x8FFF});  // a colour, as some programs have it
  }
  return bytes;
}

}  // namespace sonarcal::testing
