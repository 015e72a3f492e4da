// Small OBJ, STL and PLY files put together by hand: a box of 1 x 2 x 3 with a corner in the origin.
#pragma once

#include <fmt/format.h>

#include <algorithm>
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

// Quads, with a colour per vertex, an element that no reader knows, and the faces before the vertices.
inline std::string TextPly() {
  std::string ply =
      "ply\nformat ascii 1.0\ncomment a box\nobj_info of quads\nelement face 6\n"
      "property list uchar int vertex_indices\nelement camera 2\nproperty list uchar float place\n"
      "property uchar kind\nelement vertex 8\nproperty float x\nproperty uchar red\nproperty float y\n"
      "property double z\nend_header\n";
  for (const auto& f : kCubeFaces) ply += fmt::format("4 {} {} {} {}\n", f[0], f[1], f[2], f[3]);
  ply += "3 0.5 1e3 -2 7\n0 8\n";
  for (int i = 0; i < 8; ++i) {
    const Corner corner = CubeCorner(i);
    ply += fmt::format("{} 200 {} {}\n", corner[0], corner[1], corner[2]);
  }
  return ply;
}

// Appends a value in the byte order of the file.
template <typename T>
void AppendBytes(T value, bool big_endian, std::string& bytes) {
  std::array<char, sizeof(T)> own{};  // little-endian, as this machine
  std::memcpy(own.data(), &value, sizeof(T));
  if (big_endian) std::reverse(own.begin(), own.end());
  bytes.append(own.data(), own.size());
}

// The same content as TextPly, with the integer types of the counts and indices of faces.
template <typename Count, typename Index>
std::string BinaryPly(const std::string& count_type, const std::string& index_type, bool big_endian) {
  std::string ply = fmt::format(
      "ply\r\nformat binary_{}_endian 1.0\r\nelement vertex 8\r\nproperty float32 x\r\nproperty short "
      "nothing\r\n"
      "property float y\r\nproperty float64 z\r\nelement edge 1\r\nproperty list uint8 uint16 ends\r\n"
      "element face 6\r\nproperty uchar flags\r\nproperty list {} {} vertex_index\r\n"
      "property list uchar float texcoord\r\nend_header\r\n",
      big_endian ? "big" : "little", count_type, index_type);
  const auto append = [&](auto value) { AppendBytes(value, big_endian, ply); };
  for (int i = 0; i < 8; ++i) {
    const Corner corner = CubeCorner(i);
    append(corner[0]);
    append(std::int16_t{-7});
    append(corner[1]);
    append(double{corner[2]});
  }
  append(std::uint8_t{2});
  append(std::uint16_t{0});
  append(std::uint16_t{1});
  for (const auto& face : kCubeFaces) {
    append(std::uint8_t{1});
    append(static_cast<Count>(4));
    for (const int corner : face) append(static_cast<Index>(corner));
    append(std::uint8_t{2});
    append(0.25F);
    append(0.75F);
  }
  return ply;
}

inline std::string BinaryPly(bool big_endian = false) {
  return BinaryPly<std::uint8_t, std::int32_t>("uchar", "int", big_endian);
}

}  // namespace sonarcal::testing
