#include "data_io/ros/ros2_bag.h"

#include <sqlite3.h>

#include <algorithm>
#include <limits>
#include <map>
#include <mutex>
#include <utility>

#include "core/types/error.h"
#include "core/types/printable.h"
#include "data_io/files/byte_reader.h"
#include "data_io/files/compression.h"

namespace sonarcal::data_io {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMinRowBytes = 4;  // min size of any row in the file

std::string ImmutableUri(const fs::path& file) {
  std::string uri = "file:";
  for (const char c : fs::absolute(file).string()) {
    const bool plain = (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') ||
                       c == '/' || c == '.' || c == '_' || c == '-';
    uri += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return uri + "?immutable=1";
}

// One file of a bag. Not thread-safe.
class Database {
 public:
  explicit Database(const fs::path& file) : file_(file), size_(RegularFileSize(file_.path())) {
    const int opened = sqlite3_open_v2(ImmutableUri(file_.path()).c_str(), &db_,
                                       SQLITE_OPEN_READONLY | SQLITE_OPEN_URI | SQLITE_OPEN_NOMUTEX, nullptr);
    handle_.reset(db_);
    if (opened != SQLITE_OK) Fail("cannot be opened");
    // Disables features that a malicious schema could use.
    sqlite3_db_config(db_, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
    sqlite3_db_config(db_, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
    sqlite3_db_config(db_, SQLITE_DBCONFIG_ENABLE_TRIGGER, 0, nullptr);
    sqlite3_db_config(db_, SQLITE_DBCONFIG_ENABLE_VIEW, 0, nullptr);
    const std::uint64_t longest = std::min(kMaxBagMessageBytes, size_) + 1000;
    sqlite3_limit(db_, SQLITE_LIMIT_LENGTH, static_cast<int>(longest));
    sqlite3_progress_handler(db_, kStepsACall, &Database::StepsAreSpent, this);
    sqlite3_exec(db_, "PRAGMA cell_size_check=ON; PRAGMA mmap_size=0", nullptr, nullptr, nullptr);
  }
  ~Database() = default;
  // Not copyable, because SQLite holds the object's address.
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  std::string name() const { return file_.name(); }
  std::uint64_t size() const { return size_; }

  // Calls `take` with the statement for every row. Throws DataError if there are more rows than the file can
  // hold.
  template <typename Take>
  void ForEachRow(const char* sql, Take take) {
    sqlite3_stmt* prepared = nullptr;
    steps_ = 0;
    if (sqlite3_prepare_v2(db_, sql, -1, &prepared, nullptr) != SQLITE_OK)
      Fail("is no bag of ROS 2, or a damaged one");
    const std::unique_ptr<sqlite3_stmt, int (*)(sqlite3_stmt*)> statement(prepared, sqlite3_finalize);
    std::uint64_t rows = 0;
    int status = SQLITE_OK;
    while ((status = sqlite3_step(prepared)) == SQLITE_ROW) {
      if (++rows > size_ / kMinRowBytes)
        throw DataError("{}: a table has more rows than {} bytes can hold: damaged", name(), size_);
      take(prepared);
    }
    if (status != SQLITE_DONE) Fail("is damaged");
  }

  // Requires an ordinary table: a view or a virtual table would execute SQL of the file.
  void RequireTable(const std::string& table) {
    int ordinary = 0;
    ForEachRow("SELECT name, type, sql FROM sqlite_master", [&](sqlite3_stmt* row) {
      const bool is_virtual = Text(row, 2).find("VIRTUAL") != std::string::npos;
      if (Text(row, 0) == table && Text(row, 1) == "table" && !is_virtual) ++ordinary;
    });
    if (ordinary != 1)
      throw DataError("{}: no table '{}', expected the tables of a ROS 2 bag", name(), table);
  }

  static std::string Text(sqlite3_stmt* row, int column) {
    const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(row, column));
    if (text == nullptr) return {};
    return {text, static_cast<std::size_t>(sqlite3_column_bytes(row, column))};
  }

  std::vector<std::byte> ReadData(std::int64_t row, std::uint64_t wanted_bytes) {
    sqlite3_blob* opened = nullptr;
    steps_ = 0;
    const int status = sqlite3_blob_open(db_, "main", "messages", "data", row, 0, &opened);
    const std::unique_ptr<sqlite3_blob, int (*)(sqlite3_blob*)> blob(opened, sqlite3_blob_close);
    const std::string what = fmt::format("message of row {}", row);
    if (status != SQLITE_OK) Fail(what + " cannot be read");
    const auto bytes = static_cast<std::uint64_t>(sqlite3_blob_bytes(opened));
    if (bytes > std::min(kMaxBagMessageBytes, size_)) {
      throw DataError("{}: {}: {} bytes, expected at most {}", name(), what, bytes,
                      std::min(kMaxBagMessageBytes, size_));
    }
    std::vector<std::byte> data(std::min(bytes, wanted_bytes));
    if (sqlite3_blob_read(opened, data.data(), static_cast<int>(data.size()), 0) != SQLITE_OK)
      Fail(what + " is damaged");
    return data;
  }

 private:
  static constexpr int kStepsACall = 100'000;

  // A cyclic tree of pages would never end. A valid file needs at most about one step per byte.
  static int StepsAreSpent(void* self) {
    auto* database = static_cast<Database*>(self);
    database->steps_ += kStepsACall;
    return database->steps_ > database->size_ + 100 * std::uint64_t{kStepsACall} ? 1 : 0;
  }

  [[noreturn]] void Fail(const std::string& what) const {
    throw DataError("{}: {}: {}", name(), what, Printable(sqlite3_errmsg(db_)));
  }

  PlainFile file_;
  std::uint64_t size_;
  sqlite3* db_ = nullptr;
  std::unique_ptr<sqlite3, int (*)(sqlite3*)> handle_{nullptr, sqlite3_close};
  std::uint64_t steps_ = 0;
};

class Ros2Bag final : public Bag {
 public:
  explicit Ros2Bag(const std::vector<fs::path>& files) {
    for (const fs::path& file : files) {
      databases_.push_back(std::make_unique<Database>(file));
      Index(databases_.size() - 1);
      std::error_code error;
      const fs::path log = fs::path(file) += "-wal";
      if (fs::exists(log, error) && fs::file_size(log, error) > 0) {
        notes_.push_back(fmt::format(
            "{} stands beside the bag: messages that are still in this log are not read.", log.string()));
      }
    }
    for (std::size_t i = 0; i < topics_.size(); ++i) {
      topics_[i].count = messages_[i].size();
      std::sort(messages_[i].begin(), messages_[i].end());
    }
  }

  std::string format() const override { return "ROS 2 bag"; }
  const std::vector<BagTopic>& topics() const override { return topics_; }
  const std::vector<std::string>& notes() const override { return notes_; }
  std::vector<BagMessage> Messages(std::size_t topic) const override { return messages_.at(topic); }

  std::vector<std::byte> Read(const BagMessage& message, std::uint64_t wanted_bytes) const override {
    const std::lock_guard lock(mutex_);
    Database& database = *databases_.at(message.container);
    return InflatedMessage(
        database.ReadData(message.position, wanted_bytes), wanted_bytes,
        [&] { return database.ReadData(message.position, std::numeric_limits<std::uint64_t>::max()); },
        fmt::format("{}: message of row {}", database.name(), message.position));
  }

 private:
  void Index(std::size_t file) {
    Database& database = *databases_[file];
    database.RequireTable("topics");
    database.RequireTable("messages");
    std::map<std::int64_t, std::size_t> topic_of_id;
    database.ForEachRow("SELECT id, name, type, serialization_format FROM topics", [&](sqlite3_stmt* row) {
      const std::string name = Database::Text(row, 1);
      if (Database::Text(row, 3) != "cdr") {
        notes_.push_back(fmt::format("Topic {} is serialised as '{}', not as cdr, and was left out.",
                                     Printable(name), Printable(Database::Text(row, 3))));
        return;
      }
      topic_of_id[sqlite3_column_int64(row, 0)] = TopicIndex(name, Ros1TypeName(Database::Text(row, 2)));
    });
    std::uint64_t nameless = 0;
    database.ForEachRow("SELECT id, topic_id, timestamp FROM messages", [&](sqlite3_stmt* row) {
      const auto topic = topic_of_id.find(sqlite3_column_int64(row, 1));
      if (topic == topic_of_id.end()) {
        ++nameless;
        return;
      }
      messages_[topic->second].push_back({.log_time_ns = sqlite3_column_int64(row, 2),
                                          .container = file,
                                          .position = sqlite3_column_int64(row, 0)});
    });
    if (nameless > 0) {
      notes_.push_back(
          fmt::format("{}: {} messages are of no known topic and were left out.", database.name(), nameless));
    }
  }

  std::size_t TopicIndex(const std::string& name, const std::string& type) {
    for (std::size_t i = 0; i < topics_.size(); ++i) {
      if (topics_[i].name == name && topics_[i].type == type) return i;
    }
    topics_.push_back({name, type, 0, MessageEncoding::kCdr});
    messages_.emplace_back();
    return topics_.size() - 1;
  }

  std::vector<std::unique_ptr<Database>> databases_;
  std::vector<BagTopic> topics_;
  std::vector<std::vector<BagMessage>> messages_;  // per topic
  std::vector<std::string> notes_;
  mutable std::mutex mutex_;
};

}  // namespace

std::unique_ptr<Bag> OpenRos2Bag(const std::vector<fs::path>& files) {
  return std::make_unique<Ros2Bag>(files);
}

}  // namespace sonarcal::data_io
