// Scenes from CAD files: Wavefront OBJ, STL and PLY, besides glTF (data_io/scenes/scene_io.h).
//
// None of them states its unit or its upward axis. By default all are in metres. OBJ is Y up, as glTF and as
// most programs write it (world = (x, -z, y)); STL and PLY are Z up, as in CAD (world = (x, y, z)). A wrong
// unit is visible in the scene's size, which programs should print.
//
//   OBJ    Read: vertices, faces with any number of corners (positive or negative indices), `usemtl` names as
//          materials. Faces before the first `usemtl` get "default". The .mtl file is not read, because only
//          names are used. Ignored: textures, normals, colours, groups, lines and points, smoothing.
//          Rejected: free-form curves and surfaces, and sizes beyond the limits of data_io/scenes/cad_mesh.h.
//   STL    Text or binary, detected by the size that the count of a binary file implies; one material,
//          "default". Stored normals are ignored: corners run counter-clockwise seen from outside. Vertices
//          at the same position are merged.
//   PLY    Text or binary of either byte order; one material, "default". Polygons are divided. Colours,
//          normals, texture coordinates and unknown elements are skipped. Vertices at the same position are
//          merged.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

#include "core/types/scene.h"
#include "core/types/words.h"

namespace sonarcal::data_io {

enum class UpAxis { kY, kZ };
constexpr auto WordsOf(std::type_identity<UpAxis>) {
  return Words<UpAxis, 2>{{{"y", UpAxis::kY}, {"z", UpAxis::kZ}}};
}

// Conventions for a file whose format does not define them.
struct SceneConventions {
  std::optional<double> metres_per_unit = {};  // default: 1
  std::optional<UpAxis> up = {};               // default: Y for OBJ, Z for STL and PLY

  bool empty() const { return !metres_per_unit && !up; }
};

inline constexpr std::size_t kMaxCadBytes = std::size_t{1} << 30;

// True if the file's name ends in .obj, .stl or .ply, whose unit and upward axis are a convention.
bool NeedsConventions(const std::filesystem::path& file);

// Scene of any format, detected by the file's name: .obj, .stl and .ply (in upper or lower case) as above,
// all others as glTF. Throws DataError as the readers do, and for conventions given with a glTF, which
// defines its own.
Scene ReadScene(const std::filesystem::path& file, const SceneConventions& conventions = {});

// Reads bytes in memory; `file` is the name used in error messages.
Scene ParseObj(std::string_view bytes, const std::string& file, const SceneConventions& conventions = {});
Scene ParseStl(std::string_view bytes, const std::string& file, const SceneConventions& conventions = {});
Scene ParsePly(std::string_view bytes, const std::string& file, const SceneConventions& conventions = {});

}  // namespace sonarcal::data_io
