// A fit in the background of `sonarcal view`, as by `sonarcal fit` (apps/workflow/fit.h), starting from the
// values of the controls. Only one runs at a time.
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "apps/workflow/fit.h"
#include "data_io/json/json_reader.h"

namespace sonarcal::view {

// Options of `sonarcal fit` that the page sets, in its order.
inline constexpr std::array<std::string_view, 3> kPageOptions = {"starts", "max_iterations", "fixed"};

// [{"name", "help", "default", "min", "max"}], without limits for a list of names.
nlohmann::ordered_json PageOptionsJson();

// Reads those of the page's options that are there. Throws DataError for a value that is not of its kind.
workflow::FitOptions ReadPageOptions(const data_io::JsonReader& json);

struct ViewFitRequest {
  std::shared_ptr<const RecordingSource> real;
  Scene scene;
  ParameterSet initial;
  workflow::FitRecordingOptions options;
  std::vector<std::string> messages = {};  // said before the fit, one sentence each
};

class ViewFit {
 public:
  ViewFit() = default;
  ~ViewFit();  // stops a running fit
  ViewFit(const ViewFit&) = delete;
  ViewFit& operator=(const ViewFit&) = delete;

  // Throws DataError if a fit is already running.
  void Start(ViewFitRequest request);

  // Requests the end of a fit; it ends at its next step. No effect without a fit.
  void Stop() { stop_ = true; }

  // {"state": "none" | "running" | "stopping" | "done" | "stopped" | "failed", "elapsed_s",
  //  "frames_traced", "frames", "lines": [...], "error": why it failed, "result": see ResultJson}
  nlohmann::ordered_json Status() const;

 private:
  enum class Phase { kNone, kRunning, kDone, kStopped, kFailed };

  void Run(ViewFitRequest request);
  void Say(const std::string& line);
  void End(Phase phase, const std::string& error);

  std::thread thread_;
  std::atomic<bool> stop_ = false;

  mutable std::mutex mutex_;  // guards the members below
  Phase phase_ = Phase::kNone;
  std::chrono::steady_clock::time_point began_;
  double took_s_ = 0.0;
  int traced_ = 0;
  int frames_ = 0;
  std::deque<std::string> lines_;  // latest lines
  std::string error_;
  std::string result_;  // JSON
};

}  // namespace sonarcal::view
