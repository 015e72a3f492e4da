// The options by which compare, fit, explain and view say how the object is found: the method with its
// settings, the tidying, where the object may be, and where the simulated one is.
// metrics/segmentation/segmentation.h says what they do.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "metrics/compare.h"

namespace CLI {
class App;
}

namespace sonarcal {

struct SegmentationCommandOptions {
  SegmentationOptions rule;  // except method, sizes, which are text here, components and background_law
  // Absent: with `object` those of SegmentationInBox, else those of SegmentationOptions.
  std::optional<SegmentationMethod> method;
  std::optional<bool> all_components;
  std::string cell;  // "RxC": rows x columns; empty for the default, as the others
  std::string guard;
  std::string training;
  std::string blur;
  std::string opening;
  std::string closing;
  std::string max_size;
  std::filesystem::path background_params;  // params.json whose receiver and display are the background's law

  std::filesystem::path region;    // PNG, range bins x beams: the object may be where it is not 0
  std::string region_range_m;      // "A:B"; empty for all ranges
  std::string region_azimuth_deg;  // "A:B"; empty for all azimuths
  std::string
      region_polygon;  // "R:A,R:A,R:A,...": corners, range in m and azimuth in degrees; empty for none
  std::optional<double> region_margin_m;
  std::string object;         // material of the scene; empty: the object may be anywhere
  std::string object_margin;  // "RxC"; empty for that of ObjectMargin
  SimulatedObject simulated_object = SimulatedObject::kSameRule;
  double echo_fraction = 0.0;

  // Sets segmentation, region, object, region_margin_m, simulated_object and echo_fraction. Throws UsageError
  // for text that is not as it should be, DataError where a file does not fit the axes or no pixel is left.
  void Apply(const PolarAxes& axes, CompareOptions& compare) const;
};

void AddSegmentationOptions(CLI::App& command, SegmentationCommandOptions& options);

// Throws UsageError for options of other methods than the one chosen.
void RefuseUnusedSegmentation(const CLI::App& command, const SegmentationCommandOptions& options);

// As resolved, for provenance.
nlohmann::ordered_json SegmentationOptionsJson(const SegmentationCommandOptions& options);

struct Interval1d {
  double low = 0.0;
  double high = 0.0;

  bool Contains(double value) const { return value >= low && value <= high; }
};

// "A:B" with A below B; throws UsageError naming `option`.
Interval1d ParseInterval(const std::string& option, const std::string& text);

}  // namespace sonarcal
