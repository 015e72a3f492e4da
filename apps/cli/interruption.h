// What SIGINT (Ctrl-C), SIGTERM and SIGHUP do: end the program, after unfinished outputs have been removed. A
// long command that can come to an end in good order says so:
//
//   const Interruption interruption;
//   for (...; !interruption.asked(); ...) { ... }
//   if (interruption.asked()) { keep what is finished; return ExitStatus::kInterrupted; }
#pragma once

namespace sonarcal::cli {

// While one lives, the first signal only asks; a second ends the program at once. One at a time.
class Interruption {
 public:
  Interruption();
  ~Interruption();
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;

  bool asked() const;
};

// Takes charge of the signals, once in a program and before it has other threads.
void HandleSignals();

}  // namespace sonarcal::cli
