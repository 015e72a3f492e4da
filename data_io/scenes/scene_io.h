// Scenes as glTF 2.0: .gltf (JSON, with buffers embedded or in files beside it) or .glb.
//
// glTF is Y up and the world is Z up: world = (x, -z, y) of the glTF coordinates, metres in both.
//
//   Read:      The default scene (otherwise the first; otherwise all nodes without a parent), with node
//              transforms applied. A mirroring transform reverses its triangles, so they keep facing
//              outwards. Triangles, strips and fans; indices of 8, 16 or 32 bits or none. Names of nodes.
//              Only the names of materials: primitives without one get "default", an unnamed material at
//              position N "material_N", and materials with one name are merged. Names without triangles are
//              dropped; the others keep the order of the file, with "default" last.
//   Rejected:  Points and lines, positions that are not 32-bit floats or not finite, sparse accessors,
//              required extensions that change the geometry (Draco, meshopt, quantisation), nodes with two
//              parents or in a cycle, buffers outside the file's own directory, and sizes beyond the limits
//              below, in data_io/scenes/scene_assembler.h and in data_io/scenes/gltf_document.h.
//   Ignored:   Textures, normals, skins, morph targets, animations, cameras, lights, optional extensions.
#pragma once

#include <filesystem>
#include <string_view>

#include "core/types/scene.h"

namespace sonarcal::data_io {

inline constexpr int kMaxSceneNodeDepth = 64;

// Throws DataError that names the file, what was found and what was expected.
Scene ReadGltf(const std::filesystem::path& file);

// Reads bytes in memory. `file` is their origin: the name used in error messages, and the folder of other
// buffers.
Scene ParseGltf(std::string_view bytes, const std::filesystem::path& file);

// Writes one mesh with a primitive for each material that has triangles: .gltf with the buffer embedded, or
// .glb, by the file's extension. ReadGltf returns exactly the same vertices, and the triangles grouped by
// material, otherwise in their order. The file appears completely or not at all.
//
// Throws DataError for an invalid scene, another extension, a name that is not UTF-8, or a file that cannot
// be written.
void WriteGltf(const Scene& scene, const std::filesystem::path& file);

}  // namespace sonarcal::data_io
