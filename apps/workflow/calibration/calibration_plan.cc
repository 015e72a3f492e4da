#include "apps/workflow/calibration/calibration_plan.h"

#include <algorithm>

#include <nlohmann/json.hpp>

#include "data_io/json/json_reader.h"
#include "data_io/parameters/parameters_io.h"

namespace sonarcal::workflow {

constexpr std::string_view kPlanFormat = "sonar-calibration-plan/1";

bool CalibrationPlan::Has(CalibrationStage stage) const {
  return std::ranges::find(decided, stage, &CalibrationDecision::stage) != decided.end();
}

namespace {

CalibrationPlan PlanFrom(const data_io::JsonReader& json) {
  json.CheckFormat(kPlanFormat);
  CalibrationPlan plan;
  for (const data_io::JsonReader& item : json.At("decided").Items()) {
    const auto text = [&](const char* key) {
      const auto found = item.Find(key);
      return found ? found->String() : std::string();
    };
    plan.decided.push_back({.stage = item.At("stage").Word<CalibrationStage>(),
                            .choice = text("choice"),
                            .reason = text("reason")});
  }
  if (const auto word = json.Find("absorption")) plan.absorption = word->Word<sim::AbsorptionFormula>();
  if (const auto parameters = json.Find("parameters")) plan.parameters = data_io::ParametersFrom(*parameters);
  if (const auto fit = json.Find("fit")) plan.fit = calib::FitConfigFrom(*fit);
  json.Finish();
  return plan;
}

}  // namespace

CalibrationPlan ReadCalibrationPlan(const std::filesystem::path& file) {
  return PlanFrom(data_io::JsonReader::FromFile(file));
}

CalibrationPlan ParseCalibrationPlan(std::string_view text, const std::string& name) {
  return PlanFrom(data_io::JsonReader::FromText(text, name));
}

nlohmann::ordered_json CalibrationPlanJson(const CalibrationPlan& plan) {
  using Json = nlohmann::ordered_json;
  Json json = {{"format", kPlanFormat}, {"decided", Json::array()}};
  for (const CalibrationDecision& decision : plan.decided) {
    json["decided"].push_back(
        {{"stage", ToString(decision.stage)}, {"choice", decision.choice}, {"reason", decision.reason}});
  }
  json["absorption"] = ToString(plan.absorption);
  json["parameters"] = data_io::ParametersJson(plan.parameters);
  json["fit"] = calib::FitConfigJson(plan.fit);
  return json;
}

}  // namespace sonarcal::workflow
