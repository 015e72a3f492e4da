// Scenes from a user's CAD: Wavefront OBJ and STL beside glTF (data_io/scenes/scene_io.h).
//
// Neither format says its unit or which way is up. Where nobody says otherwise both are metres; OBJ is Y up,
// as glTF and as most programs write it (world = (x, -z, y)), STL is Z up, as CAD has it (world = (x, y, z)).
// A wrong unit shows at once in the scene's size, which programs should print.
//
// OBJ    Read: vertices, faces of any number of corners (positive or negative indices), `usemtl` names as
//        materials; faces before the first are of "default". The .mtl file is not looked for: names are all
//        that counts. Ignored: textures, normals, colours, groups, lines and points, smoothing. Refused:
//        free-form curves and surfaces, and limits of data_io/scenes/obj_document.h.
// STL    Text or binary, told by the size that a binary file's count makes; one material, "default". Stored
//        normals are ignored: corners run counter-clockwise seen from outside. Vertices at the same place
//        become one.
//
// Read by assimp, after the bytes were checked and reduced (data_io/scenes/obj_document.h,
// data_io/scenes/stl_document.h).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <type_traits>

#include "core/types/scene.h"
#include "core/types/words.h"

namespace sonarcal::data_io {

enum class UpAxis { kY, kZ };
constexpr auto WordsOf(std::type_identity<UpAxis>) {
  return Words<UpAxis, 2>{{{"y", UpAxis::kY}, {"z", UpAxis::kZ}}};
}

// What a file of a format without conventions is taken for.
struct SceneConventions {
  std::optional<double> metres_per_unit = {};  // default: 1
  std::optional<UpAxis> up = {};               // default: Y for OBJ, Z for STL

  bool empty() const { return !metres_per_unit && !up; }
};

inline constexpr std::size_t kMaxCadBytes = std::size_t{1} << 30;

// Whether the file's name says OBJ or STL, whose unit and upward axis are a matter of convention.
bool NeedsConventions(const std::filesystem::path& file);

// A scene of any format, told by the file's name: .obj and .stl (in any case) as above, all else as glTF.
// Throws DataError as the readers do, and for conventions given for a glTF, which has its own.
Scene ReadScene(const std::filesystem::path& file, const SceneConventions& conventions = {});

// From bytes held in memory; `file` is the name that error sentences carry.
Scene ParseObj(std::string bytes, const std::string& file, const SceneConventions& conventions = {});
Scene ParseStl(std::string bytes, const std::string& file, const SceneConventions& conventions = {});

}  // namespace sonarcal::data_io
