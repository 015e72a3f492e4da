// Casts the rays of a sonar into a scene, with sonarcal::sim alone.
#include <iostream>

#include "sim/scenes/environments.h"
#include "sim/scenes/sonar_presets.h"

int main() {
  const sonarcal::Scene scene = sonarcal::sim::FindEnvironment("tank").make({});
  const sonarcal::sim::SonarPreset& preset = sonarcal::sim::FindSonarPreset("aris3000");
  std::cout << scene.triangles.size() << " triangles, " << preset.sonar.axes.beam_count() << " beams\n";
  return scene.triangles.empty() ? 1 : 0;
}
