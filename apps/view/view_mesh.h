// A scene in the format of the page's 3D view (apps/view/view_api.h).
#pragma once

#include <string>

#include "core/types/scene.h"

namespace sonarcal::view {

// Max number of triangles that a browser turns smoothly. Of larger meshes every second, third, ... triangle
// is shown, with a note.
inline constexpr std::size_t kMaxTrianglesShown = 1'000'000;

// Returns a framed mesh: {"vertices", "triangles", "triangles_in_scene", "material_names", "lowest_m": [x, y,
// z], "highest_m"}.
std::string MeshFrame(const Scene& scene, std::size_t most = kMaxTrianglesShown);

// Returns JSON and its data as one answer. Data are aligned to four bytes.
std::string Framed(const std::string& json, const std::string& data);

}  // namespace sonarcal::view
