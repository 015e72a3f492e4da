// One job of a batch as a process of this program: it ends with its parent, however that ends.
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
  // Runs `sonarcal ARGUMENTS` in `folder`, its standard output and error going to `log`, whose folder is
  // made. It is in a group of its own, so that Ctrl-C on a terminal reaches the batch alone. Throws DataError
  // where it cannot be started.
  JobProcess(const std::vector<std::string>& arguments, const std::filesystem::path& folder,
             const std::filesystem::path& log);
  ~JobProcess();  // kills it if it still runs, and waits for its end
  JobProcess(JobProcess&& other) noexcept;
  JobProcess(const JobProcess&) = delete;
  JobProcess& operator=(const JobProcess&) = delete;
  JobProcess& operator=(JobProcess&&) = delete;

  // Its exit status once it has ended (128 + signal where a signal ended it), without waiting.
  std::optional<int> Ended();
  int Wait();

  double wall_s() const;

 private:
  std::optional<int> Collect(int options);

  pid_t process_ = -1;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

// The last sentence that the program wrote to its log; empty where it wrote none.
std::string LastSentence(const std::filesystem::path& log);

}  // namespace sonarcal::batch
