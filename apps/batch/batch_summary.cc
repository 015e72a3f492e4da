#include "apps/batch/batch_summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <system_error>

#include <nlohmann/json.hpp>

#include "core/types/csv_text.h"
#include "data_io/files/file_bytes.h"
#include "data_io/json/json_document.h"

namespace sonarcal::batch {
namespace {

using Json = nlohmann::ordered_json;

std::optional<nlohmann::json> ReadIfThere(const std::filesystem::path& file) {
  constexpr std::size_t kMaxBytes = 1UL << 32U;  // metrics.json grows with the number of frames
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) return {};
  nlohmann::json json = data_io::ParseLeniently(data_io::ReadFileBytes(file, kMaxBytes));
  if (json.is_discarded()) return {};
  return json;
}

// Ratios and intensity errors of a comparison: "iou", "intensity_error.polar". The rest would make a hundred
// columns and more; it is in the output of the job.
void TakeNumbers(const nlohmann::json& json, const std::string& prefix, Json& figures) {
  for (const auto& [name, value] : json.items()) {
    if (value.is_number()) figures[prefix + name] = value;
    if (name == "intensity_error") TakeNumbers(value, fmt::format("{}{}.", prefix, name), figures);
  }
}

Json FiguresOf(const BatchJob& job, const std::filesystem::path& output) {
  Json figures = Json::object();
  if (job.command == "compare") {
    const auto metrics = ReadIfThere(output / "metrics.json");
    if (metrics && metrics->contains("macro")) TakeNumbers(metrics->at("macro"), "", figures);
  } else if (job.command == "fit" || job.command == "calibrate") {
    const auto fit = ReadIfThere(output / "fit.json");
    if (!fit) return figures;
    for (const char* name : {"cost_initial", "cost_final", "iterations"}) {
      if (fit->contains(name) && fit->at(name).is_number()) figures[name] = fit->at(name);
    }
    if (fit->contains("metrics_after") && fit->at("metrics_after").is_object() &&
        fit->at("metrics_after").contains("macro")) {
      TakeNumbers(fit->at("metrics_after").at("macro"), "after.", figures);
    }
  }
  return figures;
}

std::string Cell(const Json& value) {
  return CsvText(value.is_string() ? value.get<std::string>() : value.dump());
}

}  // namespace

Json BatchSummaryJson(const BatchPlan& plan, const std::vector<LedgerState>& states,
                      const std::filesystem::path& out) {
  Json jobs = Json::array();
  int done = 0;
  int failed = 0;
  for (std::size_t i = 0; i < plan.jobs.size(); ++i) {
    const BatchJob& job = plan.jobs[i];
    const LedgerState& state = states[i];
    const bool is_done = state.event == LedgerState::Event::kDone;
    const bool is_failed = state.event == LedgerState::Event::kFailed;
    done += is_done ? 1 : 0;
    failed += is_failed ? 1 : 0;
    Json row = {{"job", job.id},
                {"command", job.command},
                {"state", is_done     ? "done"
                          : is_failed ? "failed"
                                      : "waiting"}};
    if (!job.after.empty()) row["after"] = fmt::format("{}", fmt::join(job.after, ","));
    if (is_done || is_failed) {
      row["status"] = state.status;
      row["wall_s"] = state.wall_s;
    }
    if (is_failed) row["why"] = state.why;
    row["options"] = job.options;
    row["figures"] = is_done ? FiguresOf(job, out / job.id) : Json::object();
    jobs.push_back(std::move(row));
  }
  return {{"format", "sonarcal-batch-summary/1"},
          {"jobs", jobs},
          {"done", done},
          {"failed", failed},
          {"waiting", static_cast<int>(plan.jobs.size()) - done - failed}};
}

std::string BatchSummaryCsv(const Json& summary) {
  const std::vector<std::string> first = {"job", "command", "state", "status", "wall_s"};
  std::vector<std::pair<std::string, std::string>> columns;  // group, name
  for (const char* group : {"options", "figures"}) {
    for (const Json& row : summary.at("jobs")) {
      for (const auto& [name, value] : row.at(group).items()) {
        const std::pair<std::string, std::string> column(group, name);
        if (std::find(columns.begin(), columns.end(), column) == columns.end()) columns.push_back(column);
      }
    }
  }
  std::string text = fmt::format("{}", fmt::join(first, ","));
  for (const auto& [group, name] : columns) text += fmt::format(",{}", Cell(name));
  text += '\n';
  for (const Json& row : summary.at("jobs")) {
    std::vector<std::string> cells;
    cells.reserve(first.size() + columns.size());
    for (const std::string& name : first) cells.push_back(row.contains(name) ? Cell(row.at(name)) : "");
    for (const auto& [group, name] : columns) {
      cells.push_back(row.at(group).contains(name) ? Cell(row.at(group).at(name)) : "");
    }
    text += fmt::format("{}\n", fmt::join(cells, ","));
  }
  return text;
}

}  // namespace sonarcal::batch
