// A library that makes the exit of a program take a second longer (LD_PRELOAD).
#include <chrono>
#include <thread>

namespace {

struct SlowExit {
  ~SlowExit() { std::this_thread::sleep_for(std::chrono::seconds(1)); }
};

const SlowExit slow_exit;

}  // namespace
