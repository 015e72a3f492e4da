// The bytes of a .gltf or .glb file, checked and reduced to what a mesh needs, so that they are fit for a
// parser that trusts its input.
//
// tinygltf recurses as deep as the JSON's "extras" go, opens every image, copies the binary chunk once for
// each buffer that asks for it, and passes in silence over members of the wrong type. None of this reaches
// it: images, textures, animations, skins, cameras, extensions and extras are left out, materials keep
// their name alone, lengths are bounded, and indices and numbers are checked to be what they should be.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace sonarcal::data_io {

inline constexpr std::size_t kMaxGltfBytes = std::size_t{1} << 30;  // of a file; of all buffers together
inline constexpr int kMaxGltfJsonDepth = 32;
inline constexpr std::size_t kMaxGltfJsonValues = 500'000;
inline constexpr std::size_t kMaxGltfMaterials = 4096;

struct GltfDocument {
  bool binary = false;  // a .glb container; otherwise JSON text
  std::string bytes;
};

// Which of the two forms `bytes` have is told from their first four. `file` is the name that error sentences
// carry. Throws DataError for what is not glTF 2.0, exceeds a limit above, or requires an extension that
// changes the geometry, such as compression.
GltfDocument ReduceGltf(std::string_view bytes, const std::string& file);

// The bytes of the file that a buffer's (decoded) uri names, relative to `directory`, that of the glTF file.
// Throws DataError where the uri is absolute or climbs out of the directory, and where the file cannot be
// read.
std::string ReadGltfBuffer(const std::filesystem::path& directory, const std::string& uri);

}  // namespace sonarcal::data_io
