#include "metrics/json/metrics_json.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/types/csv_text.h"
#include "data_io/json/json_writer.h"
#include "metrics/figures.h"
#include "metrics/json/report_json.h"
#include "metrics/json/segmentation_json.h"
#include "metrics/json/sweep_json.h"

namespace sonarcal::metrics {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array kDomains = {IntensityDomain::kUnion, IntensityDomain::kWhole, IntensityDomain::kOverlap};

// Node at a path such as "intensity.union.rmse" below a view.
Json& Place(Json& view, std::string_view path) {
  Json* node = &view;
  while (!path.empty()) {
    const std::size_t dot = std::min(path.find('.'), path.size());
    node = &(*node)[std::string(path.substr(0, dot))];
    path.remove_prefix(std::min(dot + 1, path.size()));
  }
  return *node;
}

void PutCounts(Json& json, const ViewMetrics& view) {
  json["ns"] = view.occupancy.ns;
  json["nr"] = view.occupancy.nr;
  json["na"] = view.occupancy.na;
}

bool IsShown(const Figure& figure, bool fan) {
  return !(fan && figure.polar_only);
}

// Adds every figure of a frame's view.
void PutFigures(Json& json, const ViewMetrics& view, bool fan) {
  for (const Figure& figure : Figures()) {
    if (IsShown(figure, fan)) Place(json, figure.path) = Nullable(figure.Of(view));
  }
  for (const IntensityDomain domain : kDomains) {
    json["intensity"][std::string(ToString(domain))]["pixels"] = view.intensity.Over(domain).pixels;
  }
}

Json FrameJson(const FrameMetrics& frame, IntensityDomain domain) {
  Json json;
  json["index"] = frame.index;
  json["name"] = frame.name;
  if (frame.time_s) json["time_s"] = *frame.time_s;
  PutCounts(json, frame.polar);
  json["intensity_error"] = {{"polar", Nullable(frame.polar.intensity.Over(domain).mean_absolute())},
                             {"fan", Nullable(frame.fan.intensity.Over(domain).mean_absolute())}};
  PutFigures(json, frame.polar, false);
  json["threshold"] = {{"real", frame.threshold_real}, {"simulated", frame.threshold_simulated}};
  if (const std::optional<PixelBox>& box = frame.object_box) {
    json["object_region"] = {{"range_bins", {box->bin_begin, box->bin_end}},
                             {"beams", {box->beam_begin, box->beam_end}}};
  }
  PutCounts(json["fan"], frame.fan);
  PutFigures(json["fan"], frame.fan, true);
  json["notes"] = frame.notes;
  return json;
}

// Adds "name", "name_ci", and "name_floor" if there is one.
void PutStatistic(Json& parent, const std::string& name, const Statistic& statistic, const Statistic* floor) {
  parent[name] = Nullable(statistic.value);
  parent[name + "_ci"] = statistic.ci ? Json::array({statistic.ci->lo, statistic.ci->hi}) : Json(nullptr);
  if (floor != nullptr) parent[name + "_floor"] = Nullable(floor->value);
}

void PutFigures(Json& json, const ViewSummary& view, const ViewSummary* floor, bool fan) {
  for (std::size_t f = 0; f < Figures().size(); ++f) {
    const Figure& figure = Figures()[f];
    if (!IsShown(figure, fan)) continue;
    const std::size_t dot = figure.path.rfind('.');
    const bool nested = dot != std::string::npos;
    Json& parent = nested ? Place(json, figure.path.substr(0, dot)) : json;
    PutStatistic(parent, nested ? figure.path.substr(dot + 1) : figure.path, view.statistics[f],
                 floor != nullptr && figure.better != Better::kNeither ? &floor->statistics[f] : nullptr);
  }
}

void PutSummary(Json& json, const Aggregate::Views& views, const Aggregate::Views* floor,
                IntensityDomain domain) {
  const auto put_error = [&](const char* name, const ViewSummary& view, const ViewSummary* of_floor) {
    const std::string path = IntensityErrorPath(domain);
    PutStatistic(json["intensity_error"], name, view.At(path),
                 of_floor != nullptr ? &of_floor->At(path) : nullptr);
  };
  put_error("polar", views.polar, floor != nullptr ? &floor->polar : nullptr);
  put_error("fan", views.fan, floor != nullptr ? &floor->fan : nullptr);
  PutFigures(json, views.polar, floor != nullptr ? &floor->polar : nullptr, false);
  PutFigures(json["fan"], views.fan, floor != nullptr ? &floor->fan : nullptr, true);
}

// Figures in fractions of full scale, multiplied by `factor`.
Json ScaledJson(const Aggregate::Views& views, double factor) {
  Json json;
  for (std::size_t f = 0; f < Figures().size(); ++f) {
    const Figure& figure = Figures()[f];
    if (figure.unit != FigureUnit::kFullScale) continue;
    const auto scaled = [&](const std::optional<double>& value) {
      return value ? Json(*value * factor) : Json(nullptr);
    };
    Place(json, figure.path) = scaled(views.polar.statistics[f].value);
    Place(json["fan"], figure.path) = scaled(views.fan.statistics[f].value);
  }
  return json;
}

void PutScaled(Json& json, const Aggregate::Views& views, const ImageScale& scale) {
  json["in_grey_levels"] = ScaledJson(views, scale.full_scale);
  if (const std::optional<double> span_db = DbSpan(scale)) json["in_db"] = ScaledJson(views, *span_db);
}

// Number of frames left out of the polar figures' means, by name. Omits figures that every frame defines.
Json FramesLeftOut(const ViewSummary& view, IntensityDomain domain) {
  Json json = Json::object();
  const auto put = [&](const std::string& name, const Statistic& statistic) {
    if (statistic.frames_left_out > 0) json[name] = statistic.frames_left_out;
  };
  for (std::size_t f = 0; f < Figures().size(); ++f) put(Figures()[f].path, view.statistics[f]);
  put("intensity_error", view.Over(domain).mean_absolute);
  return json;
}

Json MacroJson(const MetricsReport& report, const Aggregate* floor) {
  const IntensityDomain domain = report.options.intensity_domain;
  Json json;
  json["frames"] = report.aggregate.frame_count;
  PutSummary(json, report.aggregate.macro, floor != nullptr ? &floor->macro : nullptr, domain);
  PutScaled(json, report.aggregate.macro, report.scale);
  json["frames_left_out"] = FramesLeftOut(report.aggregate.macro.polar, domain);
  return json;
}

Json MicroJson(const MetricsReport& report, const Aggregate* floor) {
  Json json;
  json["frames"] = report.aggregate.frame_count;
  PutCounts(json, report.aggregate.pooled_polar);
  PutSummary(json, report.aggregate.micro, floor != nullptr ? &floor->micro : nullptr,
             report.options.intensity_domain);
  PutCounts(json["fan"], report.aggregate.pooled_fan);
  PutScaled(json, report.aggregate.micro, report.scale);
  return json;
}

Json SegmentationOf(const CompareOptions& options) {
  Json json = SegmentationJson(options.segmentation);
  json["applied_to"] = "the polar images; fan regions are scan-converted, nearest";
  json["region_of_interest_px"] = options.region ? Json(CountSet(*options.region)) : Json(nullptr);
  json["region_margin_m"] = Nullable(options.region_margin_m);
  json["simulated_object"] = std::string(ToString(options.simulated_object));
  if (options.simulated_object == SimulatedObject::kEchoes) json["echo_fraction"] = options.echo_fraction;
  if (options.object) {
    json["object_region"] = {{"source", "model"},
                             {"object", options.object->material},
                             {"margin_bins", options.object->margin.bins},
                             {"margin_beams", options.object->margin.beams}};
  }
  return json;
}

Json BlocksJson(const ViewSummary& view, bool fan) {
  Json json = Json::object();
  for (std::size_t f = 0; f < Figures().size(); ++f) {
    if (view.statistics[f].ci && IsShown(Figures()[f], fan)) {
      json[Figures()[f].path] = view.statistics[f].block_frames;
    }
  }
  return json;
}

Json IntervalJson(const Aggregate& aggregate) {
  Json json;
  json["level"] = 0.95;
  json["method"] =
      aggregate.in_time
          ? "percentile bootstrap over blocks of consecutive frames, circular (Politis & White 2004, 2009)"
          : "percentile bootstrap over frames, taken as independent";
  json["draws"] = kBootstrapDraws;
  json["seed"] = kBootstrapSeed;
  json["min_frames"] = kBootstrapMinFrames;
  if (aggregate.in_time) {
    json["block_frames"] = {{"polar", BlocksJson(aggregate.macro.polar, false)},
                            {"fan", BlocksJson(aggregate.macro.fan, true)}};
  }
  json["absent_because"] =
      aggregate.no_interval_reason.empty() ? Json(nullptr) : Json(aggregate.no_interval_reason);
  return json;
}

Json NoiseFloorJson(const NoiseFloor& floor, IntensityDomain domain) {
  Json json;
  json["beside_figures"] = std::string(ToString(floor.source()));
  if (floor.speckle) {
    json["speckle"] = {{"span_db", floor.speckle->span_db},
                       {"speckled_simulation_db", SingleLookPairDifferenceDb()},
                       {"speckled_simulation", floor.speckle->speckled_simulation},
                       {"smooth_simulation_db", SingleLookMeanDifferenceDb()},
                       {"smooth_simulation", floor.speckle->smooth_simulation}};
  } else {
    json["speckle"] = {{"absent_because", "the real recording does not state its dB scale"}};
  }
  const RealAgainstReal& real = floor.real_against_real;
  Json& measured = json["real_against_real"];
  measured["pairs"] = real.pairs.size();
  if (real.pairs.empty()) {
    measured["absent_because"] = real.absent_reason;
  } else {
    PutSummary(measured, real.aggregate.macro, nullptr, domain);
  }
  measured["notes"] = real.notes;
  if (floor.drawn) {
    Json& drawn = json["drawn"];
    drawn["law"] = floor.drawn->law;
    drawn["frames"] = floor.drawn->aggregate.frame_count;
    PutSummary(drawn, floor.drawn->aggregate.macro, nullptr, domain);
  }
  return json;
}

// metrics.json without the frames.
Json SummaryJson(const MetricsReport& report) {
  const IntensityDomain domain = report.options.intensity_domain;
  const Aggregate* floor = report.noise_floor.Beside();
  Json json;
  json["format"] = "sonar-metrics/1";
  json["real"] = report.real;
  json["simulated"] = report.simulated;
  json["macro"] = MacroJson(report, floor);
  json["micro"] = MicroJson(report, floor);
  json["ci"] = IntervalJson(report.aggregate);
  json["segmentation"] = SegmentationOf(report.options);
  json["threshold_sweep"] =
      report.sweep ? SweepJson(*report.sweep, report.options.segmentation.method) : Json(nullptr);
  json["display"] = {{"full_scale", report.scale.full_scale}, {"span_db", Nullable(DbSpan(report.scale))}};
  json["intensity_error_definition"] = fmt::format(
      "mean of |simulated - real| / full scale over the {}",
      domain == IntensityDomain::kWhole ? "whole image"
                                        : fmt::format("{} of the two object regions", ToString(domain)));
  json["noise_floor"] = NoiseFloorJson(report.noise_floor, domain);
  json["residuals"] = ResidualsJson(report.residuals, report.residuals_by_scene);
  if (report.against) json["against"] = AgainstJson(*report.against);
  json["notes"] = report.notes;
  return json;
}

std::string Indented(std::string_view text, std::string_view margin) {
  std::string indented;
  for (const char character : text) {
    indented += character;
    if (character == '\n') indented += margin;
  }
  return indented;
}

}  // namespace

