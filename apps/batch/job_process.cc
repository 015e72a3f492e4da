#include "apps/batch/job_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <fstream>
#include <system_error>

#include "core/types/error.h"

namespace sonarcal::batch {
namespace {

namespace fs = std::filesystem;
constexpr int kCouldNotStart = 127;

// Runs between fork and exec, so it calls only functions that are safe in a program with threads.
[[noreturn]] void Become(const char* program, char* const* arguments, const char* folder, int log,
                         pid_t parent) {
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(kCouldNotStart);  // the parent ended before the line above
  sigset_t none;
  sigemptyset(&none);
  pthread_sigmask(SIG_SETMASK, &none, nullptr);
  if (chdir(folder) != 0 || dup2(log, STDOUT_FILENO) < 0 || dup2(log, STDERR_FILENO) < 0)
    _exit(kCouldNotStart);
  execv(program, arguments);
  _exit(kCouldNotStart);
}

}  // namespace

JobProcess::JobProcess(const std::vector<std::string>& arguments, const fs::path& folder,
                       const fs::path& log) {
  fs::create_directories(log.parent_path());
  const int descriptor = open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (descriptor < 0) throw DataError("{}: {}", log.string(), std::generic_category().message(errno));
  const std::string program = fs::read_symlink("/proc/self/exe").string();
  std::vector<std::string> words = {"sonarcal"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  const pid_t parent = getpid();
  process_ = fork();
  if (process_ == 0) Become(program.c_str(), pointers.data(), folder.c_str(), descriptor, parent);
  const int fault = errno;
  close(descriptor);
  if (process_ < 0) throw DataError("cannot start a process: {}", std::generic_category().message(fault));
}

JobProcess::JobProcess(JobProcess&& other) noexcept : process_(other.process_), start_(other.start_) {
  other.process_ = -1;
}

JobProcess::~JobProcess() {
  if (process_ < 0) return;
  kill(process_, SIGKILL);
  Collect(0);
}

std::optional<int> JobProcess::Collect(int options) {
  int status = 0;
  pid_t ended = 0;
  do {
    ended = waitpid(process_, &status, options);
  } while (ended < 0 && errno == EINTR);
  if (ended == 0) return {};
  process_ = -1;
  if (ended < 0) return kCouldNotStart;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

std::optional<int> JobProcess::Ended() {
  return Collect(WNOHANG);
}

int JobProcess::Wait() {
  return *Collect(0);
}

double JobProcess::wall_s() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

std::string LastSentence(const fs::path& log) {
  constexpr std::string_view kBeginning = "sonarcal: ";
  std::ifstream stream(log);
  std::string last;
  for (std::string line; std::getline(stream, line);) {
    if (line.starts_with(kBeginning)) last = line.substr(kBeginning.size());
  }
  return last;
}

}  // namespace sonarcal::batch
