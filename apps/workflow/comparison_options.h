// Options of every task that compares images: how the object is found and which pixels are measured.
//
// BackgroundLawOf converts the background law that `sonarcal fit --noise-only` writes into params.json to
// plain numbers for metrics/segmentation/likelihood_ratio.h.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/types/mask.h"
#include "core/types/option.h"
#include "core/types/option_text.h"
#include "core/types/parameters.h"
#include "metrics/compare.h"
#include "metrics/segmentation/background_law.h"
#include "metrics/segmentation/region.h"

namespace sonarcal {

template <>
struct OptionText<metrics::PolygonCorner> {
  static bool Parse(const std::string& text, metrics::PolygonCorner& value) {
    return internal::ParsePair(text, ':', value.range_m, value.azimuth_deg);
  }
  static std::string Format(const metrics::PolygonCorner& value) {
    return fmt::format("{}:{}", value.range_m, value.azimuth_deg);
  }
  static std::string Type(const OptionInfo&) { return "R:A"; }
  static constexpr const char* kExpected = "RANGE:AZIMUTH in m and degrees, such as 1.5:-4,1.5:4,2:0";
};

}  // namespace sonarcal

namespace sonarcal::workflow {

struct ComparisonOptions {
  // Absent: the rule of metrics::SegmentationInBox with `object`, else that of metrics::SegmentationOptions.
  std::optional<metrics::SegmentationMethod> segmentation = {};
  double sigma_count = metrics::SegmentationOptions().sigma_count;
  double threshold = metrics::SegmentationOptions().threshold_fraction;
  double contrast = metrics::SegmentationOptions().contrast;
  std::optional<double> contrast_db = {};
  double false_alarm_rate = metrics::SegmentationOptions().false_alarm_rate;
  GridSize<int> cell = {metrics::SegmentationOptions().cell_rows, metrics::SegmentationOptions().cell_cols};
  GridSize<int> guard = {metrics::SegmentationOptions().guard_rows,
                         metrics::SegmentationOptions().guard_cols};
  GridSize<int> training = {metrics::SegmentationOptions().training_rows,
                            metrics::SegmentationOptions().training_cols};
  double looks = metrics::SegmentationOptions().looks;
  double os_quantile = metrics::SegmentationOptions().os_quantile;
  metrics::CfarDomain cfar_domain = metrics::CfarDomain::kAuto;
  FromFile<ParameterSet> background_params = {};
  GridSize<double> blur = {metrics::SegmentationOptions().blur_rows,
                           metrics::SegmentationOptions().blur_cols};
  GridSize<int> opening = {metrics::SegmentationOptions().open_rows,
                           metrics::SegmentationOptions().open_cols};
  GridSize<int> closing = {metrics::SegmentationOptions().close_rows,
                           metrics::SegmentationOptions().close_cols};
  int min_area = metrics::SegmentationOptions().min_area_px;
  GridSize<int> max_size = {metrics::SegmentationOptions().max_rows, metrics::SegmentationOptions().max_cols};
  bool all_components = false;
  bool largest_component = false;
  metrics::RegionFill fill = metrics::SegmentationOptions().fill;

  std::string object = {};  // empty: the object may be anywhere
  GridSize<int> object_margin = {metrics::ObjectMargin().bins, metrics::ObjectMargin().beams};
  FromFile<Mask> region = {};
  std::optional<Interval> region_range = {};
  std::optional<Interval> region_azimuth = {};
  std::vector<metrics::PolygonCorner> region_polygon = {};
  std::optional<double> region_margin = {};
  metrics::SimulatedObject simulated_object = metrics::SimulatedObject::kSameRule;
  double echo_level = 0.0;
  metrics::IntensityDomain intensity_domain = metrics::IntensityDomain::kUnion;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor&& visit);

  // Segmentation rule with its settings, without background law.
  metrics::SegmentationOptions Rule() const;
  std::optional<metrics::ObjectSearch> Search() const;

  // Options for images with these axes. Throws UsageError for options that contradict each other, DataError
  // if the region or the background does not fit the axes or if no pixel remains.
  metrics::CompareOptions For(const PolarAxes& axes) const;
};

