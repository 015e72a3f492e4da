// Small glTF files put together by hand, so that a test can damage any part of them.
#pragma once

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <initializer_list>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/support/temp_dir.h"

namespace sonarcal::testing {

inline constexpr int kFloat = 5126;
inline constexpr int kU8 = 5121;
inline constexpr int kU16 = 5123;
inline constexpr int kU32 = 5125;

inline std::string Base64(const std::string& bytes) {
  constexpr const char* kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = group << 8 | (i + k < bytes.size() ? static_cast<std::uint8_t>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text += i + k <= bytes.size() ? kDigits[group >> (18 - 6 * k) & 63U] : '=';
    }
  }
  return text;
}

struct GltfBuilder {
  nlohmann::json root = {{"asset", {{"version", "2.0"}}}};
  std::string buffer;

  // Each returns the index of what it added.
  int Add(const char* array, nlohmann::json item) {
    root[array].push_back(std::move(item));
    return static_cast<int>(root[array].size()) - 1;
  }

  template <typename T>
  int Accessor(const std::vector<T>& values, int component_type, const char* type) {
    buffer.append((4 - buffer.size() % 4) % 4, '\0');
    const std::size_t bytes = values.size() * sizeof(T);
    const int view =
        Add("bufferViews", {{"buffer", 0}, {"byteOffset", buffer.size()}, {"byteLength", bytes}});
    buffer.append(reinterpret_cast<const char*>(values.data()), bytes);
    const std::size_t count = values.size() / (std::string(type) == "VEC3" ? 3 : 1);
    return Add("accessors",
               {{"bufferView", view}, {"componentType", component_type}, {"count", count}, {"type", type}});
  }

  int Positions(const std::vector<float>& xyz) { return Accessor(xyz, kFloat, "VEC3"); }

  // A mesh of one primitive, and a node that shows it in the only scene.
  int Show(nlohmann::json primitive) {
    const int mesh = Add("meshes", {{"primitives", {std::move(primitive)}}});
    const int node = Add("nodes", {{"mesh", mesh}});
    if (!root.contains("scenes")) Add("scenes", {{"nodes", nlohmann::json::array()}});
    root["scenes"][0]["nodes"].push_back(node);
    return node;
  }

  std::string Embedded() const {
    nlohmann::json full = root;
    full["buffers"] = {
        {{"byteLength", buffer.size()}, {"uri", "data:application/octet-stream;base64," + Base64(buffer)}}};
    return full.dump();
  }

  std::string WithUri(const std::string& uri) const {
    nlohmann::json full = root;
    full["buffers"] = {{{"byteLength", buffer.size()}, {"uri", uri}}};
    return full.dump();
  }

  std::string Glb() const {
    nlohmann::json full = root;
    full["buffers"] = {{{"byteLength", buffer.size()}}};
    std::string json = full.dump();
    json.append((4 - json.size() % 4) % 4, ' ');
    std::string bin = buffer;
    bin.append((4 - bin.size() % 4) % 4, '\0');
    const auto u32 = [](std::size_t value) {
      const auto word = static_cast<std::uint32_t>(value);
      std::string bytes(4, '\0');
      std::memcpy(bytes.data(), &word, 4);
      return bytes;
    };
    return "glTF" + u32(2) + u32(12 + 8 + json.size() + 8 + bin.size()) + u32(json.size()) + "JSON" + json +
           u32(bin.size()) + std::string("BIN\0", 4) + bin;
  }
};

// The triangle (0,0,0), (1,0,0), (0,1,0) of glTF, which faces glTF's +z.
inline GltfBuilder OneTriangle() {
  GltfBuilder gltf;
  const int positions = gltf.Positions({0, 0, 0, 1, 0, 0, 0, 1, 0});
  const int indices = gltf.Accessor<std::uint16_t>({0, 1, 2}, kU16, "SCALAR");
  gltf.Show({{"attributes", {{"POSITION", positions}}}, {"indices", indices}});
  return gltf;
}

// A tetrahedron of volume 1/6 m^3, one corner at the origin.
inline GltfBuilder Tetrahedron() {
  GltfBuilder gltf;
  const int positions = gltf.Positions({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1});
  const int indices = gltf.Accessor<std::uint8_t>({0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3}, kU8, "SCALAR");
  gltf.Show({{"attributes", {{"POSITION", positions}}}, {"indices", indices}});
  return gltf;
}

}  // namespace sonarcal::testing
