// Python from C++ that runs without the GIL: a long call releases it, and takes it again for a moment
// wherever it tells how far it is.
#pragma once

#include <pybind11/pybind11.h>

#include <string>

namespace sonarcal::python {

// Who is told what a run does. Each call also lets Python look at its signals, so that Ctrl-C ends the run by
// a KeyboardInterrupt. Made and destroyed with the GIL held; its calls take the GIL themselves, from any
// thread, and throw pybind11::error_already_set where Python raised something.
class Listener {
 public:
  // Either may be None: progress(what: str, done: int, total: int), say(sentence: str).
  Listener(pybind11::object progress, pybind11::object say);

  // `in_all` is 0 where it is not known.
  void Progress(const std::string& what, int done, int in_all) const;
  void Say(const std::string& sentence) const;

 private:
  pybind11::object progress_;
  pybind11::object say_;
};

}  // namespace sonarcal::python
