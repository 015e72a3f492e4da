// Ledger of a batch: started and finished jobs, one JSON object per line. Lines are only appended, so that a
// batch that was killed at any moment can continue. Several processes may write to it, also from several
// machines that share the folder.
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

// Files and folders of a batch beside the outputs of its jobs.
inline constexpr const char* kLedgerFile = "ledger.jsonl";
inline constexpr const char* kLocksFolder = "locks";
inline constexpr const char* kLogsFolder = "logs";
inline constexpr const char* kSummaryCsvFile = "summary.csv";
inline constexpr const char* kSummaryJsonFile = "summary.json";

struct LedgerState {
  enum class Event { kStarted, kDone, kFailed };
  Event event = Event::kStarted;  // latest event
  std::string key;
  int status = 0;
  double wall_s = 0.0;
  std::string why;
};

class BatchLedger {
 public:
  // `folder` must exist. The ledger is its ledger.jsonl, which may be missing.
  explicit BatchLedger(const std::filesystem::path& folder) : file_(folder / kLedgerFile) {}

  const std::filesystem::path& file() const { return file_; }

  // Throws DataError if the folder holds files, but is not that of a batch.
  void CheckFolder() const;

  // Returns the states per job, including lines of other processes since the last call. Ignores an incomplete
  // last line, such as after a power failure. Throws DataError for any other invalid line.
  const std::map<std::string, LedgerState>& Read();

  // Append a line. Return when it is on the disk.
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

// Lock on a job, exclusive among all processes that run the batch, during its lifetime. Its file remains.
class JobLock {
 public:
  // `wait`: waits until the job is free. Otherwise held() returns whether it was free.
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