std::string MetricsSummaryJson(const MetricsReport& report) {
  return data_io::JsonText(SummaryJson(report));
}

std::string FrameMetricsJson(const FrameMetrics& frame, IntensityDomain domain) {
  return FrameJson(frame, domain).dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string MetricsJson(const MetricsReport& report) {
  // Each frame's JSON is written and discarded: a document of all frames would need ten times the memory of
  // its text.
  std::string frames = "\"frames\": [";
  const std::string margin(4, ' ');
  bool first = true;
  for (const FrameMetrics& frame : report.frames) {
    std::string text = data_io::JsonText(FrameJson(frame, report.options.intensity_domain));
    text.pop_back();  // the newline
    frames += (first ? "\n" : ",\n") + margin + Indented(text, margin);
    first = false;
  }
  frames += first ? "],\n  " : "\n  ],\n  ";
  std::string text = MetricsSummaryJson(report);
  const std::size_t after = text.find("\"macro\": ");
  SONARCAL_CHECK(after != std::string::npos, "metrics.json without macro figures");
  text.insert(after, frames);
  return text;
}

std::string PerFrameCsv(const std::vector<FrameMetrics>& frames, IntensityDomain domain) {
  const auto is_nested = [](const Figure& figure) { return figure.path.find('.') != std::string::npos; };
  std::string csv = "index,name";
  // Figures whose name has no dot follow the counts; all others come at the end.
  const auto put_names = [&](bool nested, bool fan) {
    for (const Figure& figure : Figures()) {
      if (is_nested(figure) != nested || !IsShown(figure, fan)) continue;
      std::string name = figure.path;
      std::replace(name.begin(), name.end(), '.', '_');
      csv += fmt::format(",{}{}", fan ? "fan_" : "", name);
    }
  };
  for (const bool fan : {false, true}) {
    for (const char* count : {"ns", "nr", "na"}) csv += fmt::format(",{}{}", fan ? "fan_" : "", count);
    put_names(false, fan);
  }
  csv += ",intensity_error_polar,intensity_error_fan";
  for (const bool fan : {false, true}) put_names(true, fan);
  csv += '\n';

  const auto put = [&](const std::optional<double>& value) {
    csv += ',';
    if (value) csv += fmt::format("{}", *value);
  };
  const auto put_figures = [&](const ViewMetrics& view, bool nested, bool fan) {
    for (const Figure& figure : Figures()) {
      if (is_nested(figure) == nested && IsShown(figure, fan)) put(figure.Of(view));
    }
  };
  for (const FrameMetrics& frame : frames) {
    csv += fmt::format("{},{}", frame.index, CsvText(frame.name));
    for (const bool fan : {false, true}) {
      const ViewMetrics& view = fan ? frame.fan : frame.polar;
      csv += fmt::format(",{},{},{}", view.occupancy.ns, view.occupancy.nr, view.occupancy.na);
      put_figures(view, false, fan);
    }
    put(frame.polar.intensity.Over(domain).mean_absolute());
    put(frame.fan.intensity.Over(domain).mean_absolute());
    put_figures(frame.polar, true, false);
    put_figures(frame.fan, true, true);
    csv += '\n';
  }
  return csv;
}

}  // namespace sonarcal::metrics
