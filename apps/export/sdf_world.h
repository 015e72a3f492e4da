// A world in SDF around an exported model, which Gazebo (gz sim) loads by itself: the plugins of the world
// that the sensor needs, the model at the pose of the sonar, and the scene as static models.
//
// Source: github.com/gazebosim/gz-sim 93bbf3e, examples/worlds/gpu_lidar_sensor.sdf and
// src/systems/sensors/Sensors.cc.
#pragma once

#include <string>
#include <vector>

#include "apps/export/export_account.h"
#include "apps/export/simulator_configs.h"

namespace pugi {
class xml_node;
}  // namespace pugi

namespace sonarcal::exporting {

struct WorldPlugin {
  const char* filename;
  const char* name;
};

inline constexpr const char* kWorldSuffix = "_world.sdf";

// Returns the world (suffix kWorldSuffix) and the meshes of its scene. `plugins`: in addition to those of
// every Gazebo world with a rendered sensor.
std::vector<ExportedFile> SdfWorld(const pugi::xml_node& model, const ExportSource& source,
                                   const std::string& name, const std::string& schema,
                                   const std::vector<WorldPlugin>& plugins);

}  // namespace sonarcal::exporting
