// Runs test cases for scripts/mutation_test.py, in one of two ways.
//
// With a file as argument: all cases. Writes one line per passing case to it, "Suite.Case ms id id ...": its
// time on the processor, and the mutants that it reaches. What the set-up of a suite reaches counts for each
// of its cases.
//
// Without: reads lines "id limit_s filter", runs the cases of the filter with this mutant in a process of
// their own, at most so many seconds on the processor, and answers "survived", "killed" or "timeout".
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

#include "scripts/mutant.h"

namespace {

std::vector<int> TakeReached() {
  std::vector<int> ids;
  for (int id = 0; id < mutation::kMaxMutants; ++id) {
    if (mutation::reached[id]) ids.push_back(id);
    mutation::reached[id] = false;
  }
  return ids;
}

class ReachedMutants : public testing::EmptyTestEventListener {
 public:
  explicit ReachedMutants(const char* path) : out_(path) {}

  void OnTestSuiteStart(const testing::TestSuite& /*suite*/) override {
    TakeReached();
    of_suite_.clear();
  }
  void OnTestStart(const testing::TestInfo& /*info*/) override {
    const std::vector<int> ids = TakeReached();
    of_suite_.insert(of_suite_.end(), ids.begin(), ids.end());
    start_ = std::clock();
  }
  void OnTestEnd(const testing::TestInfo& info) override {
    if (info.result()->Skipped() || info.result()->Failed()) return;
    const double ms = 1e3 * static_cast<double>(std::clock() - start_) / CLOCKS_PER_SEC;
    out_ << info.test_suite_name() << '.' << info.name() << ' ' << ms;
    for (const int id : of_suite_) out_ << ' ' << id;
    for (const int id : TakeReached()) out_ << ' ' << id;
    out_ << std::endl;
  }

 private:
  std::ofstream out_;
  std::vector<int> of_suite_;
  std::clock_t start_ = 0;
};

[[noreturn]] void RunMutant(int id, unsigned limit_s, const std::string& filter) {
  if (std::freopen("/dev/null", "w", stdout) == nullptr) _exit(3);
  const rlimit limit = {.rlim_cur = limit_s, .rlim_max = limit_s + 1};
  setrlimit(RLIMIT_CPU, &limit);
  constexpr unsigned kAsleepS = 1200;  // a deadlock takes no time on the processor
  alarm(kAsleepS);
  mutation::active = id;
  GTEST_FLAG_SET(filter, filter);
  GTEST_FLAG_SET(fail_fast, true);
  _exit(RUN_ALL_TESTS());
}

const char* ResultOf(int status) {
  if (WIFSIGNALED(status)) {
    const int signal = WTERMSIG(status);
    return signal == SIGXCPU || signal == SIGALRM || signal == SIGKILL ? "timeout" : "killed";
  }
  return WEXITSTATUS(status) == 0 ? "survived" : "killed";
}

}  // namespace

int main(int argc, char** argv) {
  testing::InitGoogleMock(&argc, argv);
  if (argc > 1) {
    testing::UnitTest::GetInstance()->listeners().Append(new ReachedMutants(argv[1]));
    return RUN_ALL_TESTS();
  }
  if (GTEST_FLAG_GET(list_tests)) return RUN_ALL_TESTS();
  int id = 0;
  unsigned limit_s = 0;
  std::string filter;
  while (std::cin >> id >> limit_s >> filter) {
    const pid_t child = fork();
    if (child == 0) RunMutant(id, limit_s, filter);
    int status = 0;
    waitpid(child, &status, 0);
    std::cout << ResultOf(status) << std::endl;
  }
  return 0;
}
