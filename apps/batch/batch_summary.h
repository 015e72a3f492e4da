// Summary of a batch: one row per job, with its options, its status, and figures of comparisons and fits. As
// JSON, and as a table (CSV) with a column for each value of any job.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "apps/batch/batch_ledger.h"
#include "apps/batch/batch_plan.h"

namespace sonarcal::batch {

// Returns the summary as JSON:
//
//   {"format": "sonarcal-batch-summary/1",
//    "jobs": [{"job", "command", "state": "done" | "failed" | "waiting", "status", "wall_s",
//              "why", "options": {...}, "figures": {...}}],
//    "done": n, "failed": n, "waiting": n}
//
// Figures of a comparison: the ratios and intensity errors of `macro` in its metrics.json. Figures of a fit
// or a calibration: cost_initial, cost_final, iterations, and those of `macro` in metrics_after. `states`
// correspond to the jobs of the plan.
nlohmann::ordered_json BatchSummaryJson(const BatchPlan& plan, const std::vector<LedgerState>& states,
                                        const std::filesystem::path& out);

// Returns the table: columns job, command, state, status, wall_s, then options, then figures. A cell with
// commas, quotes or line breaks is quoted as in RFC 4180. The cell of an absent value is empty.
std::string BatchSummaryCsv(const nlohmann::ordered_json& summary);

}  // namespace sonarcal::batch
