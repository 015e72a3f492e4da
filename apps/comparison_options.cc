#include "apps/comparison_options.h"

#include <fmt/format.h>

#include <charconv>
#include <string_view>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "apps/choice_option.h"
#include "data_io/image_io.h"
#include "data_io/printable.h"
#include "data_io/types/error.h"
#include "data_io/types/units.h"

namespace sonarcal {
namespace {

constexpr JsonWords<SegmentationMethod, 3> kMethods = {
    {{"background_sigma", SegmentationMethod::kBackgroundSigma},
     {"otsu", SegmentationMethod::kOtsu},
     {"fixed_threshold", SegmentationMethod::kFixedThreshold}}};
constexpr JsonWords<IntensityDomain, 3> kDomains = {{{"union", IntensityDomain::kUnion},
                                                     {"whole", IntensityDomain::kWhole},
                                                     {"overlap", IntensityDomain::kOverlap}}};

struct Interval1d {
  double low = 0.0;
  double high = 0.0;

  bool Contains(double value) const { return value >= low && value <= high; }
};

Interval1d ParseInterval(const std::string& option, const std::string& text) {
  const std::string_view view = text;
  const std::size_t colon = view.find(':');
  Interval1d interval;
  const auto parse = [](std::string_view part, double& value) {
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), value);
    return error == std::errc() && end == part.data() + part.size();
  };
  if (colon == std::string_view::npos || !parse(view.substr(0, colon), interval.low) ||
      !parse(view.substr(colon + 1), interval.high) || !(interval.low < interval.high)) {
    throw UsageError("{} '{}', expected A:B with two numbers, A below B", option, Printable(text));
  }
  return interval;
}

void KeepWithin(Mask& region, const PolarAxes& axes, const std::optional<Interval1d>& range_m,
                const std::optional<Interval1d>& azimuth_deg) {
  for (int bin = 0; bin < region.rows(); ++bin) {
    for (int beam = 0; beam < region.cols(); ++beam) {
      const bool kept = (!range_m || range_m->Contains(axes.range_centre_m(bin))) &&
                        (!azimuth_deg || azimuth_deg->Contains(DegFromRad(axes.beam_azimuth_rad[beam])));
      if (!kept) region(bin, beam) = 0;
    }
  }
}

Mask ReadRegion(const std::filesystem::path& file, const PolarAxes& axes) {
  const ImageFile image(file);
  if (image.header().rows != axes.range_bins || image.header().cols != axes.beam_count()) {
    throw DataError("{}: {} x {} pixels, expected {} range bins x {} beams", file.string(),
                    image.header().rows, image.header().cols, axes.range_bins, axes.beam_count());
  }
  const Grid<float> grey = image.DecodeGrey();
  Mask region(grey.rows(), grey.cols());
  for (std::size_t i = 0; i < grey.size(); ++i) region.values()[i] = grey.values()[i] > 0.0F ? 1 : 0;
  return region;
}

}  // namespace

CompareOptions ComparisonOptions::For(const PolarAxes& axes) const {
  CompareOptions compare;
  compare.segmentation = segmentation;
  compare.intensity_domain = intensity_domain;
  std::optional<Interval1d> range_m;
  std::optional<Interval1d> azimuth_deg;
  if (!region_range_m.empty()) range_m = ParseInterval("--region-range", region_range_m);
  if (!region_azimuth_deg.empty()) azimuth_deg = ParseInterval("--region-azimuth", region_azimuth_deg);
  if (!region.empty()) compare.region = ReadRegion(region, axes);
  if (range_m || azimuth_deg) {
    if (!compare.region) compare.region = Mask(axes.range_bins, axes.beam_count(), 1);
    KeepWithin(*compare.region, axes, range_m, azimuth_deg);
  }
  if (compare.region && CountSet(*compare.region) == 0) {
    throw DataError("the region of interest holds no pixel of the image");
  }
  compare.Check();
  return compare;
}

void AddComparisonOptions(CLI::App& command, ComparisonOptions& options) {
  AddChoice(command, "--segmentation", options.segmentation.method, kMethods,
            "How the object is told from background");
  command
      .add_option("--sigma-count", options.segmentation.sigma_count,
                  "background_sigma: standard deviations above the background's median")
      ->type_name("N");
  command
      .add_option("--threshold", options.segmentation.threshold_fraction,
                  "fixed_threshold: fraction of full scale")
      ->type_name("FRACTION");
  command.add_flag("--all-components{false}", options.segmentation.largest_component_only,
                   "Take every connected region as object, not the largest one alone");
  AddChoice(command, "--intensity-domain", options.intensity_domain, kDomains,
            "Pixels of the intensity error: union or overlap of the object regions, or the whole image");
  command
      .add_option("--region", options.region, "Where the object may be: PNG of range bins x beams, 0 for not")
      ->type_name("PNG");
  command.add_option("--region-range", options.region_range_m, "Ranges where the object may be, m")
      ->type_name("A:B");
  command
      .add_option("--region-azimuth", options.region_azimuth_deg, "Azimuths where the object may be, degrees")
      ->type_name("A:B");
}

nlohmann::ordered_json ComparisonOptionsJson(const ComparisonOptions& options) {
  const auto or_null = [](const std::string& text) {
    return text.empty() ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(text);
  };
  return {{"segmentation", ToString(options.segmentation.method)},
          {"sigma_count", options.segmentation.sigma_count},
          {"threshold", options.segmentation.threshold_fraction},
          {"largest_component_only", options.segmentation.largest_component_only},
          {"intensity_domain", ToString(options.intensity_domain)},
          {"region", or_null(options.region.string())},
          {"region_range_m", or_null(options.region_range_m)},
          {"region_azimuth_deg", or_null(options.region_azimuth_deg)}};
}

}  // namespace sonarcal
