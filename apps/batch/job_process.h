// One job of a batch as a process of this program. It ends whenever its parent ends.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace sonarcal::batch {

class JobProcess {
 public:
  // Runs `sonarcal ARGUMENTS` in `folder`, with standard output and error to `log`, whose folder is created.
  // The process has its own group, so that Ctrl-C on a terminal reaches only the batch. Throws DataError if
  // it cannot be started.
  JobProcess(const std::vector<std::string>& arguments, const std::filesystem::path& folder,
             const std::filesystem::path& log);
  ~JobProcess();  // kills the process if it still runs, and waits for its end
  JobProcess(JobProcess&& other) noexcept;
  JobProcess(const JobProcess&) = delete;
  JobProcess& operator=(const JobProcess&) = delete;
  JobProcess& operator=(JobProcess&&) = delete;

  // Returns its exit status if it has ended (128 + signal after a signal). Does not wait.
  std::optional<int> Ended();
  int Wait();

  double wall_s() const;

 private:
  std::optional<int> Collect(int options);

  pid_t process_ = -1;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

// Returns the last sentence of the program in its log; empty if there is none.
std::string LastSentence(const std::filesystem::path& log);

}  // namespace sonarcal::batch
