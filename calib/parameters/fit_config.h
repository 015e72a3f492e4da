// What a fit is allowed to change, and on which frames: the user's side of a fit. How it is solved is in
// fit_options.h.
//
// As a file (`--config fit.json`; an unknown key is refused with its line):
//   {"format": "sonar-fit-config/1",
//    "free":  ["materials", "display.db_max", "jitter.*"],
//    "fixed": ["material.wall.gsab.*"],
//    "bounds": {"material.floor.gsab.D": [0.5, 3.0]},
//    "priors": {"beam.azimuth_width_deg": [1.0, 0.05], "receiver.noise_db": "none"},
//    "pose_prior": {"position_m": 0.02, "angle_deg": 1.0},
//    "held_out": [2, 5]}
//
// Names are those of parameter_catalog.h; `*` stands for any text. Groups: materials (every GSAB value),
// noise, psf (beam and pulse), mirrors (every loss), pose (each frame's), mount, display, jitter,
// source_level. `fixed` wins over `free`. A prior is a value and its sigma, in the parameter's unit, or
// nothing at all; it counts where the model's fit is a likelihood, and there every parameter has one
// (parameter_catalog.h) unless it is given here.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "calib/parameters/parameter_catalog.h"

namespace sonarcal::calib {

struct PosePrior {
  double position_m = 0.1;
  double angle_deg = 3.0;

  bool operator==(const PosePrior&) const = default;
};

struct FitConfig {
  std::optional<std::vector<std::string>> free = {};  // absent: what the model's fit frees by default
  std::vector<std::string> fixed = {};
  std::map<std::string, std::pair<double, double>> bounds = {};
  // How far one solve may move a parameter, by name; set by a fit in rounds, not by a user.
  std::map<std::string, std::pair<double, double>> leashes = {};
  std::map<std::string, std::optional<std::pair<double, double>>> priors = {};  // nullopt: nothing is known
  PosePrior pose_prior = {};
  // Frames the fit does not see; absent: the last third, at least one where there are two.
  std::optional<std::vector<int>> held_out = {};

  bool operator==(const FitConfig&) const = default;
};

// Throws DataError with file, line and key.
FitConfig ReadFitConfig(const std::filesystem::path& path);
// As ReadFitConfig; `name` is the name for messages.
FitConfig ParseFitConfig(std::string_view text, const std::string& name);

// Which entries of a catalogue are free (config.free must be given); also narrows the entries' bounds. Throws
// DataError for a name or pattern that matches nothing.
std::vector<bool> ApplyFitConfig(const FitConfig& config, std::vector<CatalogEntry>& catalog);

// Gives every free entry of the catalog that has no prior yet one about its initial value, one typical step
// wide. A fit that starts where another ended keeps so what was known beforehand.
void GivePriors(const ParameterValues& initial, const std::vector<bool>& free,
                const std::vector<CatalogEntry>& catalog, FitConfig& config);

// Both: which entries are free, every one of them with a prior, in the configuration and in the catalog.
std::vector<bool> ApplyFitConfigWithPriors(const ParameterValues& initial, FitConfig& config,
                                           std::vector<CatalogEntry>& catalog);

struct FrameSplit {
  std::vector<int> used;
  std::vector<int> held_out;
};

// Throws DataError where a held-out frame does not exist or none is left to fit.
FrameSplit SplitFrames(const FitConfig& config, int frame_count);

}  // namespace sonarcal::calib
