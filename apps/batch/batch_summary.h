// What a batch came to: one row a job, with its options, how it ended and, of comparisons and fits, its
// figures. As JSON, and as a table (CSV) whose columns are those that any job has.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "apps/batch/batch_ledger.h"
#include "apps/batch/batch_plan.h"

namespace sonarcal::batch {

// {"format": "sonarcal-batch-summary/1", "jobs": [{"job", "command", "state": "done" | "failed" | "waiting",
//   "status", "wall_s", "why", "options": {...}, "figures": {...}}], "done": n, "failed": n, "waiting": n}
//
// Figures are the ratios and intensity errors of `macro` in a comparison's metrics.json, and of a fit
// cost_initial, cost_final, iterations, and those of `macro` in metrics_after. `states` go with the plan's
// jobs.
nlohmann::ordered_json BatchSummaryJson(const BatchPlan& plan, const std::vector<LedgerState>& states,
                                        const std::filesystem::path& out);

// Columns job, command, state, status, wall_s, then options, then figures. A cell with commas, quotes or line
// breaks is quoted, as RFC 4180 has it; one that a job does not have is empty.
std::string BatchSummaryCsv(const nlohmann::ordered_json& summary);

}  // namespace sonarcal::batch
