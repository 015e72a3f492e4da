#include "calib/parameters/fit_config.h"

#include <fmt/ranges.h>
#include <fnmatch.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>

#include <nlohmann/json.hpp>

#include "calib/parameters/pose_step.h"
#include "core/text/nearest_word.h"
#include "core/types/error.h"
#include "core/types/parameter_table.h"
#include "core/types/units.h"
#include "data_io/json/json_reader.h"

namespace sonarcal::calib {
namespace {

constexpr std::string_view kObjectPrefix = "object:";
constexpr std::string_view kOutlinePrefix = "outline:";

// Name of the object in "object.NAME.x_m", where NAME may contain dots.
std::string ObjectOf(const std::string& entry_name) {
  const std::size_t first = entry_name.find('.') + 1;
  const std::size_t last = entry_name.rfind('.');
  return last > first ? entry_name.substr(first, last - first) : std::string();
}

bool Matches(const std::string& pattern, const CatalogEntry& entry) {
  if (pattern == "materials") return entry.group == ParameterGroup::kGsab;
  if (pattern == "display") return entry.group == ParameterGroup::kDisplay;
  if (pattern == "jitter") return entry.group == ParameterGroup::kJitter;
  if (pattern == "source_level") return entry.group == ParameterGroup::kSourceLevel;
  if (pattern == "noise") return entry.name.starts_with("receiver.noise");
  if (pattern == "psf") return entry.group == ParameterGroup::kBeam || entry.group == ParameterGroup::kPulse;
  if (pattern == "mirrors") return entry.group == ParameterGroup::kMirror;
  if (pattern == "pose") return entry.group == ParameterGroup::kPose && entry.frame != kMountFrame;
  if (pattern == "mount") return entry.group == ParameterGroup::kPose && entry.frame == kMountFrame;
  if (pattern == "geometry") return entry.group == ParameterGroup::kGeometry;
  if (pattern.starts_with(kObjectPrefix)) {
    return entry.group == ParameterGroup::kObject && entry.index < kPoseSteps &&
           ObjectOf(entry.name) == pattern.substr(kObjectPrefix.size());
  }
  if (pattern == "outline") return entry.group == ParameterGroup::kOutline;
  if (pattern.starts_with(kOutlinePrefix)) {
    return entry.group == ParameterGroup::kOutline &&
           ObjectOf(entry.name) == pattern.substr(kOutlinePrefix.size());
  }
  return fnmatch(pattern.c_str(), entry.name.c_str(), 0) == 0;
}

// Calls `act` with the index of every entry that matches a pattern. A pattern without a match is an error.
template <typename Act>
void ForMatches(const std::string& pattern, const std::vector<CatalogEntry>& catalog, Act&& act) {
  bool any = false;
  for (std::size_t i = 0; i < catalog.size(); ++i) {
    if (!Matches(pattern, catalog[i])) continue;
    any = true;
    act(i);
  }
  if (any) return;
  std::vector<std::string> words = {"materials",    "noise",   "psf",      "mirrors",
                                    "pose",         "mount",   "geometry", "object:NODE",
                                    "outline:NODE", "display", "jitter",   "source_level"};
  const std::string groups = fmt::format("{}", fmt::join(words, ", "));
  std::vector<std::string> names;
  for (const CatalogEntry& entry : catalog) names.push_back(entry.name);
  words.insert(words.end(), names.begin(), names.end());
  throw DataError("fit: no parameter is called '{}'{}", pattern,
                  ExpectedWord(pattern, words,
                               fmt::format("a group ({}), or a name or pattern among {}", groups,
                                           fmt::join(names, ", "))));
}

// How closely a pattern that matches the entry names it: the name itself most, then a pattern by its
// characters that are no wildcards, then a group, then a pattern of wildcards alone.
int Specificity(const std::string& pattern, const CatalogEntry& entry) {
  if (pattern == entry.name) return std::numeric_limits<int>::max();
  constexpr std::string_view kWildcards = "*?[]";
  if (fnmatch(pattern.c_str(), entry.name.c_str(), 0) != 0) return 1;  // a group
  return 2 * static_cast<int>(std::ranges::count_if(
                 pattern, [&](char letter) { return kWildcards.find(letter) == std::string_view::npos; }));
}

// Calls `act` with each entry that a pattern of `values` matches, and the value of the pattern that names it
// most closely. Two equally close patterns must have the same value. `what`: such as "bounds".
template <typename Value, typename Act>
void ForClosest(const std::map<std::string, Value>& values, const char* what,
                const std::vector<CatalogEntry>& catalog, Act&& act) {
  struct Closest {
    const std::string* pattern = nullptr;
    const Value* value = nullptr;
    int specificity = 0;
    const std::string* contradicts = nullptr;
  };
  std::vector<Closest> closest(catalog.size());
  for (const auto& [pattern, value] : values) {
    ForMatches(pattern, catalog, [&, &name = pattern, &known = value](std::size_t i) {
      const int specificity = Specificity(name, catalog[i]);
      Closest& best = closest[i];
      if (!best.pattern || specificity > best.specificity) {
        best = {&name, &known, specificity, nullptr};
      } else if (specificity == best.specificity && !(known == *best.value)) {
        best.contradicts = &name;
      }
    });
  }
  for (std::size_t i = 0; i < catalog.size(); ++i) {
    if (closest[i].contradicts) {
      throw DataError(
          "fit: '{}' and '{}' give different {} to {}, and neither names it more closely; expected one of "
          "them, or the name itself",
          *closest[i].pattern, *closest[i].contradicts, what, catalog[i].name);
    }
    if (closest[i].pattern) act(i, *closest[i].value);
  }
}

}  // namespace

FitConfig FitConfigFrom(const data_io::JsonReader& root) {
  if (const auto format = root.At("format"); format.String() != "sonar-fit-config/1") {
    format.Fail(fmt::format("is '{}', expected 'sonar-fit-config/1'", format.String()));
  }
  FitConfig config;
  const auto read_names = [&](const char* key, std::vector<std::string>& names) {
    const auto list = root.Find(key);
    if (!list) return;
    names.clear();
    for (const data_io::JsonReader& item : list->Items()) names.push_back(item.String());
  };
  std::vector<std::string> free;
  if (root.Find("free")) {
    read_names("free", free);
    config.free = free;
  }
  read_names("fixed", config.fixed);
  if (const auto bounds = root.Find("bounds")) {
    for (const auto& [name, range] : bounds->Members()) {
      const std::vector<double> limits = range.Numbers();
      if (limits.size() != 2 || !(limits[0] < limits[1]))
        range.Fail("is not [lower, upper] with lower < upper");
      config.bounds[name] = {limits[0], limits[1]};
    }
  }
  if (const auto priors = root.Find("priors")) {
    for (const auto& [name, prior] : priors->Members()) {
      auto& of = config.priors[name];
      if (!prior.is_array()) {
        if (prior.String() != "none") prior.Fail("is neither [value, sigma] nor \"none\"");
        continue;
      }
      const std::vector<double> numbers = prior.Numbers();
      if (numbers.size() != 2 || !(numbers[1] > 0.0)) prior.Fail("is not [value, sigma] with sigma > 0");
      of = {numbers[0], numbers[1]};
    }
  }
  if (const auto prior = root.Find("pose_prior")) {
    const auto read = [&](const char* key, double& sigma) {
      const auto value = prior->Find(key);
      if (!value) return;
      sigma = value->Number();
      if (!(sigma > 0.0)) value->Fail("is not above 0");
    };
    read("position_m", config.pose_prior.position_m);
    read("angle_deg", config.pose_prior.angle_deg);
  }
  if (const auto start = root.Find("start")) {
    for (const auto& [name, value] : start->Members()) config.start[name] = value.Number();
  }
  const auto read_frames = [&](const char* key) {
    std::vector<int> frames;
    for (const data_io::JsonReader& item : root.At(key).Items())
      frames.push_back(static_cast<int>(item.Integer(0, std::numeric_limits<int>::max())));
    return frames;
  };
  if (root.Find("held_out")) config.held_out = read_frames("held_out");
  if (root.Find("used")) config.used = read_frames("used");
  return config;
}

nlohmann::ordered_json FitConfigJson(const FitConfig& config) {
  using Json = nlohmann::ordered_json;
  Json json = {{"format", "sonar-fit-config/1"}};
  if (config.free) json["free"] = *config.free;
  json["fixed"] = config.fixed;
  json["bounds"] = Json::object();
  for (const auto& [name, limits] : config.bounds) json["bounds"][name] = {limits.first, limits.second};
  json["priors"] = Json::object();
  for (const auto& [name, prior] : config.priors)
    json["priors"][name] = prior ? Json::array({prior->first, prior->second}) : Json("none");
  json["pose_prior"] = {{"position_m", config.pose_prior.position_m},
                        {"angle_deg", config.pose_prior.angle_deg}};
  json["start"] = Json::object();
  for (const auto& [name, value] : config.start) json["start"][name] = value;
  if (config.held_out) json["held_out"] = *config.held_out;
  if (config.used) json["used"] = *config.used;
  return json;
}

namespace {

// Names of the parts of the scene in "GROUP:NODE" and "group.NODE.*".
std::vector<std::string> PartsNamed(const FitConfig& config, std::string_view group_prefix,
                                    std::string_view name_prefix) {
  std::vector<std::string> names;
  const auto add = [&](const std::string& name) {
    if (!name.empty() && std::ranges::find(names, name) == names.end()) names.push_back(name);
  };
  for (const std::string& pattern : config.free.value_or(std::vector<std::string>())) {
    if (pattern.starts_with(group_prefix)) add(pattern.substr(group_prefix.size()));
    if (pattern.starts_with(name_prefix)) add(ObjectOf(pattern));
  }
  return names;
}

}  // namespace

std::vector<std::string> ObjectsNamed(const FitConfig& config) {
  return PartsNamed(config, kObjectPrefix, "object.");
}

std::vector<std::string> OutlinesNamed(const FitConfig& config) {
  return PartsNamed(config, kOutlinePrefix, "outline.");
}

FitConfig WithOutlineNamed(FitConfig config, const Scene& scene) {
  if (!config.free) return config;
  for (std::string& pattern : *config.free) {
    if (pattern != "outline") continue;
    std::vector<std::string> names;
    for (const SceneObject& object : scene.objects) names.push_back(object.name);
    if (names.size() != 1 && scene.material_names.size() == 1) names = scene.material_names;
    if (names.size() != 1) {
      names.insert(names.end(), scene.material_names.begin(), scene.material_names.end());
      std::ranges::sort(names);
      names.erase(std::unique(names.begin(), names.end()), names.end());
      throw DataError(
          "'outline' without a name needs a scene of one part, expected outline:NODE with one of {}",
          fmt::join(names, ", "));
    }
    pattern = fmt::format("{}{}", kOutlinePrefix, names.front());
  }
  return config;
}

FitConfig ReadFitConfig(const std::filesystem::path& path) {
  const auto root = data_io::JsonReader::FromFile(path);
  FitConfig config = FitConfigFrom(root);
  root.Finish();
  return config;
}

FitConfig ParseFitConfig(std::string_view text, const std::string& name) {
  const auto root = data_io::JsonReader::FromText(text, name);
  FitConfig config = FitConfigFrom(root);
  root.Finish();
  return config;
}

std::vector<bool> ApplyFitConfig(const FitConfig& config, std::vector<CatalogEntry>& catalog) {
  std::vector<bool> free(catalog.size(), false);
  SONARCAL_CHECK(config.free.has_value(), "no free parameters are given");
  for (const std::string& pattern : *config.free) {
    ForMatches(pattern, catalog, [&](std::size_t i) { free[i] = true; });
  }
  for (const std::string& pattern : config.fixed) {
    ForMatches(pattern, catalog, [&](std::size_t i) { free[i] = false; });
  }
  ForClosest(config.bounds, "bounds", catalog, [&](std::size_t i, const std::pair<double, double>& range) {
    CatalogEntry& entry = catalog[i];
    if (entry.logarithmic && !(range.first > 0.0)) {
      throw DataError("fit: lower bound {} of {}, expected a positive one", range.first, entry.name);
    }
    if (range.first < entry.file_lower || range.second > entry.file_upper) {
      throw DataError("fit: bounds {} .. {} of {}, expected them within {} .. {}, the limits of params.json",
                      range.first, range.second, entry.name, entry.file_lower, entry.file_upper);
    }
    entry.lower = range.first;
    entry.upper = range.second;
  });
  for (CatalogEntry& entry : catalog) {
    if (entry.group == ParameterGroup::kPose)
      entry.typical_step = entry.index < 3 ? config.pose_prior.position_m : config.pose_prior.angle_deg;
    const auto region = config.trust_regions.find(entry.name);
    if (region == config.trust_regions.end()) continue;
    entry.trust_lower = region->second.first;
    entry.trust_upper = region->second.second;
  }
  ForClosest(config.priors, "priors", catalog, [&](std::size_t i, const auto& known) {
    CatalogEntry& entry = catalog[i];
    if (!known) {
      entry.prior = Prior{.coordinate = 0.0, .sigma = std::numeric_limits<double>::infinity()};
      return;
    }
    const auto [value, sigma] = *known;
    if (entry.logarithmic && !(value > 0.0)) {
      throw DataError("fit: prior value {} of {}, expected a positive one", value, entry.name);
    }
    // Converts the sigma of the value to one of its coordinate.
    entry.prior =
        Prior{.coordinate = entry.CoordinateFromValue(value), .sigma = sigma / entry.ValueSlope(value)};
  });
  return free;
}

void GivePriors(const ParameterValues& initial, const std::vector<bool>& free,
                const std::vector<CatalogEntry>& catalog, FitConfig& config) {
  for (std::size_t i = 0; i < catalog.size(); ++i) {
    const CatalogEntry& entry = catalog[i];
    if (!free[i] || entry.prior) continue;
    const double value = std::clamp(initial[i], entry.lower, entry.upper);
    config.priors[entry.name] = {value, entry.typical_step * entry.ValueSlope(value)};
  }
}

std::vector<bool> ApplyFitConfigWithPriors(const ParameterValues& initial, FitConfig& config,
                                           std::vector<CatalogEntry>& catalog) {
  std::vector<bool> free = ApplyFitConfig(config, catalog);
  GivePriors(initial, free, catalog, config);
  ApplyFitConfig(config, catalog);  // now including the priors
  return free;
}

void AddMaterialPriors(const std::string& material, const NamedMaterial& known,
                       const ParameterSet& parameters, double level_sigma_db, FitConfig& config) {
  const GsabParameters<double> centre = CentreFor(known, parameters);
  const std::map<std::string, std::optional<std::pair<double, double>>> given = config.priors;
  for (const CatalogEntry& entry : BuildCatalog({material})) {
    if (entry.group != ParameterGroup::kGsab ||
        std::ranges::any_of(given, [&](const auto& prior) { return Matches(prior.first, entry); }))
      continue;
    const double value = ParameterMember<const double>(centre, entry.key);
    const double spread = ParameterMember<const double>(known.spread, entry.key);
    double sigma = entry.logarithmic ? std::log(spread) : spread;  // of the coordinate
    if (IsAmplitude(entry)) sigma = std::hypot(sigma, std::log(PowerFromDb(level_sigma_db)));
    config.priors[entry.name] = {value, sigma * entry.ValueSlope(value)};
  }
}

ParameterValues StartValues(const FitConfig& config, const std::vector<CatalogEntry>& catalog,
                            ParameterValues initial) {
  for (const auto& [name, value] : config.start) {
    const auto entry = std::ranges::find(catalog, name, &CatalogEntry::name);
    if (entry == catalog.end()) throw DataError("fit: start value of '{}', which is no parameter", name);
    initial[static_cast<std::size_t>(entry - catalog.begin())] =
        std::clamp(value, entry->lower, entry->upper);
  }
  return initial;
}

namespace {

// Frames in ascending order, each once.
std::vector<int> Checked(std::vector<int> frames, int frame_count, const char* kind) {
  for (const int frame : frames) {
    if (frame >= 0 && frame < frame_count) continue;
    throw DataError("fit: {} frame {} of a recording of {} frames (0 .. {})", kind, frame, frame_count,
                    frame_count - 1);
  }
  std::ranges::sort(frames);
  frames.erase(std::unique(frames.begin(), frames.end()), frames.end());
  return frames;
}

}  // namespace

FrameSplit SplitFrames(const FitConfig& config, int frame_count) {
  std::vector<int> candidates(static_cast<std::size_t>(frame_count));
  std::iota(candidates.begin(), candidates.end(), 0);
  if (config.used) candidates = Checked(*config.used, frame_count, "used");
  FrameSplit split;
  if (config.held_out) {
    split.held_out = Checked(*config.held_out, frame_count, "held-out");
  } else if (candidates.size() >= 2) {
    const std::ptrdiff_t third = std::max<std::ptrdiff_t>(1, std::ssize(candidates) / 3);
    split.held_out.assign(candidates.end() - third, candidates.end());
  }
  std::ranges::set_difference(candidates, split.held_out, std::back_inserter(split.used));
  if (split.used.empty()) {
    throw DataError("fit: all {} {}frames are held out, none is left to fit", candidates.size(),
                    config.used ? "used " : "");
  }
  return split;
}

}  // namespace sonarcal::calib
