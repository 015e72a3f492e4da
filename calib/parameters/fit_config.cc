#include "calib/parameters/fit_config.h"

#include <fnmatch.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/types/error.h"
#include "data_io/json/json_reader.h"

namespace sonarcal::calib {
namespace {

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
  std::string names;
  for (const CatalogEntry& entry : catalog) names += (names.empty() ? "" : ", ") + entry.name;
  throw DataError(
      "fit: no parameter is called '{}'; expected a group (materials, noise, psf, mirrors, pose, mount, "
      "display, "
      "jitter, source_level), or a name or pattern among {}",
      pattern, names);
}

// How closely a pattern that matches the entry names it: the name itself most, then a pattern by its characters
// that are no wildcards, then a group, then a pattern of wildcards alone.
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
          "them, "
          "or the name itself",
          *closest[i].pattern, *closest[i].contradicts, what, catalog[i].name);
    }
    if (closest[i].pattern) act(i, *closest[i].value);
  }
}

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
  if (const auto held_out = root.Find("held_out")) {
    config.held_out.emplace();
    for (const data_io::JsonReader& item : held_out->Items()) {
      config.held_out->push_back(static_cast<int>(item.Integer(0, std::numeric_limits<int>::max())));
    }
  }
  root.Finish();
  return config;
}

}  // namespace

FitConfig ReadFitConfig(const std::filesystem::path& path) {
  return FitConfigFrom(data_io::JsonReader::FromFile(path));
}

FitConfig ParseFitConfig(std::string_view text, const std::string& name) {
  return FitConfigFrom(data_io::JsonReader::FromText(text, name));
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

FrameSplit SplitFrames(const FitConfig& config, int frame_count) {
  FrameSplit split;
  if (config.held_out) {
    for (const int frame : *config.held_out) {
      if (frame < 0 || frame >= frame_count) {
        throw DataError("fit: held-out frame {} of a recording of {} frames (0 .. {})", frame, frame_count,
                        frame_count - 1);
      }
      split.held_out.push_back(frame);
    }
    std::sort(split.held_out.begin(), split.held_out.end());
    split.held_out.erase(std::unique(split.held_out.begin(), split.held_out.end()), split.held_out.end());
  } else if (frame_count >= 2) {
    for (int frame = frame_count - std::max(1, frame_count / 3); frame < frame_count; ++frame) {
      split.held_out.push_back(frame);
    }
  }
  for (int frame = 0; frame < frame_count; ++frame) {
    if (!std::binary_search(split.held_out.begin(), split.held_out.end(), frame)) split.used.push_back(frame);
  }
  if (split.used.empty())
    throw DataError("fit: all {} frames are held out, none is left to fit", frame_count);
  return split;
}

}  // namespace sonarcal::calib
