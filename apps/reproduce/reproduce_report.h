// The report of `reproduce`: the tank beside the paper's tables, the bomb's frames, the other recordings.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "apps/report/html/html_report.h"
#include "apps/reproduce/bomb_comparison.h"
#include "apps/reproduce/tank_comparison.h"

namespace sonarcal::reproduce {

// A recording that is read and shown, no more: it has no pose and no scene.
struct ShownRecording {
  std::string name;
  std::string failure;  // why it could not be read; empty where it could
  RecordingInfo info;
  int frame_count = 0;
  std::vector<std::uint8_t> polar_png;
  std::vector<std::uint8_t> fan_png;
};

struct Reproduction {
  TankComparison tank;
  std::optional<BombComparison> bomb;
  std::string bomb_absent;  // why there is none
  std::vector<ShownRecording> shown;
};

report::HtmlReport MakeReproductionReport(const Reproduction& reproduction,
                                          const nlohmann::ordered_json& provenance);

// The text of metrics.json: the tank's held-out frames after the fit of the paper's model in the form of
// `compare`, and beside it "metrics_before", "acoustic" (the same of the acoustic model, and of a sample),
// "summary" (apps/reproduce/summary_rows.h), "data_sets" with the published values, and "bomb".
std::string ReproductionMetricsJson(const Reproduction& reproduction);

}  // namespace sonarcal::reproduce
