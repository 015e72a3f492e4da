// `sonarcal scenes`: writes inputs for simulations: the scenes of Park 2024 (sim/scenes/environments.h) as
// glTF, poses for each, and start parameters.
//
// Writes <name>.gltf and poses_<name>.json for each scene, params.json for all of them, and poses_1.json to
// poses_3.json, the paper's three data sets in the tank.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "apps/cli/command.h"
#include "core/types/parameters.h"
#include "sim/scenes/environments.h"

namespace sonarcal::commands {

struct ScenesOptions {
  cli::CommonOptions common;
  std::filesystem::path out;      // empty with `list`
  bool list = false;              // lists the scenes, writes nothing
  std::vector<std::string> only;  // names; empty: all
  sim::EnvironmentOptions environment;
  bool text_sizes = false;  // uses the sizes of the paper's text instead of its Table 5
};

cli::ExitStatus RunScenes(ScenesOptions options);

// Returns parameters of the paper's model for every scene: its Table 4 for every material.
ParameterSet EnvironmentParameters();

// Returns the environments that `only` names; all if it is empty. Throws UsageError for an unknown name.
std::vector<const sim::Environment*> ChosenEnvironments(const std::vector<std::string>& only);

// Adds --only, --edge, --seed and --surface.
void AddEnvironmentOptions(CLI::App& command, std::vector<std::string>& only,
                           sim::EnvironmentOptions& options);

}  // namespace sonarcal::commands
