#include "apps/segmentation_options.h"

#include <fmt/format.h>

#include <charconv>
#include <memory>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "apps/background_law_of.h"
#include "apps/choice_option.h"
#include "apps/given_options.h"
#include "core/types/error.h"
#include "core/types/printable.h"
#include "core/types/units.h"
#include "data_io/images/image_io.h"
#include "data_io/parameters/parameters_io.h"
#include "metrics/json/segmentation_json.h"

namespace sonarcal {
namespace {

constexpr JsonWords<SegmentationMethod, kSegmentationMethods> kMethods = {
    {{"background_sigma", SegmentationMethod::kBackgroundSigma},
     {"otsu", SegmentationMethod::kOtsu},
     {"fixed_threshold", SegmentationMethod::kFixedThreshold},
     {"triangle", SegmentationMethod::kTriangle},
     {"local_contrast", SegmentationMethod::kLocalContrast},
     {"ca_cfar", SegmentationMethod::kCaCfar},
     {"os_cfar", SegmentationMethod::kOsCfar},
     {"likelihood_ratio", SegmentationMethod::kLikelihoodRatio}}};
constexpr JsonWords<CfarDomain, 3> kDomains = {
    {{"auto", CfarDomain::kAuto}, {"power", CfarDomain::kPower}, {"grey", CfarDomain::kGrey}}};
constexpr JsonWords<RegionFill, 3> kFills = {
    {{"none", RegionFill::kNone}, {"holes", RegionFill::kHoles}, {"hull", RegionFill::kHull}}};
constexpr JsonWords<SimulatedObject, 2> kSimulatedObjects = {
    {{"same_rule", SimulatedObject::kSameRule}, {"echoes", SimulatedObject::kEchoes}}};

template <typename T>
bool ParseNumber(std::string_view text, T& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

// "RxC" into two numbers; an empty text leaves them as they are. Limits are the options' own.
template <typename T>
void TakeSize(const std::string& option, const std::string& text, T& rows, T& cols) {
  if (text.empty()) return;
  const std::string_view view = text;
  const std::size_t x = view.find('x');
  if (x == std::string_view::npos || !ParseNumber(view.substr(0, x), rows) ||
      !ParseNumber(view.substr(x + 1), cols)) {
    throw UsageError("{} '{}', expected rows x columns, such as 7x3", option, Printable(text));
  }
}

std::vector<PolygonCorner> ParsePolygon(const std::string& text) {
  std::vector<PolygonCorner> corners;
  std::string_view rest = text;
  while (!rest.empty()) {
    const std::size_t comma = std::min(rest.find(','), rest.size());
    const std::string_view corner = rest.substr(0, comma);
    const std::size_t colon = corner.find(':');
    PolygonCorner parsed;
    if (colon == std::string_view::npos || !ParseNumber(corner.substr(0, colon), parsed.range_m) ||
        !ParseNumber(corner.substr(colon + 1), parsed.azimuth_deg)) {
      corners.clear();
      break;
    }
    corners.push_back(parsed);
    rest.remove_prefix(std::min(comma + 1, rest.size()));
  }
  if (corners.size() < 3) {
    throw UsageError(
        "--region-polygon '{}', expected three corners or more, RANGE:AZIMUTH in m and degrees, such as "
        "1.5:-4,1.5:4,2:0",
        Printable(text));
  }
  return corners;
}

Mask IntervalRegion(const PolarAxes& axes, const std::optional<Interval1d>& range_m,
                    const std::optional<Interval1d>& azimuth_deg) {
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

// Absent where no option limits it.
std::optional<Mask> RegionOf(const SegmentationCommandOptions& options, const PolarAxes& axes) {
  std::optional<Interval1d> range_m;
  std::optional<Interval1d> azimuth_deg;
  if (!options.region_range_m.empty()) range_m = ParseInterval("--region-range", options.region_range_m);
  if (!options.region_azimuth_deg.empty()) {
    azimuth_deg = ParseInterval("--region-azimuth", options.region_azimuth_deg);
  }
  std::optional<Mask> region;
  if (!options.region.empty()) region = ReadRegion(options.region, axes);
  if (range_m || azimuth_deg) region = Both(region, IntervalRegion(axes, range_m, azimuth_deg));
  if (!options.region_polygon.empty()) {
    region = Both(region, InsidePolygon(ParsePolygon(options.region_polygon), axes));
  }
  if (region && CountSet(*region) == 0) throw DataError("the region of interest holds no pixel of the image");
  return region;
}

SegmentationOptions RuleOf(const SegmentationCommandOptions& options) {
  SegmentationOptions rule = options.rule;
  const SegmentationOptions by_default = options.object.empty() ? SegmentationOptions() : SegmentationInBox();
  rule.method = options.method.value_or(by_default.method);
  rule.largest_component_only =
      options.all_components ? !*options.all_components : by_default.largest_component_only;
  TakeSize("--cell", options.cell, rule.cell_rows, rule.cell_cols);
  TakeSize("--guard", options.guard, rule.guard_rows, rule.guard_cols);
  TakeSize("--training", options.training, rule.training_rows, rule.training_cols);
  TakeSize("--blur", options.blur, rule.blur_rows, rule.blur_cols);
  TakeSize("--opening", options.opening, rule.open_rows, rule.open_cols);
  TakeSize("--closing", options.closing, rule.close_rows, rule.close_cols);
  TakeSize("--max-size", options.max_size, rule.max_rows, rule.max_cols);
  return rule;
}

std::optional<ObjectSearch> SearchOf(const SegmentationCommandOptions& options) {
  ObjectSearch search{.material = options.object};
  TakeSize("--object-margin", options.object_margin, search.margin.bins, search.margin.beams);
  if (search.margin.bins < 0 || search.margin.beams < 0) {
    throw UsageError("--object-margin '{}', expected 0 or more range bins and beams", options.object_margin);
  }
  if (!search.material.empty()) return search;
  if (!options.object_margin.empty()) throw UsageError("--object-margin needs --object");
  return std::nullopt;
}

void AddMethodOptions(CLI::App& command, SegmentationCommandOptions& options) {
  SegmentationOptions& rule = options.rule;
  AddChoice(command, "--segmentation", options.method, kMethods,
            fmt::format("How the object is told from background (default: {}; with --object {})",
                        JsonWord(kMethods, SegmentationOptions().method),
                        JsonWord(kMethods, SegmentationInBox().method)));
  command
      .add_option("--sigma-count", rule.sigma_count,
                  "background_sigma: standard deviations above the background's median")
      ->type_name("N");
  command.add_option("--threshold", rule.threshold_fraction, "fixed_threshold: fraction of full scale")
      ->type_name("FRACTION");
  command
      .add_option("--contrast", rule.contrast,
                  "local_contrast: above the mean of the ring around, fraction of full scale")
      ->type_name("FRACTION");
  command
      .add_option("--contrast-db", rule.contrast_db,
                  "local_contrast: the same in dB, of recordings that state their dB scale")
      ->type_name("DB");
  command
      .add_option("--false-alarm-rate", rule.false_alarm_rate,
                  "ca_cfar, os_cfar, likelihood_ratio: chance that a cell of background is called object")
      ->type_name("P");
  const auto add_size = [&](const char* name, std::string& text, const std::string& description) {
    command.add_option(name, text, description)->type_name("RxC");
  };
  const auto size = [](double rows, double cols) { return fmt::format(" (default: {:g}x{:g})", rows, cols); };
  add_size(
      "--cell", options.cell,
      "Methods with a rate: range bins x beams averaged in a cell" + size(rule.cell_rows, rule.cell_cols));
  add_size("--guard", options.guard,
           "local_contrast and CFAR: range bins x beams left out on each side of a cell" +
               size(rule.guard_rows, rule.guard_cols));
  add_size("--training", options.training,
           "local_contrast and CFAR: range bins x beams beyond these to compare with" +
               size(rule.training_rows, rule.training_cols));
  command.add_option("--looks", rule.looks, "CFAR: independent looks in a pixel")->type_name("N");
  command.add_option("--os-quantile", rule.os_quantile, "os_cfar: of the training cells")->type_name("Q");
  AddChoice(command, "--cfar-domain", rule.cfar_domain, kDomains,
            "CFAR: test received power, or grey levels as those of a logarithm of unknown slope; auto: power "
            "where the recording states its dB scale");
  command
      .add_option("--background-params", options.background_params,
                  "likelihood_ratio: params.json that fit --noise-only wrote; CFAR: takes its display")
      ->type_name("JSON");
  add_size("--blur", options.blur,
           "Methods without a rate: Gaussian smoothing, standard deviation in range bins x beams" +
               size(rule.blur_rows, rule.blur_cols));
}

void AddTidyingOptions(CLI::App& command, SegmentationCommandOptions& options) {
  SegmentationOptions& rule = options.rule;
  const auto add_size = [&](const char* name, std::string& text, const char* description, int rows,
                            int cols) {
    command.add_option(name, text, fmt::format("{} (default: {}x{})", description, rows, cols))
        ->type_name("RxC");
  };
  add_size("--opening", options.opening, "Opening of the region, range bins x beams; 0x0 for none",
           rule.open_rows, rule.open_cols);
  add_size("--closing", options.closing, "Closing of the region, range bins x beams; 0x0 for none",
           rule.close_rows, rule.close_cols);
  command.add_option("--min-area", rule.min_area_px, "Drop connected regions of fewer pixels")
      ->type_name("N");
  add_size("--max-size", options.max_size,
           "Drop connected regions that reach over more range bins or beams; 0 for any", rule.max_rows,
           rule.max_cols);
  CLI::Option* all = command.add_flag_callback(
      "--all-components", [&options] { options.all_components = true; },
      "Take every connected region as object (default: with --object)");
  command
      .add_flag_callback(
          "--largest-component", [&options] { options.all_components = false; },
          "Take the largest connected region alone as object (default: without --object)")
      ->excludes(all);
  AddChoice(command, "--fill", rule.fill, kFills, "Fill the holes of each region, or its convex hull");
}

void AddRegionOptions(CLI::App& command, SegmentationCommandOptions& options) {
  command
      .add_option("--object", options.object,
                  "Material of the object: it is searched in a box around what the scene shows of it "
                  "(default: anywhere)")
      ->type_name("MATERIAL");
  command
      .add_option("--object-margin", options.object_margin,
                  fmt::format("Width of that box beyond the material, range bins x beams on each side "
                              "(default: {}x{})",
                              ObjectMargin().bins, ObjectMargin().beams))
      ->type_name("RxC");
  command
      .add_option("--region", options.region, "Where the object may be: PNG of range bins x beams, 0 for not")
      ->type_name("PNG");
  command.add_option("--region-range", options.region_range_m, "Ranges where the object may be, m")
      ->type_name("A:B");
  command
      .add_option("--region-azimuth", options.region_azimuth_deg, "Azimuths where the object may be, degrees")
      ->type_name("A:B");
  command
      .add_option("--region-polygon", options.region_polygon,
                  "Corners of a polygon where the object may be, range in m and azimuth in degrees")
      ->type_name("R:A,...");
  command
      .add_option("--region-margin", options.region_margin_m,
                  "Look for the real object no further than this from the simulated one, m")
      ->type_name("M");
  AddChoice(
      command, "--simulated-object", options.simulated_object, kSimulatedObjects,
      "Where the simulated object is: by the real one's rule, or wherever the simulation shows an echo");
  command
      .add_option("--echo-level", options.echo_fraction,
                  "echoes: what counts as one is shown above this fraction of full scale")
      ->type_name("FRACTION");
}

}  // namespace

Interval1d ParseInterval(const std::string& option, const std::string& text) {
  const std::string_view view = text;
  const std::size_t colon = view.find(':');
  Interval1d interval;
  if (colon == std::string_view::npos || !ParseNumber(view.substr(0, colon), interval.low) ||
      !ParseNumber(view.substr(colon + 1), interval.high) || !(interval.low < interval.high)) {
    throw UsageError("{} '{}', expected A:B with two numbers, A below B", option, Printable(text));
  }
  return interval;
}

void SegmentationCommandOptions::Apply(const PolarAxes& axes, CompareOptions& compare) const {
  compare.segmentation = RuleOf(*this);
  if (!background_params.empty()) {
    compare.segmentation.background_law = std::make_shared<BackgroundLaw>(
        BackgroundLawOf(ReadParameters(background_params), axes, background_params.string()));
  } else if (compare.segmentation.method == SegmentationMethod::kLikelihoodRatio) {
    throw UsageError(
        "--segmentation likelihood_ratio needs --background-params, which fit --noise-only writes");
  }
  compare.region = RegionOf(*this, axes);
  compare.object = SearchOf(*this);
  compare.region_margin_m = region_margin_m;
  compare.simulated_object = simulated_object;
  compare.echo_fraction = echo_fraction;
}

void AddSegmentationOptions(CLI::App& command, SegmentationCommandOptions& options) {
  AddMethodOptions(command, options);
  AddTidyingOptions(command, options);
  AddRegionOptions(command, options);
}

void RefuseUnusedSegmentation(const CLI::App& command, const SegmentationCommandOptions& options) {
  using Method = SegmentationMethod;
  const Method method = RuleOf(options).method;
  const bool is_cfar = method == Method::kCaCfar || method == Method::kOsCfar;
  const bool has_rate = is_cfar || method == Method::kLikelihoodRatio;
  const bool has_ring = is_cfar || method == Method::kLocalContrast;
  const std::string why = fmt::format("with --segmentation {}", JsonWord(kMethods, method));
  const auto refuse_unless = [&](bool is_used, const OptionNames& names) {
    if (!is_used) RefuseGiven(command, names, why);
  };
  refuse_unless(method == Method::kBackgroundSigma, {"--sigma-count"});
  refuse_unless(method == Method::kFixedThreshold, {"--threshold"});
  refuse_unless(method == Method::kLocalContrast, {"--contrast", "--contrast-db"});
  refuse_unless(has_rate, {"--false-alarm-rate", "--cell", "--background-params"});
  refuse_unless(has_ring, {"--guard", "--training"});
  refuse_unless(is_cfar, {"--looks", "--cfar-domain"});
  refuse_unless(method == Method::kOsCfar, {"--os-quantile"});
  refuse_unless(!has_rate, {"--blur"});
  if (options.simulated_object != SimulatedObject::kEchoes)
    RefuseGiven(command, {"--echo-level"}, "without --simulated-object echoes");
}

nlohmann::ordered_json SegmentationOptionsJson(const SegmentationCommandOptions& options) {
  using Json = nlohmann::ordered_json;
  const auto or_null = [](const std::string& text) { return text.empty() ? Json(nullptr) : Json(text); };
  const Json rule = SegmentationJson(RuleOf(options));
  const std::optional<ObjectSearch> object = SearchOf(options);
  return {{"segmentation", rule["method"]},
          {"segmentation_parameters", rule["parameters"]},
          {"background_params", or_null(options.background_params.string())},
          {"region", or_null(options.region.string())},
          {"region_range_m", or_null(options.region_range_m)},
          {"region_azimuth_deg", or_null(options.region_azimuth_deg)},
          {"region_polygon", or_null(options.region_polygon)},
          {"region_margin_m", options.region_margin_m ? Json(*options.region_margin_m) : Json(nullptr)},
          {"object", or_null(options.object)},
          {"object_margin", object ? Json{object->margin.bins, object->margin.beams} : Json(nullptr)},
          {"simulated_object", ToString(options.simulated_object)},
          {"echo_level", options.echo_fraction}};
}

}  // namespace sonarcal
