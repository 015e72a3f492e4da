#include "metrics/metrics_json.h"

#include <array>
#include <optional>
#include <utility>

#include <nlohmann/json.hpp>

#include "data_io/json_writer.h"
#include "metrics/segmentation_json.h"

namespace sonarcal {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array kDomains = {IntensityDomain::kUnion, IntensityDomain::kWhole, IntensityDomain::kOverlap};

struct NamedRatio {
  const char* name;
  std::optional<double> (Occupancy::*of)() const;
  Statistic ViewSummary::*in;
};

constexpr std::array kRatios = {
    NamedRatio{"ns_over_nr", &Occupancy::ns_over_nr, &ViewSummary::ns_over_nr},
    NamedRatio{"na_over_ns", &Occupancy::na_over_ns, &ViewSummary::na_over_ns},
    NamedRatio{"na_over_nr", &Occupancy::na_over_nr, &ViewSummary::na_over_nr},
    NamedRatio{"iou", &Occupancy::iou, &ViewSummary::iou},
};

struct NamedDifference {
  const char* name;
  std::optional<double> (DifferenceSums::*of)() const;
  Statistic DifferenceSummary::*in;
};

constexpr std::array kDifferences = {
    NamedDifference{"mean_absolute", &DifferenceSums::mean_absolute, &DifferenceSummary::mean_absolute},
    NamedDifference{"rmse", &DifferenceSums::rmse, &DifferenceSummary::rmse},
    NamedDifference{"bias", &DifferenceSums::bias, &DifferenceSummary::bias},
};

Json Nullable(const std::optional<double>& value) {
  return value ? Json(*value) : Json(nullptr);
}

void PutCounts(Json& json, const Occupancy& occupancy) {
  json["ns"] = occupancy.ns;
  json["nr"] = occupancy.nr;
  json["na"] = occupancy.na;
}

void PutRatios(Json& json, const Occupancy& occupancy) {
  for (const NamedRatio& ratio : kRatios) json[ratio.name] = Nullable((occupancy.*ratio.of)());
}

Json IntensityJson(const IntensityError& error) {
  Json json;
  for (const IntensityDomain domain : kDomains) {
    Json& over = json[std::string(ToString(domain))];
    over["pixels"] = error.Over(domain).pixels;
    for (const NamedDifference& difference : kDifferences) {
      over[difference.name] = Nullable((error.Over(domain).*difference.of)());
    }
  }
  return json;
}

Json FrameJson(const FrameMetrics& frame, IntensityDomain domain) {
  Json json;
  json["index"] = frame.index;
  json["name"] = frame.name;
  PutCounts(json, frame.polar.occupancy);
  PutRatios(json, frame.polar.occupancy);
  json["intensity_error"] = {{"polar", Nullable(frame.polar.intensity.Over(domain).mean_absolute())},
                             {"fan", Nullable(frame.fan.intensity.Over(domain).mean_absolute())}};
  json["intensity"] = IntensityJson(frame.polar.intensity);
  json["threshold"] = {{"real", frame.threshold_real}, {"simulated", frame.threshold_simulated}};
  Json& fan = json["fan"];
  PutCounts(fan, frame.fan.occupancy);
  PutRatios(fan, frame.fan.occupancy);
  fan["intensity"] = IntensityJson(frame.fan.intensity);
  json["notes"] = frame.notes;
  return json;
}

// "name" and "name_ci".
void PutStatistic(Json& json, const std::string& name, const Statistic& statistic) {
  json[name] = Nullable(statistic.value);
  json[name + "_ci"] = statistic.ci ? Json::array({statistic.ci->lo, statistic.ci->hi}) : Json(nullptr);
}

void PutRatios(Json& json, const ViewSummary& view) {
  for (const NamedRatio& ratio : kRatios) PutStatistic(json, ratio.name, view.*ratio.in);
}

Json IntensityJson(const ViewSummary& view) {
  Json json;
  for (const IntensityDomain domain : kDomains) {
    Json& over = json[std::string(ToString(domain))];
    for (const NamedDifference& difference : kDifferences) {
      PutStatistic(over, difference.name, view.Over(domain).*difference.in);
    }
  }
  return json;
}

// What was left out of the polar figures' means, by name; figures that every frame defines are not listed.
Json FramesLeftOut(const ViewSummary& view, IntensityDomain domain) {
  Json json = Json::object();
  const auto put = [&](const char* name, const Statistic& statistic) {
    if (statistic.frames_left_out > 0) json[name] = statistic.frames_left_out;
  };
  for (const NamedRatio& ratio : kRatios) put(ratio.name, view.*ratio.in);
  put("intensity_error", view.Over(domain).mean_absolute);
  return json;
}

void PutSummary(Json& json, const Aggregate::Views& views, IntensityDomain domain) {
  PutRatios(json, views.polar);
  PutStatistic(json["intensity_error"], "polar", views.polar.Over(domain).mean_absolute);
  PutStatistic(json["intensity_error"], "fan", views.fan.Over(domain).mean_absolute);
  json["intensity"] = IntensityJson(views.polar);
  PutRatios(json["fan"], views.fan);
  json["fan"]["intensity"] = IntensityJson(views.fan);
}

Json MacroJson(const Aggregate& aggregate, IntensityDomain domain) {
  Json json;
  json["frames"] = aggregate.frame_count;
  PutSummary(json, aggregate.macro, domain);
  json["frames_left_out"] = FramesLeftOut(aggregate.macro.polar, domain);
  return json;
}

Json MicroJson(const Aggregate& aggregate, IntensityDomain domain) {
  Json json;
  json["frames"] = aggregate.frame_count;
  PutCounts(json, aggregate.pooled_polar.occupancy);
  PutSummary(json, aggregate.micro, domain);
  PutCounts(json["fan"], aggregate.pooled_fan.occupancy);
  return json;
}

Json IntervalJson(const Aggregate& aggregate) {
  Json json;
  json["level"] = 0.95;
  json["method"] = "percentile bootstrap over frames, taken as independent";
  json["draws"] = kBootstrapDraws;
  json["seed"] = kBootstrapSeed;
  json["min_frames"] = kBootstrapMinFrames;
  json["absent_because"] =
      aggregate.no_interval_reason.empty() ? Json(nullptr) : Json(aggregate.no_interval_reason);
  return json;
}

Json NoiseFloorJson(const NoiseFloor& floor, IntensityDomain domain) {
  Json json;
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
    PutSummary(measured, real.aggregate.macro, domain);
  }
  measured["notes"] = real.notes;
  return json;
}

