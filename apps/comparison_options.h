// The options by which compare and fit say how the object is found and what is measured.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "apps/segmentation_options.h"
#include "metrics/compare.h"

namespace CLI {
class App;
}

namespace sonarcal {

struct ComparisonOptions {
  SegmentationCommandOptions object;
  IntensityDomain intensity_domain = IntensityDomain::kUnion;

  // Throws UsageError for wrong text, DataError where a file does not fit the axes.
  CompareOptions For(const PolarAxes& axes) const;
};

// Adds --intensity-domain and those of apps/segmentation_options.h.
void AddComparisonOptions(CLI::App& command, ComparisonOptions& options);

// As resolved, for provenance.
nlohmann::ordered_json ComparisonOptionsJson(const ComparisonOptions& options);

}  // namespace sonarcal
