// A wall of two materials, and a sonar that sees it.
#pragma once

#include <utility>

#include "core/types/scene.h"
#include "core/types/sonar_model.h"
#include "core/types/units.h"

namespace sonarcal::workflow {

// A wall square across the view at 3 m, "steel" on the left and "wood" on the right.
inline Scene Wall() {
  Scene scene;
  const auto add = [&](const char* material, float left_m, float right_m) {
    const int first = static_cast<int>(scene.vertices_m.size());
    for (const auto& [x_m, z_m] : {std::pair{left_m, -5.0F}, std::pair{right_m, -5.0F},
                                   std::pair{right_m, 5.0F}, std::pair{left_m, 5.0F}}) {
      scene.vertices_m.emplace_back(x_m, 3.0F, z_m);
    }
    scene.triangles.insert(scene.triangles.end(),
                           {{first, first + 1, first + 2}, {first, first + 2, first + 3}});
    scene.triangle_material.insert(scene.triangle_material.end(), 2, scene.MaterialIndex(material));
  };
  add("steel", -5.0F, 0.0F);
  add("wood", 0.0F, 5.0F);
  return scene;
}

// 40 beams, one degree each, 1 to 5 m.
inline SonarModel FlatSonar() {
  SonarModel sonar;
  sonar.axes = {1.0, 5.0, 400, {}};
  for (int beam = 0; beam < 40; ++beam) sonar.axes.beam_azimuth_rad.push_back(RadFromDeg(beam - 19.5));
  sonar.azimuth_beam_width_deg = 1.0;
  sonar.elevation_beam_width_deg = 2.0;
  return sonar;
}

}  // namespace sonarcal::workflow