template <typename Self, typename Visitor>
void ComparisonOptions::Visit(Self& self, Visitor&& visit) {
  visit(OptionInfo{.name = "segmentation",
                   .help = "Method that separates object and background",
                   .by_default = "background_sigma; with object otsu"},
        self.segmentation);
  visit(
      OptionInfo{.name = "sigma_count",
                 .help = "background_sigma: threshold in standard deviations above the background's median"},
      self.sigma_count);
  visit(OptionInfo{.name = "threshold",
                   .help = "fixed_threshold: threshold as a fraction of full scale",
                   .type = "FRACTION"},
        self.threshold);
  visit(
      OptionInfo{
          .name = "contrast",
          .help = "local_contrast: min excess over the mean of the surrounding ring, fraction of full scale",
          .type = "FRACTION"},
      self.contrast);
  visit(OptionInfo{.name = "contrast_db",
                   .help = "local_contrast: min excess in dB, for recordings that state their dB scale",
                   .unit = "dB"},
        self.contrast_db);
  visit(
      OptionInfo{
          .name = "false_alarm_rate",
          .help = "ca_cfar, os_cfar, likelihood_ratio: probability that a background cell is called object",
          .type = "P"},
      self.false_alarm_rate);
  visit(
      OptionInfo{.name = "cell",
                 .help = "Methods with a false-alarm rate: range bins x beams that are averaged in one cell"},
      self.cell);
  visit(OptionInfo{.name = "guard",
                   .help = "local_contrast and CFAR: range bins x beams left out on each side of a cell"},
        self.guard);
  visit(
      OptionInfo{.name = "training",
                 .help = "local_contrast and CFAR: range bins x beams of background beyond the guard cells"},
      self.training);
  visit(OptionInfo{.name = "looks", .help = "CFAR: independent looks per pixel"}, self.looks);
  visit(OptionInfo{.name = "os_quantile", .help = "os_cfar: quantile of the training cells", .type = "Q"},
        self.os_quantile);
  visit(
      OptionInfo{.name = "cfar_domain",
                 .help = "CFAR: tests received power, or grey levels of a logarithm with unknown slope; auto "
                         "uses power if the recording states its dB scale"},
      self.cfar_domain);
  visit(
      OptionInfo{.name = "background_params",
                 .help = "likelihood_ratio: params.json written by fit --noise-only; CFAR: uses its display"},
      self.background_params);
  visit(
      OptionInfo{.name = "blur",
                 .help = "Standard deviation of the Gaussian blur before the threshold, range bins x beams; "
                         "0x0 for none"},
      self.blur);
  visit(OptionInfo{.name = "opening", .help = "Opening of the region, range bins x beams; 0x0 for none"},
        self.opening);
  visit(OptionInfo{.name = "closing", .help = "Closing of the region, range bins x beams; 0x0 for none"},
        self.closing);
  visit(OptionInfo{.name = "min_area", .help = "Drops connected regions with fewer pixels"}, self.min_area);
  visit(
      OptionInfo{.name = "max_size",
                 .help = "Drops connected regions that extend over more range bins or beams; 0 for no limit"},
      self.max_size);
  visit(OptionInfo{.name = "all_components",
                   .help = "Takes all connected regions as the object",
                   .by_default = "yes with object, else no"},
        self.all_components);
  visit(OptionInfo{.name = "largest_component",
                   .help = "Takes only the largest connected region as the object",
                   .by_default = "no with object, else yes"},
        self.largest_component);
  visit(OptionInfo{.name = "fill", .help = "Fills the holes of each region, or its convex hull"}, self.fill);
  visit(
      OptionInfo{.name = "object",
                 .help = "Material of the object, which is searched in a box around its echoes in the scene",
                 .by_default = "anywhere",
                 .type = "MATERIAL"},
      self.object);
  visit(OptionInfo{.name = "object_margin",
                   .help = "Margin of that box beyond the material, range bins x beams on each side"},
        self.object_margin);
  visit(OptionInfo{.name = "region",
                   .help = "Where the object may be: PNG of range bins x beams, 0 where it may not"},
        self.region);
  visit(OptionInfo{.name = "region_range", .help = "Ranges where the object may be, m", .unit = "m"},
        self.region_range);
  visit(
      OptionInfo{
          .name = "region_azimuth", .help = "Azimuths where the object may be, degrees", .unit = "deg"},
      self.region_azimuth);
  visit(OptionInfo{.name = "region_polygon",
                   .help = "Corners of a polygon where the object may be, range in m and azimuth in degrees"},
        self.region_polygon);
  visit(OptionInfo{.name = "region_margin",
                   .help = "Max distance of the real object from the simulated one",
                   .unit = "m"},
        self.region_margin);
  visit(OptionInfo{.name = "simulated_object",
                   .help = "Simulated object: found by the rule for the real one, or all simulated echoes"},
        self.simulated_object);
  visit(OptionInfo{.name = "echo_level",
                   .help = "echoes: a pixel above this fraction of full scale is an echo",
                   .type = "FRACTION"},
        self.echo_level);
  visit(
      OptionInfo{
          .name = "intensity_domain",
          .help = "Pixels of the intensity error: union or overlap of the object regions, or whole image"},
      self.intensity_domain);
}

// Returns the noise floor of every pixel in the unit of the display, without absorption, as the noise fit
// uses it. Throws DataError, beginning with `where`, if the parameters have no noise floor or have tapers for
// another number of beams.
metrics::BackgroundLaw BackgroundLawOf(const ParameterSet& parameters, const PolarAxes& axes,
                                       const std::string& where);

}  // namespace sonarcal::workflow
