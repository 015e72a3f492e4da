#include "calib/fit_report.h"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "core/types/error.h"
#include "data_io/json/json_fields.h"

namespace sonarcal::calib {
namespace {

using Json = nlohmann::ordered_json;

Json FiniteOrNull(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json ToJson(const FrameSaturation& saturation) {
  return {{"frame", saturation.frame},
          {"streaks", data_io::StreaksJson(saturation.streaks)},
          {"level", saturation.level ? Json(*saturation.level) : Json(nullptr)},
          {"pixels_at_level", saturation.pixels_at_level}};
}

}  // namespace

const FittedParameter* FitReport::Find(const std::string& name) const {
  for (const FittedParameter& parameter : parameters) {
    if (parameter.name == name) return &parameter;
  }
  return nullptr;
}

bool HasTruth(const FitReport& report) {
  return std::any_of(report.parameters.begin(), report.parameters.end(),
                     [](const FittedParameter& p) { return p.truth.has_value(); });
}

std::string CurvesLevelText(const FitReport& report) {
  if (!report.curves_level) return {};
  const auto& [level_db, sigma_db] = *report.curves_level;
  if (sigma_db) {
    return fmt::format(
        "Backscattering strength S_b per unit area, absolute: a standard target gave source level plus gain "
        "as {:.2f} +- {:.2f} dB, an error that the bands do not contain",
        level_db, *sigma_db);
  }
  return fmt::format(
      "Backscatter relative to source level plus gain, taken as {:.2f} dB: no standard target has measured "
      "it",
      level_db);
}

std::string FitReportJson(const FitReport& report, const std::string& extra_members) {
  Json json;
  json["format"] = "sonar-fit/1";
  json["warnings"] = report.warnings;
  json["parameters"] = Json::array();
  for (const FittedParameter& p : report.parameters) {
    json["parameters"].push_back(
        {{"name", p.name},
         {"value", FiniteOrNull(p.value)},
         {"sigma", p.sigma ? FiniteOrNull(*p.sigma) : Json(nullptr)},
         {"unit", p.unit},
         {"initial", FiniteOrNull(p.initial)},
         {"lower", p.lower},
         {"upper", p.upper},
         {"status", ToString(p.status)},
         {"truth", p.truth ? Json(*p.truth) : Json(nullptr)},
         {"prior", p.prior ? Json::array({p.prior->value, p.prior->sigma}) : Json(nullptr)}});
  }
  json["gauge"] = report.gauge;
  json["unidentifiable_directions"] = report.unidentifiable_directions;
  json["other_poses"] = report.other_poses;
  json["ambiguities"] = report.ambiguities;
  Json matrix = Json::array();
  for (Eigen::Index row = 0; row < report.correlation.rows(); ++row) {
    Json values = Json::array();
    for (Eigen::Index col = 0; col < report.correlation.cols(); ++col) {
      values.push_back(FiniteOrNull(report.correlation(row, col)));
    }
    matrix.push_back(std::move(values));
  }
  json["correlation"] = {{"names", report.correlation_names}, {"matrix", std::move(matrix)}};
  json["residuals"] = {{"raw", nullptr},
                       {"whitened", {{"mean", report.whitened.mean}, {"spread", report.whitened.spread}}}};
  if (report.raw) {
    json["residuals"]["raw"] = {
        {"mean", report.raw->mean}, {"spread", report.raw->spread}, {"unit", "full scale"}};
  }
  json["curves"] = Json::array();
  for (const FittedCurve& curve : report.curves) {
    Json sigma_db = Json::array();
    for (const double sigma : curve.sigma_db) sigma_db.push_back(FiniteOrNull(sigma));
    json["curves"].push_back({{"material", curve.material},
                              {"incidence_deg", curve.incidence_deg},
                              {"backscatter_db", curve.backscatter_db},
                              {"sigma_db", std::move(sigma_db)},
                              {"determined", curve.determined}});
    if (!curve.truth_db.empty()) json["curves"].back()["truth_db"] = curve.truth_db;
  }
  if (report.curves_level) {
    json["curves_level"] = {
        {"level_db", report.curves_level->level_db},
        {"sigma_db", report.curves_level->sigma_db ? Json(*report.curves_level->sigma_db) : Json(nullptr)}};
  }
  if (report.pings) {
    const PingWorth& pings = *report.pings;
    json["pings"] = {{"used", pings.used},
                     {"per_frame", pings.pings},
                     {"period_s", pings.period_s},
                     {"max_turn_deg", pings.max_turn_deg},
                     {"max_distance_m", pings.max_distance_m},
                     {"frames", pings.frames},
                     {"held_out", pings.held_out},
                     {"gain_nats_per_pixel", FiniteOrNull(pings.gain_nats_per_pixel)},
                     {"gain_sigma", FiniteOrNull(pings.gain_sigma)}};
  }
  if (report.down_weighted_share) json["down_weighted_share"] = *report.down_weighted_share;
  json["start_costs"] = report.start_costs;
  json["cost_initial"] = FiniteOrNull(report.cost_initial);
  json["cost_final"] = FiniteOrNull(report.cost_final);
  json["iterations"] = report.iterations;
  json["termination"] = report.termination;
  json["frames_used"] = report.frames_used;
  json["frames_held_out"] = report.frames_held_out;
  if (report.saturation) {
    json["saturation"] = Json::array();
    for (const FrameSaturation& saturation : *report.saturation)
      json["saturation"].push_back(ToJson(saturation));
  }
  json["timing_s"] = {{"trace", report.trace_s}, {"solve", report.solve_s}};
  json["rays_cast"] = report.rays_cast;
  if (!extra_members.empty()) {
    const Json extra = Json::parse("{" + extra_members + "}", nullptr, false);
    SONARCAL_CHECK(!extra.is_discarded(), "extra members of fit.json are not JSON: {}", extra_members);
    json.update(extra);
  }
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace sonarcal::calib
