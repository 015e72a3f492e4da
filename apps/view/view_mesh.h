// A scene as the page's 3D view takes it (apps/view/view_api.h).
#pragma once

#include <string>

#include "core/types/scene.h"

namespace sonarcal::view {

// What a browser turns about smoothly; of larger meshes every second, third, ... triangle is shown, and that
// is said.
inline constexpr std::size_t kMostTrianglesShown = 1'000'000;

// Framed: {"vertices", "triangles", "triangles_in_scene", "material_names", "lowest_m": [x, y, z],
// "highest_m"}.
std::string MeshFrame(const Scene& scene, std::size_t most = kMostTrianglesShown);

// JSON and the data it describes, as one answer. Data begin at a multiple of four bytes.
std::string Framed(const std::string& json, const std::string& data);

}  // namespace sonarcal::view
