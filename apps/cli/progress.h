// How far a long run is, on stderr: a bar on a terminal, a plain line now and then elsewhere (a log), nothing
// with --quiet. Work of less than a second shows nothing at all.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <iosfwd>
#include <mutex>
#include <string>

#include "apps/cli/command.h"

namespace sonarcal::cli {

// Where and how progress is shown. The defaults of a program; tests give their own clock and stream.
struct ProgressSettings {
  std::ostream* stream = nullptr;  // nullptr shows nothing
  bool terminal = false;           // a bar that redraws itself, rather than lines
  std::function<double()> now_s;   // a steady clock, seconds

  static ProgressSettings Standard(bool quiet);
};

//   Progress progress("Simulating", frame_count, options.common);
//   for (...) { ...; progress.Advance(); }
class Progress {
 public:
  // `total` is the number of steps; with 0, only what is done is counted. Where the steps have a name
  // ("frames"), their number a second is shown.
  Progress(std::string title, int total, const CommonOptions& common, std::string unit = {})
      : Progress(std::move(title), total, ProgressSettings::Standard(common.quiet), std::move(unit)) {}
  Progress(std::string title, int total, ProgressSettings settings, std::string unit = {});
  ~Progress();  // takes the bar away
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // Any thread may call these, as often as it likes.
  void Advance(int steps = 1) { Show(done_.fetch_add(steps) + steps); }
  void Update(int done) {
    done_ = done;
    Show(done);
  }

  // A step that took no time, as it was done in an earlier run: it counts as done, but to no rate.
  void Skip() {
    ++skipped_;
    ++done_;
  }

 private:
  void Show(int done);
  std::string StatusText(int done, double elapsed_s) const;

  const std::string title_;
  const int total_;
  const ProgressSettings settings_;
  const std::string unit_;
  double start_s_ = 0.0;
  std::atomic<int> done_ = 0;
  std::atomic<int> skipped_ = 0;
  std::mutex mutex_;  // guards the stream and what follows
  double next_show_s_ = 0.0;
  bool bar_drawn_ = false;
};

}  // namespace sonarcal::cli
