// Progress of a long run on stderr: a bar on a terminal, a plain line now and then otherwise (in a log),
// nothing with --quiet. Work of less than a second shows nothing. --log receives the lines, too.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <iosfwd>
#include <mutex>
#include <string>

#include "apps/cli/command.h"

namespace sonarcal::cli {

// Destination and form of progress. Standard returns those of the program; tests set their own clock and
// stream.
struct ProgressSettings {
  std::ostream* stream = nullptr;                       // nullptr shows nothing
  bool terminal = false;                                // a bar that redraws itself, instead of lines
  std::function<double()> now_s;                        // a steady clock, seconds
  std::function<void(const std::string&)> log = {};     // receives lines like those without a terminal
  std::function<void(const std::string&)> detail = {};  // receives the time of the loop at its end

  // Shows nothing with --quiet. Lines go to --log. The time of the loop is a detail (apps/cli/messages.h).
  static ProgressSettings Standard(bool quiet);
};

// Reports the progress of a loop.
//
//   Progress progress("Simulating", frame_count, options.common);
//   for (...) { ...; progress.Advance(); }
class Progress {
 public:
  // `total`: number of steps; 0: unknown, shows the number of finished steps. `unit`: name of the steps
  // ("frames"); with it the steps per second are shown.
  Progress(std::string title, int total, const CommonOptions& common, std::string unit = {})
      : Progress(std::move(title), total, ProgressSettings::Standard(common.quiet), std::move(unit)) {}
  Progress(std::string title, int total, ProgressSettings settings, std::string unit = {});
  ~Progress();  // removes the bar
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // Thread-safe; may be called at any rate.
  void Advance(int steps = 1) { Show(done_.fetch_add(steps) + steps); }
  void Update(int done) {
    done_ = done;
    Show(done);
  }

  // Counts a step of an earlier run as done, but not in the rate.
  void Skip() {
    ++skipped_;
    ++done_;
  }

 private:
  void Show(int done);
  void PrintDuration(int done);  // once
  std::string StatusText(int done, double elapsed_s) const;

  const std::string title_;
  const int total_;
  const ProgressSettings settings_;
  const std::string unit_;
  double start_s_ = 0.0;
  std::atomic<int> done_ = 0;
  std::atomic<int> skipped_ = 0;
  std::atomic<bool> has_printed_duration_ = false;
  std::mutex mutex_;  // guards the stream and the members below
  double next_show_s_ = 0.0;
  double next_log_s_ = 0.0;
  bool bar_drawn_ = false;
};

}  // namespace sonarcal::cli