std::string CsvText(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}

}  // namespace

std::string MetricsJson(const MetricsReport& report) {
  const IntensityDomain domain = report.options.intensity_domain;
  Json json;
  json["format"] = "sonar-metrics/1";
  json["real"] = report.real;
  json["simulated"] = report.simulated;
  json["frames"] = Json::array();
  for (const FrameMetrics& frame : report.frames) json["frames"].push_back(FrameJson(frame, domain));
  json["macro"] = MacroJson(report.aggregate, domain);
  json["micro"] = MicroJson(report.aggregate, domain);
  json["ci"] = IntervalJson(report.aggregate);
  json["segmentation"] = SegmentationJson(report.options.segmentation);
  json["segmentation"]["applied_to"] = "the polar images; fan regions are scan-converted, nearest";
  json["segmentation"]["region_of_interest_px"] =
      report.options.region ? Json(CountSet(*report.options.region)) : Json(nullptr);
  json["intensity_error_definition"] = fmt::format(
      "mean of |simulated - real| / full scale over the {}",
      domain == IntensityDomain::kWhole ? "whole image"
                                        : fmt::format("{} of the two object regions", ToString(domain)));
  json["noise_floor"] = NoiseFloorJson(report.noise_floor, domain);
  json["notes"] = report.notes;
  return JsonText(json);
}

std::string PerFrameCsv(const std::vector<FrameMetrics>& frames, IntensityDomain domain) {
  std::string csv = "index,name";
  for (const char* prefix : {"", "fan_"}) {
    for (const char* count : {"ns", "nr", "na"}) csv += fmt::format(",{}{}", prefix, count);
    for (const NamedRatio& ratio : kRatios) csv += fmt::format(",{}{}", prefix, ratio.name);
  }
  csv += ",intensity_error_polar,intensity_error_fan\n";

  const auto put = [&](const std::optional<double>& value) {
    csv += ',';
    if (value) csv += fmt::format("{}", *value);
  };
  for (const FrameMetrics& frame : frames) {
    csv += fmt::format("{},{}", frame.index, CsvText(frame.name));
    for (const ViewMetrics* view : {&frame.polar, &frame.fan}) {
      const Occupancy& occupancy = view->occupancy;
      csv += fmt::format(",{},{},{}", occupancy.ns, occupancy.nr, occupancy.na);
      for (const NamedRatio& ratio : kRatios) put((occupancy.*ratio.of)());
    }
    put(frame.polar.intensity.Over(domain).mean_absolute());
    put(frame.fan.intensity.Over(domain).mean_absolute());
    csv += '\n';
  }
  return csv;
}

}  // namespace sonarcal
