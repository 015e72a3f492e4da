#include "apps/comparison_options.h"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "apps/choice_option.h"

namespace sonarcal {
namespace {

constexpr JsonWords<IntensityDomain, 3> kDomains = {{{"union", IntensityDomain::kUnion},
                                                     {"whole", IntensityDomain::kWhole},
                                                     {"overlap", IntensityDomain::kOverlap}}};

}  // namespace

CompareOptions ComparisonOptions::For(const PolarAxes& axes) const {
  CompareOptions compare;
  object.Apply(axes, compare);
  compare.intensity_domain = intensity_domain;
  compare.Check();
  return compare;
}

void AddComparisonOptions(CLI::App& command, ComparisonOptions& options) {
  AddSegmentationOptions(command, options.object);
  AddChoice(command, "--intensity-domain", options.intensity_domain, kDomains,
            "Pixels of the intensity error: union or overlap of the object regions, or the whole image");
}

nlohmann::ordered_json ComparisonOptionsJson(const ComparisonOptions& options) {
  nlohmann::ordered_json json = SegmentationOptionsJson(options.object);
  json["intensity_domain"] = ToString(options.intensity_domain);
  return json;
}

}  // namespace sonarcal
