// The options by which compare, fit and reproduce say how the object is found and what is measured.
#pragma once

#include <filesystem>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "metrics/compare.h"

namespace CLI {
class App;
}

namespace sonarcal {

struct ComparisonOptions {
  SegmentationOptions segmentation;
  IntensityDomain intensity_domain = IntensityDomain::kUnion;
  std::filesystem::path region;    // PNG, range bins x beams: the object may be where it is not 0
  std::string region_range_m;      // "A:B"; empty for all ranges
  std::string region_azimuth_deg;  // "A:B"; empty for all azimuths

  // Throws UsageError for a wrong range, DataError where the picture does not fit the axes.
  CompareOptions For(const PolarAxes& axes) const;
};

// Adds --segmentation, --threshold, --sigma-count, --all-components, --intensity-domain, --region,
// --region-range and --region-azimuth.
void AddComparisonOptions(CLI::App& command, ComparisonOptions& options);

// As resolved, for provenance.
nlohmann::ordered_json ComparisonOptionsJson(const ComparisonOptions& options);

}  // namespace sonarcal
