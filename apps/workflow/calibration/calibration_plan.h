// Decisions of a calibration (calibrate.h), as a file: a run with the plan of another one repeats its last
// fit exactly, and a plan with some of the stages decides the others anew.
//
//   {"format": "sonar-calibration-plan/1",
//    "decided": [{"stage": "water", "choice": "fresh, 15 C", "reason": "the recording states it",
//                 "open": []}, ...],
//    "absorption": "auto",
//    "parameters": {...},     // params.json: start values of the last fit
//    "fit": {...}}            // configuration of the last fit (calib/parameters/fit_config.h)
//
// Stages that `decided` does not name are decided anew. Then `parameters` and `fit` need hold only what the
// named stages decide. The stage "frames" needs `used` and `held_out` of `fit`.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "calib/parameters/fit_config.h"
#include "core/types/parameters.h"
#include "core/types/words.h"
#include "sim/physics/absorption.h"

namespace sonarcal::workflow {

// Stages, in their order.
enum class CalibrationStage { kFrames, kWater, kNoise, kPlacement, kBeam, kMirrors };
constexpr auto WordsOf(std::type_identity<CalibrationStage>) {
  return Words<CalibrationStage, 6>{{{"frames", CalibrationStage::kFrames},
                                     {"water", CalibrationStage::kWater},
                                     {"noise", CalibrationStage::kNoise},
                                     {"placement", CalibrationStage::kPlacement},
                                     {"beam", CalibrationStage::kBeam},
                                     {"mirrors", CalibrationStage::kMirrors}}};
}

// All texts are phrases without a full stop.
struct CalibrationDecision {
  std::string choice = {};
  std::string reason = {};
  std::vector<std::string> open = {};  // what the recording could not determine
  CalibrationStage stage = CalibrationStage::kFrames;
};

struct CalibrationPlan {
  std::vector<CalibrationDecision> decided;
  sim::AbsorptionFormula absorption = sim::AbsorptionFormula::kAuto;
  ParameterSet parameters;
  calib::FitConfig fit;

  bool Has(CalibrationStage stage) const;
};

// Throws DataError with file, line and key.
CalibrationPlan ReadCalibrationPlan(const std::filesystem::path& file);
// As ReadCalibrationPlan; `name` is the name for messages.
CalibrationPlan ParseCalibrationPlan(std::string_view text, const std::string& name);

nlohmann::ordered_json CalibrationPlanJson(const CalibrationPlan& plan);

}  // namespace sonarcal::workflow
