// Configurations of other sonar simulators. Each contains the values that the documentation or source of that
// simulator has a name for, with an account of all our parameters. Values that we do not know keep its
// defaults.
//
// To add a simulator: add a file here with its Export function, a line in kSimulators of
// apps/commands/export_command.cc, and its schema, from its own pages, in
// tests/apps/export/simulator_schemas.h.
#pragma once

#include <string>
#include <vector>

#include "apps/export/export_account.h"

namespace sonarcal::exporting {

struct ExportedFile {
  std::string suffix;  // appended to the name of the user without its extension; empty: that name itself
  std::string text;
};

struct ExportedConfig {
  std::vector<ExportedFile> files;  // the first is the configuration
  ExportAccount account;
  std::string schema;  // version of the simulator or its schema
};

// `name`: name of the configuration file without extension, for files that refer to each other.

// Makes a model in SDF 1.6 for Gazebo classic: a depth camera with DAVE's plugin for multibeam sonars, and
// its table of reflectivities, which belongs into the folder worlds/ of nps_uw_multibeam_sonar.
ExportedConfig ExportToDave(const ExportSource& source, const std::string& name);

// Makes a model in SDF 1.9 with the sensor of DAVE for ROS 2 and Gazebo Harmonic, and a world for it.
ExportedConfig ExportToDaveRos2(const ExportSource& source, const std::string& name);

// Makes an entry of "sensors" of an agent in a scenario, JSON.
ExportedConfig ExportToHoloOcean(const ExportSource& source, const std::string& name);

// Makes a scenario file (XML) that Stonefish loads by itself: environment, materials, a look, a sensor of
// type "fls" and, with a scene, one static body and one OBJ file per material.
ExportedConfig ExportToStonefish(const ExportSource& source, const std::string& name);

// Makes keyword arguments of the constructor of ImagingSonarSensor, of sonar_initialize() and
// make_sonar_data(), and reflectivities for semantic labels, JSON.
ExportedConfig ExportToOceanSim(const ExportSource& source, const std::string& name);

// Makes a model in SDF 1.9 with a gpu_lidar, and a world for it. Limit: Gazebo itself has no imaging sonar,
// so only the geometry of the beams is exported.
ExportedConfig ExportToGazebo(const ExportSource& source, const std::string& name);

}  // namespace sonarcal::exporting
