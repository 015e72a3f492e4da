// Receives what a task reports while it works.
#pragma once

#include <functional>
#include <string>

namespace sonarcal::workflow {

// Each function may be empty.
struct Listener {
  // After each piece of work: what is done ("Tracing"), pieces done, pieces in all (0: unknown).
  std::function<void(const std::string& step, int done, int total)> progress = {};
  // What a user should know, one sentence each. Warnings begin with "warning: ".
  std::function<void(const std::string& sentence)> message = {};
  // Asked between the steps of a solver. A fit ends with calib::FitStopped as soon as it returns true.
  std::function<bool()> stop = {};

  void Progress(const std::string& step, int done, int total) const {
    if (progress) progress(step, done, total);
  }
  void Message(const std::string& sentence) const {
    if (message && !sentence.empty()) message(sentence);
  }
};

}  // namespace sonarcal::workflow
