// Configurations of other simulators of sonars. Each writes what that simulator's own documentation or source
// has a name for, and accounts for every parameter of ours; what a simulator must be told and we do not know
// is left to its defaults.
//
// To add a simulator: a file here with its Export function, a line in kSimulators of
// apps/commands/export_command.cc, and its schema, from its own pages, in tests/apps/export/simulator_schemas.h.
#pragma once

#include <string>
#include <vector>

#include "apps/export/export_account.h"

namespace sonarcal::exporting {

struct ExportedFile {
  std::string suffix;  // after the name that the user gave, less its extension; empty for that name itself
  std::string text;
};

struct ExportedConfig {
  std::vector<ExportedFile> files;  // the first is the configuration
  ExportAccount account;
  std::string schema;  // what it was written against
};

// `name` is that of the configuration's file, less its extension, for files that name each other.

// A model in SDF 1.6 for Gazebo classic: a depth camera with DAVE's plugin for multibeam sonars, and its
// table of reflectivities, which belongs into the folder worlds/ of nps_uw_multibeam_sonar.
ExportedConfig ExportToDave(const ExportSource& source, const std::string& name);

// An entry of "sensors" of an agent in a scenario, JSON.
ExportedConfig ExportToHoloOcean(const ExportSource& source, const std::string& name);

// A scenario file (XML) with a sensor of type "fls".
ExportedConfig ExportToStonefish(const ExportSource& source, const std::string& name);

// Keyword arguments of the constructor of ImagingSonarSensor, of sonar_initialize() and make_sonar_data(),
// and reflectivities for semantic labels, JSON.
ExportedConfig ExportToOceanSim(const ExportSource& source, const std::string& name);

// A model in SDF 1.9 with a gpu_lidar: Gazebo itself has no imaging sonar, so that this gives the geometry of
// the beams alone.
ExportedConfig ExportToGazebo(const ExportSource& source, const std::string& name);

}  // namespace sonarcal::exporting
