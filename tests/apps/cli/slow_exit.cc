// A library that makes the exit of a program take a second longer (LD_PRELOAD).
#include <chrono>
#include <thread>

namespace {

class SlowExit {
 public:
  SlowExit() = default;
  ~SlowExit() { std::this_thread::sleep_for(std::chrono::seconds(1)); }
  SlowExit(const SlowExit&) = delete;
  SlowExit& operator=(const SlowExit&) = delete;
};

const SlowExit kSlowExit;

}  // namespace
