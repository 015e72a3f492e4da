#include "apps/workflow/comparison_options.h"

#include <memory>

#include "core/types/error.h"
#include "core/types/units.h"
#include "metrics/segmentation/region.h"
#include "sim/physics/display.h"
#include "sim/physics/receiver.h"

namespace sonarcal::workflow {

namespace {

Mask InsideIntervals(const PolarAxes& axes, const std::optional<Interval>& range_m,
                     const std::optional<Interval>& azimuth_deg) {
  Mask region(axes.range_bins, axes.beam_count());
  for (int bin = 0; bin < region.rows(); ++bin) {
    for (int beam = 0; beam < region.cols(); ++beam) {
      const bool kept = (!range_m || range_m->Contains(axes.range_centre_m(bin))) &&
                        (!azimuth_deg || azimuth_deg->Contains(DegFromRad(axes.beam_azimuth_rad[beam])));
      region(bin, beam) = kept ? 1 : 0;
    }
  }
  return region;
}

// Nullopt if no option limits the region.
std::optional<Mask> RegionOf(const ComparisonOptions& options, const PolarAxes& axes) {
  std::optional<Mask> region = options.region.value;
  if (region && (region->rows() != axes.range_bins || region->cols() != axes.beam_count())) {
    throw DataError("{}: {} x {} pixels, expected {} range bins x {} beams",
                    options.region.file.empty() ? "region" : options.region.file.string(), region->rows(),
                    region->cols(), axes.range_bins, axes.beam_count());
  }
  if (options.region_range || options.region_azimuth) {
    region = Both(region, InsideIntervals(axes, options.region_range, options.region_azimuth));
  }
  if (!options.region_polygon.empty()) {
    if (options.region_polygon.size() < 3) {
      throw UsageError("--region-polygon has {} corners, expected 3 or more", options.region_polygon.size());
    }
    region = Both(region, metrics::InsidePolygon(options.region_polygon, axes));
  }
  if (region && CountSet(*region) == 0) throw DataError("the region of interest holds no pixel of the image");
  return region;
}

}  // namespace

metrics::SegmentationOptions ComparisonOptions::Rule() const {
  if (all_components && largest_component)
    throw UsageError("--all-components contradicts --largest-component");
  if (contrast_db && contrast != metrics::SegmentationOptions().contrast)
    throw UsageError("--contrast and --contrast-db are given together, expected one of them");
  const metrics::SegmentationOptions by_default =
      object.empty() ? metrics::SegmentationOptions() : metrics::SegmentationInBox();
  metrics::SegmentationOptions rule;
  rule.method = segmentation.value_or(by_default.method);
  rule.sigma_count = sigma_count;
  rule.threshold_fraction = threshold;
  rule.contrast = contrast;
  rule.contrast_db = contrast_db;
  rule.false_alarm_rate = false_alarm_rate;
  rule.cell_rows = cell.rows;
  rule.cell_cols = cell.cols;
  rule.guard_rows = guard.rows;
  rule.guard_cols = guard.cols;
  rule.training_rows = training.rows;
  rule.training_cols = training.cols;
  rule.looks = looks;
  rule.os_quantile = os_quantile;
  rule.cfar_domain = cfar_domain;
  rule.blur_rows = blur.rows;
  rule.blur_cols = blur.cols;
  rule.open_rows = opening.rows;
  rule.open_cols = opening.cols;
  rule.close_rows = closing.rows;
  rule.close_cols = closing.cols;
  rule.min_area_px = min_area;
  rule.max_rows = max_size.rows;
  rule.max_cols = max_size.cols;
  rule.largest_component_only = largest_component || (by_default.largest_component_only && !all_components);
  rule.fill = fill;
  return rule;
}

std::optional<metrics::ObjectSearch> ComparisonOptions::Search() const {
  if (object.empty()) return std::nullopt;
  if (object_margin.rows < 0 || object_margin.cols < 0) {
    throw UsageError("--object-margin '{}x{}', expected 0 or more range bins and beams", object_margin.rows,
                     object_margin.cols);
  }
  return metrics::ObjectSearch{.material = object,
                               .margin = {.bins = object_margin.rows, .beams = object_margin.cols}};
}

metrics::CompareOptions ComparisonOptions::For(const PolarAxes& axes) const {
  metrics::CompareOptions compare;
  compare.segmentation = Rule();
  if (background_params) {
    const std::string where =
        background_params.file.empty() ? "background_params" : background_params.file.string();
    compare.segmentation.background_law =
        std::make_shared<metrics::BackgroundLaw>(BackgroundLawOf(*background_params.value, axes, where));
  } else if (compare.segmentation.method == metrics::SegmentationMethod::kLikelihoodRatio) {
    throw UsageError(
        "--segmentation likelihood_ratio needs --background-params, which fit --noise-only writes");
  }
  compare.region = RegionOf(*this, axes);
  compare.object = Search();
  compare.region_margin_m = region_margin;
  compare.simulated_object = simulated_object;
  compare.echo_fraction = echo_level;
  compare.intensity_domain = intensity_domain;
  compare.Check();
  return compare;
}

metrics::BackgroundLaw BackgroundLawOf(const ParameterSet& parameters, const PolarAxes& axes,
                                       const std::string& where) {
  const ReceiverParameters& receiver = parameters.receiver;
  if (!receiver.noise_db && !receiver.noise_after_gain_db) {
    throw DataError("{}: receiver has no noise floor, expected the parameters that fit --noise-only writes",
                    where);
  }
  constexpr double kAbsorptionDbPerM = 0.0;
  metrics::BackgroundLaw law{Grid<float>(axes.range_bins, axes.beam_count()), receiver.looks, {}};
  try {
    const sim::ReceiverNoise noise(receiver, axes, kAbsorptionDbPerM);
    for (int bin = 0; bin < axes.range_bins; ++bin) {
      for (int beam = 0; beam < axes.beam_count(); ++beam) {
        law.mean_power(bin, beam) = static_cast<float>(noise.Power(bin, beam));
      }
    }
  } catch (const DataError& error) {
    throw DataError("{}: {}", where, error.what());
  }
  law.power_of_value = [display = parameters.display](double value) {
    return sim::PowerFromDisplay(display, value);
  };
  return law;
}

}  // namespace sonarcal::workflow
