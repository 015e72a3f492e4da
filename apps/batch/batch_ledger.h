// The ledger of a batch: what was begun and what is done, one JSON object a line, only ever added to, so that
// a batch killed at any moment goes on where it was. Several processes, of several machines that share the
// folder, may write to it.
//
//   {"job": "tank/0003", "key": "9f2c...", "event": "started"}
//   {"job": "tank/0003", "key": "9f2c...", "event": "done", "status": 0, "wall_s": 1.25}
//   {"job": "tank/0004", "key": "77ab...", "event": "failed", "status": 1, "wall_s": 0.5, "why": "..."}
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

namespace sonarcal::batch {

struct LedgerState {
  enum class Event { kStarted, kDone, kFailed };
  Event event = Event::kStarted;  // the last one
  std::string key;
  int status = 0;
  double wall_s = 0.0;
  std::string why;
};

class BatchLedger {
 public:
  // `folder` is there; the ledger is its ledger.jsonl, which need not be.
  explicit BatchLedger(const std::filesystem::path& folder) : file_(folder / "ledger.jsonl") {}

  const std::filesystem::path& file() const { return file_; }

  // By job, with what was added since the last call, whoever added it. A last line that was cut off, as by a
  // power failure, counts as not written. Throws DataError for any other line that is none of a ledger.
  const std::map<std::string, LedgerState>& Read();

  // Adds a line, and returns when it lies on the disk.
  void Started(const std::string& job, const std::string& key) const;
  void Done(const std::string& job, const std::string& key, int status, double wall_s) const;
  void Failed(const std::string& job, const std::string& key, int status, double wall_s,
              const std::string& why) const;

 private:
  void Append(const std::string& line) const;

  std::filesystem::path file_;
  std::map<std::string, LedgerState> states_;
  std::uintmax_t bytes_read_ = 0;
  int lines_read_ = 0;
};

// Holds a job, among all processes that run the batch, as long as it lives. The file stays.
class JobLock {
 public:
  // `wait` waits until the job is free; otherwise held() says whether it was.
  JobLock(const std::filesystem::path& folder, const std::string& job, bool wait);
  ~JobLock();
  JobLock(JobLock&& other) noexcept : descriptor_(other.descriptor_) { other.descriptor_ = -1; }
  JobLock(const JobLock&) = delete;
  JobLock& operator=(const JobLock&) = delete;
  JobLock& operator=(JobLock&&) = delete;

  bool held() const { return descriptor_ >= 0; }

 private:
  int descriptor_ = -1;
};

}  // namespace sonarcal::batch
