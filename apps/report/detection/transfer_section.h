// Training value of simulated frames (apps/workflow/task/recording_transfer.h): report, text and JSON.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "apps/report/html/html_report.h"
#include "apps/workflow/task/recording_transfer.h"

namespace sonarcal::report {

// Adds key figures, the table of figures, precision-recall curves, and pictures of test frames.
void AddTransfer(HtmlReport& report, const workflow::RecordingTransfer& result);

// Figures for a terminal, with newlines.
std::string TransferText(const workflow::RecordingTransfer& result);

// transfer.json, keys: docs/reference/transfer_json.md.
nlohmann::ordered_json TransferJson(const workflow::RecordingTransfer& result);

}  // namespace sonarcal::report
