// Receives what a task reports while it works.
#pragma once

#include <functional>
#include <string>

namespace sonarcal::workflow {

// Each function may be empty.
struct Listener {
  // Called after each piece of work with its name ("Tracing"), pieces done, and pieces in all (0: unknown).
  std::function<void(const std::string& step, int done, int total)> progress = {};
  // Called with a message for the user, one sentence each. Warnings begin with "warning: ".
  std::function<void(const std::string& sentence)> message = {};
  // Called between the steps of a solver. If it returns true, the fit ends with calib::FitStopped.
  std::function<bool()> stop = {};

  void Progress(const std::string& step, int done, int total) const {
    if (progress) progress(step, done, total);
  }
  void Message(const std::string& sentence) const {
    if (message && !sentence.empty()) message(sentence);
  }
};

}  // namespace sonarcal::workflow
