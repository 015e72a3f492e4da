#include "apps/python/hooks.h"

#include <utility>

namespace sonarcal::python {
namespace {

namespace py = pybind11;

// With the GIL held.
void RaisePendingSignal() {
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

}  // namespace

Listener::Listener(py::object progress, py::object say)
    : progress_(std::move(progress)), say_(std::move(say)) {}

void Listener::Progress(const std::string& what, int done, int in_all) const {
  const py::gil_scoped_acquire gil;
  RaisePendingSignal();
  if (!progress_.is_none()) progress_(what, done, in_all);
}

void Listener::Say(const std::string& sentence) const {
  const py::gil_scoped_acquire gil;
  RaisePendingSignal();
  if (!say_.is_none()) say_(sentence);
}

bool Listener::Stop() {
  if (raised_) return true;
  try {
    Progress("Fitting", ++solver_steps_, 0);
  } catch (...) {
    raised_ = std::current_exception();
  }
  return raised_ != nullptr;
}

workflow::Listener Listener::ForTask() {
  return {.progress = [this](const std::string& what, int done, int in_all) { Progress(what, done, in_all); },
          .message = [this](const std::string& sentence) { Say(sentence); },
          .stop = [this] { return Stop(); }};
}

}  // namespace sonarcal::python
