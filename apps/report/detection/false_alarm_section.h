// Realised false-alarm rates (metrics/false_alarms.h) as a report, as text and as JSON.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "apps/report/html/html_report.h"
#include "metrics/false_alarms.h"

namespace sonarcal::report {

// Adds a section with one table. Adds nothing without rates.
void AddFalseAlarms(HtmlReport& report, const std::vector<metrics::FalseAlarmRate>& rates);

// Table for a terminal, with newlines; empty without rates.
std::string FalseAlarmsText(const std::vector<metrics::FalseAlarmRate>& rates);

// List `false_alarms` of judgement.json (docs/guide/noise.md).
nlohmann::ordered_json FalseAlarmsJson(const std::vector<metrics::FalseAlarmRate>& rates);

}  // namespace sonarcal::report
