#include "apps/batch/batch_ledger.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <span>
#include <system_error>

#include <nlohmann/json.hpp>

#include "core/types/error.h"
#include "data_io/files/file_bytes.h"
#include "data_io/json/json_document.h"

namespace sonarcal::batch {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

[[noreturn]] void FailOn(const fs::path& file) {
  throw DataError("{}: {}", file.string(), std::generic_category().message(errno));
}

// Owner of a file descriptor, which it closes.
class Descriptor {
 public:
  Descriptor(const fs::path& file, int flags) : number_(open(file.c_str(), flags | O_CLOEXEC, 0644)) {}
  ~Descriptor() {
    if (number_ >= 0) close(number_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  int number() const { return number_; }

 private:
  int number_;
};

void LockWhole(int descriptor, const fs::path& file) {
  while (flock(descriptor, LOCK_EX) != 0) {
    if (errno != EINTR) FailOn(file);
  }
}

LedgerState StateOf(const nlohmann::json& line) {
  const std::string event = line.at("event");
  LedgerState state;
  state.key = line.at("key");
  if (event == "started") return state;
  state.event = event == "done" ? LedgerState::Event::kDone : LedgerState::Event::kFailed;
  state.status = line.at("status");
  state.wall_s = line.at("wall_s");
  state.why = line.value("why", "");
  return state;
}

}  // namespace

void BatchLedger::CheckFolder() const {
  if (fs::exists(file_)) return;
  // A batch that was killed before its first job has only these.
  const auto is_of_batch = [](const fs::directory_entry& entry) {
    return entry.path().filename() == kLocksFolder || entry.path().filename() == kLogsFolder;
  };
  const fs::path folder = file_.parent_path();
  if (std::ranges::all_of(fs::directory_iterator(folder), is_of_batch)) return;
  throw DataError("{}: holds files and no {}, expected a new folder or that of a batch", folder.string(),
                  file_.filename().string());
}

const std::map<std::string, LedgerState>& BatchLedger::Read() {
  std::ifstream stream(file_, std::ios::binary);
  if (!stream) return states_;
  stream.seekg(static_cast<std::streamoff>(bytes_read_));
  for (std::string line; std::getline(stream, line);) {
    if (stream.eof()) break;  // incomplete line
    bytes_read_ += line.size() + 1;
    ++lines_read_;
    try {
      const auto json = data_io::ParseLeniently(line);
      states_[json.at("job")] = StateOf(json);
    } catch (const nlohmann::json::exception&) {
      throw DataError(R"({}:{}: is no line of a ledger, expected {{"job": ..., "key": ..., "event": ...}})",
                      file_.string(), lines_read_);
    }
  }
  return states_;
}

void BatchLedger::Append(const std::string& line) const {
  const Descriptor ledger(file_, O_RDWR | O_CREAT | O_APPEND);
  if (ledger.number() < 0) FailOn(file_);
  LockWhole(ledger.number(), file_);
  struct stat status = {};
  if (fstat(ledger.number(), &status) != 0) FailOn(file_);
  // Removes the incomplete last line, left by a power failure, before it appends.
  off_t whole = status.st_size;
  for (char last = 0; whole > 0; --whole) {
    if (pread(ledger.number(), &last, 1, whole - 1) != 1) FailOn(file_);
    if (last == '\n') break;
  }
  if (whole != status.st_size && ftruncate(ledger.number(), whole) != 0) FailOn(file_);
  const std::string text = line + '\n';
  if (const int error = data_io::WriteAll(ledger.number(), std::as_bytes(std::span(text))))
    throw DataError("{}: cannot be written: {}", file_.string(), std::generic_category().message(error));
  if (fsync(ledger.number()) != 0) FailOn(file_);
}

void BatchLedger::Started(const std::string& job, const std::string& key) const {
  Append(Json{{"job", job}, {"key", key}, {"event", "started"}}.dump());
}

void BatchLedger::Done(const std::string& job, const std::string& key, int status, double wall_s) const {
  Append(Json{{"job", job}, {"key", key}, {"event", "done"}, {"status", status}, {"wall_s", wall_s}}.dump());
}

void BatchLedger::Failed(const std::string& job, const std::string& key, int status, double wall_s,
                         const std::string& why) const {
  const Json line = {{"job", job},       {"key", key},       {"event", "failed"},
                     {"status", status}, {"wall_s", wall_s}, {"why", why}};
  Append(line.dump(-1, ' ', false, Json::error_handler_t::replace));
}

JobLock::JobLock(const fs::path& folder, const std::string& job, bool wait) {
  fs::path file = folder / kLocksFolder / job;
  file += ".lock";
  fs::create_directories(file.parent_path());
  descriptor_ = open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (descriptor_ < 0) FailOn(file);
  int locked = 0;
  do {
    locked = flock(descriptor_, LOCK_EX | (wait ? 0 : LOCK_NB));
  } while (locked != 0 && errno == EINTR);
  if (locked == 0) return;
  const bool is_busy = errno == EWOULDBLOCK;
  close(descriptor_);
  descriptor_ = -1;
  if (!is_busy) FailOn(file);
}

JobLock::~JobLock() {
  if (descriptor_ >= 0) close(descriptor_);
}

}  // namespace sonarcal::batch
