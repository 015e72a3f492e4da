// Checks the bytes of a .gltf or .glb file and reduces them to the mesh, so that they are safe for a parser
// that trusts its input.
//
// tinygltf recurses as deep as the JSON's "extras", opens every image, copies the binary chunk for each
// buffer that uses it, and silently ignores members of the wrong type. The reduction avoids this. It removes
// images, textures, animations, skins, cameras, extensions and extras, and keeps of materials only the names.
// It limits lengths and checks indices and numbers.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace sonarcal::data_io {

// limit of a file, and of all buffers together
inline constexpr std::size_t kMaxGltfBytes = std::size_t{1} << 30;
inline constexpr std::size_t kMaxGltfJsonDepth = 32;
inline constexpr std::size_t kMaxGltfJsonValues = 500'000;

struct GltfDocument {
  bool binary = false;  // .glb container; otherwise JSON text
  std::string bytes;
};

// The first four bytes determine whether `bytes` is .glb or JSON. `file` is the name used in error messages.
// Throws DataError if the text is not glTF 2.0, exceeds a limit above, or requires an extension that changes
// the geometry, such as compression.
GltfDocument ReduceGltf(std::string_view bytes, const std::string& file);

// Bytes of the file named by a buffer's (decoded) uri, relative to `directory`, the folder of the glTF file.
// Throws DataError if the uri is absolute or leaves the directory, or if the file cannot be read.
std::string ReadGltfBuffer(const std::filesystem::path& directory, const std::string& uri);

}  // namespace sonarcal::data_io
