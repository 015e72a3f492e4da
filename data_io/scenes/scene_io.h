// Scenes as glTF 2.0: .gltf (JSON, with buffers embedded or in files beside it) or .glb.
//
// glTF is Y up and the world is Z up: world = (x, -z, y) of the glTF coordinates, metres in both.
//
// Read:   the default scene (else the first; else all nodes without a parent), node transforms applied; a
//         transform that mirrors turns its triangles over, so that they keep facing outwards. Triangles,
//         strips and fans; indices of 8, 16 or 32 bits or none. Of materials the name counts: primitives
//         without one are of "default", the one at place N without a name is "material_N", and materials of
//         one name are one. Names of materials that no triangle has are dropped; the others keep the order
//         of the file, with "default" last.
// Refused: points and lines, positions that are not 32-bit floats or not finite, sparse accessors, required
//         extensions that change the geometry (Draco, meshopt, quantisation), nodes with two parents or in a
//         cycle, buffers outside the file's own directory, and sizes beyond the limits below, in
//         data_io/scenes/scene_assembler.h and in data_io/scenes/gltf_document.h.
// Ignored: textures, normals, skins, morph targets, animations, cameras, lights, optional extensions.
#pragma once

#include <filesystem>
#include <string_view>

#include "core/types/scene.h"

namespace sonarcal::data_io {

inline constexpr int kMaxSceneNodeDepth = 64;

// Throws DataError naming the file, what was found and what was expected.
Scene ReadGltf(const std::filesystem::path& file);

// The same from bytes held in memory; `file` is where they came from, which error sentences name and beside
// which other buffers are looked for.
Scene ParseGltf(std::string_view bytes, const std::filesystem::path& file);

// Writes one mesh with a primitive for each material that has triangles: .gltf with the buffer embedded, or
// .glb, told by the file's extension. ReadGltf gives back the same vertices bit for bit, and the triangles
// grouped by material, otherwise in their order. The file appears whole or not at all.
//
// Throws DataError for an invalid scene, another extension, a name that is not UTF-8, or a file that cannot
// be written.
void WriteGltf(const Scene& scene, const std::filesystem::path& file);

}  // namespace sonarcal::data_io
