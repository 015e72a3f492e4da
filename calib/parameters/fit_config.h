// User's part of a fit: the parameters that it may change, and its frames. The solver's options are in
// fit_options.h.
//
// As a file (`--config fit.json`; an unknown key is refused with its line):
//
//   {"format": "sonar-fit-config/1",
//    "free":  ["materials", "display.db_max", "jitter.*"],
//    "fixed": ["material.wall.gsab.*"],
//    "bounds": {"material.floor.gsab.D": [0.5, 3.0]},
//    "priors": {"beam.azimuth_width_deg": [1.0, 0.05], "receiver.noise_db": "none"},
//    "pose_prior": {"position_m": 0.02, "angle_deg": 1.0},
//    "start": {"geometry.range_scale": 0.99},
//    "held_out": [2, 5], "used": [0, 1, 3, 4]}
//
// Names are those of parameter_catalog.h; `*` stands for any text. Groups: materials (every GSAB value),
// noise, psf (beam and pulse), mirrors (every loss), pose (of each frame), mount, geometry, object:NODE (its
// position and angles), outline:NODE (its shape; plain `outline` for all of them), display, jitter,
// source_level. `fixed` takes precedence over `free`. A prior is a value and its sigma, in the unit of the
// parameter, or "none". `start` gives values at which the fit starts, in place of those of the parameters,
// the recorded poses and the declared geometry; priors stay about the latter. Priors have an effect only in a
// fit by likelihood. There every parameter has a default prior (parameter_catalog.h).
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "calib/parameters/parameter_catalog.h"
#include "core/materials/named_materials.h"

namespace sonarcal::data_io {
class JsonReader;
}

namespace sonarcal::calib {

struct PosePrior {
  double position_m = 0.1;
  double angle_deg = 3.0;

  bool operator==(const PosePrior&) const = default;
};

struct FitConfig {
  std::optional<std::vector<std::string>> free = {};  // absent: the default of the model's fit
  std::vector<std::string> fixed = {};
  std::map<std::string, std::pair<double, double>> bounds = {};
  // Trust region of one solve, by name. Set by a fit in rounds, not by a user.
  std::map<std::string, std::pair<double, double>> trust_regions = {};
  std::map<std::string, std::optional<std::pair<double, double>>> priors = {};  // nullopt: no prior
  PosePrior pose_prior = {};
  std::map<std::string, double> start = {};  // by name
  // Held-out frames. Absent: the last third of `used` or of all frames, at least one if there are two.
  std::optional<std::vector<int>> held_out = {};
  std::optional<std::vector<int>> used = {};  // fitted unless held out; absent: all frames

  bool operator==(const FitConfig&) const = default;
};

// Throws DataError with file, line and key.
FitConfig ReadFitConfig(const std::filesystem::path& path);
// As ReadFitConfig; `name` is the name for messages.
FitConfig ParseFitConfig(std::string_view text, const std::string& name);

// Reads the members of an object. Leaves unknown keys to the reader's Finish.
FitConfig FitConfigFrom(const data_io::JsonReader& root);

nlohmann::ordered_json FitConfigJson(const FitConfig& config);

// Names of the parts of the scene whose placement the configuration frees: "object:NODE" or
// "object.NODE.x_m".
std::vector<std::string> ObjectsNamed(const FitConfig& config);

// As above, for the parts whose outline it frees: "outline:NODE" or "outline.NODE.*".
std::vector<std::string> OutlinesNamed(const FitConfig& config);

// Returns the configuration with the part of the scene that a free "outline" without a name means: the only
// named part, otherwise the only material. Throws DataError with the names if there are several.
FitConfig WithOutlineNamed(FitConfig config, const Scene& scene);

// Returns which entries of a catalog are free (config.free must be given), and narrows the bounds of the
// entries. Throws DataError for a name or pattern that matches nothing.
std::vector<bool> ApplyFitConfig(const FitConfig& config, std::vector<CatalogEntry>& catalog);

// Gives every free entry of the catalog without a prior one about its initial value, with one typical step as
// sigma. A fit that starts at the result of another one thus keeps the original priors.
void GivePriors(const ParameterValues& initial, const std::vector<bool>& free,
                const std::vector<CatalogEntry>& catalog, FitConfig& config);

// Does both: returns which entries are free, and gives each a prior in the configuration and in the catalog.
std::vector<bool> ApplyFitConfigWithPriors(const ParameterValues& initial, FitConfig& config,
                                           std::vector<CatalogEntry>& catalog);

// Standard deviation of the sonar's level (source level and gain) before a fit, unless it is calibrated.
inline constexpr double kUnknownLevelDb = 20.0;

// Gives the parameters of a scene's material the prior of `known`, except those for which the configuration
// has a prior by name, group or pattern. A, C and E are uncertain by the spread of `known` and by
// `level_sigma_db` together. Throws DataError if the material is one of another image model.
void AddMaterialPriors(const std::string& material, const NamedMaterial& known,
                       const ParameterSet& parameters, double level_sigma_db, FitConfig& config);

// Returns the initial values with those of config.start, within the bounds. Throws DataError for a name that
// is not in the catalog.
ParameterValues StartValues(const FitConfig& config, const std::vector<CatalogEntry>& catalog,
                            ParameterValues initial);

struct FrameSplit {
  std::vector<int> used;
  std::vector<int> held_out;
};

// Throws DataError if a used or held-out frame does not exist or if no frame is left to fit.
FrameSplit SplitFrames(const FitConfig& config, int frame_count);

}  // namespace sonarcal::calib
