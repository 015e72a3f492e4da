// A fit in the background of `sonarcal view`: as `sonarcal fit` makes it (apps/workflow/fit.h), from where
// the page's controls stand, one at a time.
#pragma once

#include <atomic>
#include <chrono>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include <nlohmann/json_fwd.hpp>

#include "apps/workflow/fit.h"

namespace sonarcal::view {

struct ViewFitRequest {
  std::shared_ptr<const RecordingSource> real;
  Scene scene;
  ParameterSet initial;
  workflow::FitRecordingOptions options;
};

class ViewFit {
 public:
  ViewFit() = default;
  ~ViewFit();  // stops a fit that runs
  ViewFit(const ViewFit&) = delete;
  ViewFit& operator=(const ViewFit&) = delete;

  // Throws DataError where one runs already.
  void Start(ViewFitRequest request);

  // Asks the fit to end; it does at its next step. Nothing where none runs.
  void Stop() { stop_ = true; }

  // {"state": "none" | "running" | "stopping" | "done" | "stopped" | "failed", "elapsed_s", "doing",
  //  "frames_traced", "frames", "lines": [...], "error": why it failed, "result": see ResultJson}
  nlohmann::ordered_json Status() const;

 private:
  enum class Phase { kNone, kRunning, kDone, kStopped, kFailed };

  void Run(ViewFitRequest request);
  void Say(const std::string& line);
  void End(Phase phase, const std::string& error);

  std::thread thread_;
  std::atomic<bool> stop_ = false;

  mutable std::mutex mutex_;  // guards what follows
  Phase phase_ = Phase::kNone;
  std::chrono::steady_clock::time_point began_;
  double took_s_ = 0.0;
  int traced_ = 0;
  int frames_ = 0;
  std::deque<std::string> lines_;  // the last ones
  std::string error_;
  std::string result_;  // JSON
};

}  // namespace sonarcal::view
