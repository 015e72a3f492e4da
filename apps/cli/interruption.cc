#include "apps/cli/interruption.h"

#include <pthread.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <ctime>
#include <future>
#include <iostream>
#include <memory>
#include <string>
#include <string_view>
#include <system_error>
#include <thread>

#include "apps/cli/command.h"
#include "apps/cli/run_output.h"

namespace sonarcal::cli {
namespace {

std::atomic<bool> command_can_stop = false;
std::atomic<bool> command_was_asked = false;
std::atomic<bool> command_may_be_slow = false;
std::atomic<bool> command_has_ended = false;

// Prints an error from another thread, and waits for it a moment only: nobody may read the output, or another
// thread may be held by it.
void PrintErrorIfRead(const std::string& sentence) {
  constexpr auto kMoment = std::chrono::milliseconds(300);
  const auto is_printed = std::make_shared<std::promise<void>>();
  const std::future<void> printed = is_printed->get_future();
  try {
    std::thread([is_printed, sentence] {
      std::cerr << '\n';  // ends the line of a progress bar
      PrintError(sentence);
      is_printed->set_value();
    }).detach();
  } catch (const std::system_error&) {  // no thread can be made
    return;
  }
  printed.wait_for(kMoment);
}

std::string_view EndOfSentence(LeftOutputs left) {
  switch (left) {
    case LeftOutputs::kNone:
      return "";
    case LeftOutputs::kRemoved:
      return ", unfinished outputs were removed";
    case LeftOutputs::kKept:
      return "; the same command with --resume goes on";
  }
  return "";
}

// Ends the program by the signal, as a shell expects it.
[[noreturn]] void EndBy(int signal, const sigset_t& signals, std::string_view why) {
  const std::string_view end = EndOfSentence(RemoveUnfinishedOutputs());
  if (signal != SIGPIPE || !end.empty()) PrintErrorIfRead(std::string(why).append(end));
  std::signal(signal, SIG_DFL);
  pthread_sigmask(SIG_UNBLOCK, &signals, nullptr);
  std::raise(signal);
  std::_Exit(1);
}

// Discards a copy of the signal. GNU timeout sends one to the process and another to its group at once.
void DiscardCopy(int signal) {
  constexpr timespec kApart = {0, 100'000'000};
  constexpr timespec kNow = {};
  nanosleep(&kApart, nullptr);
  sigset_t copies;
  sigemptyset(&copies);
  sigaddset(&copies, signal);
  sigtimedwait(&copies, nullptr, &kNow);
}

void WaitForSignals(const sigset_t& signals) {
  int signal = 0;
  if (sigwait(&signals, &signal) != 0) return;
  if (!command_can_stop) {
    EndBy(signal, signals, signal == SIGPIPE ? "nobody reads the output any more" : "interrupted");
  }
  command_was_asked = true;
  DiscardCopy(signal);
  constexpr timespec kMoment = {0, 600'000'000};
  int again = sigtimedwait(&signals, nullptr, &kMoment);
  if (again < 0 && command_has_ended) {
    if (sigwait(&signals, &again) != 0) return;
  } else if (again < 0 && command_may_be_slow) {
    PrintErrorIfRead("waiting for the work that is running; a second interruption ends at once");
    if (sigwait(&signals, &again) != 0) return;
  }
  EndBy(again < 0 ? signal : again, signals, again < 0 ? "interrupted" : "interrupted twice: ended at once");
}

pthread_t waiting_thread;

// Passes a signal of the thread that writes on to the one that waits for signals, once.
void PassOn(int signal) {
  std::signal(signal, SIG_IGN);
  pthread_kill(waiting_thread, signal);
  while (!command_can_stop) pause();  // the program ends
}

bool IsIgnored(int signal) {
  struct sigaction inherited = {};
  return sigaction(signal, nullptr, &inherited) == 0 && inherited.sa_handler == SIG_IGN;
}

}  // namespace

Interruption::Interruption(IfSlow if_slow) {
  command_may_be_slow = if_slow == IfSlow::kWait;
  command_can_stop = true;
}

Interruption::~Interruption() {
  command_can_stop = false;
}

// Asked of an object, so that it is only used while one lives.
// NOLINTNEXTLINE(readability-convert-member-functions-to-static)
bool Interruption::asked() const {
  return command_was_asked;
}

// A signal handler must not remove folders. So a separate thread waits for the signals, and all others block
// them. A signal that the caller ignores, as under nohup, stays ignored: blocked, it would reach that thread.
// SIGPIPE goes to the thread that writes into a pipe without a reader, so its handler passes it on.
void HandleSignals() {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) {
    if (!IsIgnored(signal)) sigaddset(&signals, signal);
  }
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  std::signal(SIGXFSZ, SIG_IGN);  // a file above `ulimit -f` is an error of its write, which has a sentence
  std::thread waiting([signals] { WaitForSignals(signals); });
  waiting_thread = waiting.native_handle();
  waiting.detach();
  if (sigismember(&signals, SIGPIPE) != 1) return;
  std::signal(SIGPIPE, PassOn);
  sigset_t pipe;
  sigemptyset(&pipe);
  sigaddset(&pipe, SIGPIPE);
  pthread_sigmask(SIG_UNBLOCK, &pipe, nullptr);
}

void CommandHasEnded() {
  command_has_ended = true;
}

}  // namespace sonarcal::cli
