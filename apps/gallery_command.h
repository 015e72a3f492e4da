// `sonarcal gallery`: what a sonar would see of each scene, as Park 2024 Figs. 6 to 8 show it: a row for each
// viewpoint; depth image, fan image and polar image in its columns. Everything in it is simulated.
//
// Written: gallery.html; <scene>_<viewpoint>_depth.png, _fan.png and _polar.png; <scene>.png, all rows of a
// scene in one picture; params.json as used.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "apps/command.h"
#include "apps/ray_options.h"
#include "apps/scene_option.h"
#include "sim/scenes/environments.h"

namespace sonarcal {

struct GalleryOptions {
  CommonOptions common;
  std::filesystem::path out;
  std::vector<std::string> only;  // names of sim/scenes/environments.h; empty: all
  EnvironmentOptions environment = {.bed = true};
  bool no_bed = false;          // leave mock-up, bridge pier and jacket free
  std::filesystem::path scene;  // a user's own, in place of those
  SceneFormat scene_format;
  std::filesystem::path poses;   // of the user's scene
  std::filesystem::path params;  // empty: EnvironmentParameters
  std::string sonar = "p900-45";
  int views = 0;  // the first so many viewpoints of each scene; 0: all
  RayOptions rays{Sampling::kFrustum};
};

ExitStatus RunGallery(const GalleryOptions& options);

}  // namespace sonarcal
