// Python from C++ that runs without the GIL: a long call releases it, and takes it again for a moment
// wherever it reports something.
#pragma once

#include <pybind11/pybind11.h>

#include <exception>
#include <string>

#include "apps/workflow/listener.h"
#include "calib/parameters/fit_options.h"

namespace sonarcal::python {

// Passes the reports of a task to Python. Each call also lets Python look at its signals, so that Ctrl-C ends
// the task with a KeyboardInterrupt. Made and destroyed with the GIL held. Its calls take the GIL themselves,
// from any thread, and throw pybind11::error_already_set if Python raised something.
class Listener {
 public:
  // Either may be None: progress(what: str, done: int, total: int), say(sentence: str).
  Listener(pybind11::object progress, pybind11::object say);

  // `in_all` is 0 if it is not known.
  void Progress(const std::string& what, int done, int in_all) const;
  void Say(const std::string& sentence) const;

  // Runs `task(const workflow::Listener&)`. Ceres is not written to be left by an exception: a solver is
  // asked to stop, and what Python raised is thrown after it, also if the task returns what it has finished.
  template <typename Task>
  auto Run(Task&& task) {
    try {
      auto result = task(ForTask());
      if (raised_) std::rethrow_exception(raised_);
      return result;
    } catch (const calib::FitStopped&) {
      if (raised_) std::rethrow_exception(raised_);
      throw;
    }
  }

 private:
  workflow::Listener ForTask();
  bool Stop();  // asked between the steps of a solver

  pybind11::object progress_;
  pybind11::object say_;
  std::exception_ptr raised_;
  int solver_steps_ = 0;
};

}  // namespace sonarcal::python
