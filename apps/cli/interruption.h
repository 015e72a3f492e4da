// Effect of SIGINT (Ctrl-C), SIGTERM, SIGHUP and SIGPIPE (nobody reads the output any more): they remove
// unfinished outputs and end the program. A signal that the program inherits as ignored stays ignored, such
// as SIGHUP under nohup. A long command that can stop and keep its finished outputs declares it:
//
//   const Interruption interruption;
//   for (...; !interruption.asked(); ...) { ... }
//   if (interruption.asked()) { keep what is finished; return ExitStatus::kInterrupted; }
#pragma once

namespace sonarcal::cli {

// During the lifetime of an object, the first signal only sets asked(). The program ends at once if it has
// not stopped a moment later, and at a second signal. A copy of the first signal that comes at once is no
// second one. Only one object may exist at a time.
class Interruption {
 public:
  // Effect on a command that still runs a moment after the first signal. kWait is for one that would lose
  // what is finished, or leave other processes behind.
  enum class IfSlow { kEnd, kWait };

  explicit Interruption(IfSlow if_slow = IfSlow::kEnd);
  ~Interruption();
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;

  bool asked() const;
};

// Starts handling the signals. Must be called once, before the program starts other threads.
void HandleSignals();

// Must be called when the command has returned. If an interruption stopped the command, only a further one
// ends the program, however long its exit takes.
void CommandHasEnded();

}  // namespace sonarcal::cli
