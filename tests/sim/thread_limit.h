// Runs a function with a given number of threads.
#pragma once

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

namespace sonarcal::testing {

template <typename Function>
auto WithThreads(int threads, const Function& function) {
  // global_control only lowers the number; the arena offers as many slots where the machine has fewer cores.
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
  tbb::task_arena arena(threads);
  return arena.execute(function);
}

}  // namespace sonarcal::testing
