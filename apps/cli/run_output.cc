#include "apps/cli/run_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <mutex>
#include <optional>
#include <set>
#include <system_error>
#include <utility>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "apps/cli/messages.h"
#include "core/types/error.h"
#include "data_io/files/file_bytes.h"
#include "data_io/json/json_document.h"
#include "data_io/json/json_writer.h"
#include "data_io/recordings/recording_io.h"

namespace sonarcal::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kProvenance = "provenance.json";

// Never destroyed, because the thread that waits for signals may use it while the program ends.
struct Registry {
  std::mutex mutex;
  std::set<fs::path> staging;
  std::set<fs::path> kept;  // for a later run
  std::multiset<fs::path> folders;
};

Registry& Unfinished() {
  static auto* registry = new Registry;
  return *registry;
}

bool HoldsAnything(const fs::path& folder) {
  std::error_code error;
  return std::ranges::any_of(fs::directory_iterator(folder, error), [](const fs::directory_entry& entry) {
    return !entry.path().filename().string().starts_with('.');
  });
}

struct EarlierRun {
  std::string command;
  std::set<fs::path> outputs;
};

// Run that wrote the folder, from provenance.json; nullopt if unknown.
std::optional<EarlierRun> ReadEarlierRun(const fs::path& folder) {
  const fs::path file = folder / kProvenance;
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return std::nullopt;
  const nlohmann::json json = data_io::ParseLeniently(data_io::ReadFileBytes(file, data_io::kMaxJsonBytes));
  if (!json.is_object() || json.value("program", nlohmann::json()) != "sonarcal") return std::nullopt;
  const nlohmann::json command = json.value("command", nlohmann::json());
  const nlohmann::json outputs = json.value("outputs", nlohmann::json());
  if (!command.is_string() || !outputs.is_array()) return std::nullopt;
  EarlierRun run{.command = command, .outputs = {}};
  for (const nlohmann::json& output : outputs) {
    if (output.is_string()) run.outputs.insert(output.get<std::string>());
  }
  return run;
}

// Outputs of an earlier run that the new outputs replace; nullopt if `folder` is not one of `command`.
std::optional<std::set<fs::path>> OutputsToReplace(const fs::path& folder, const std::string& command,
                                                   bool force) {
  if (folder.empty()) throw UsageError("--out '', expected a folder");
  if (!HoldsAnything(folder)) return std::set<fs::path>();
  const std::optional<EarlierRun> earlier = ReadEarlierRun(folder);
  if (earlier && earlier->command == command) return earlier->outputs;
  if (force) return std::nullopt;
  throw DataError(
      "{}: {}, expected a new or empty folder, one that 'sonarcal {}' wrote, or --force, which replaces "
      "files of the same names and leaves the others",
      folder.string(),
      earlier ? fmt::format("holds the outputs of 'sonarcal {}'", earlier->command)
              : "holds files, and no provenance.json that lists them as outputs of this program",
      command);
}

}  // namespace

void CheckOutFolder(const fs::path& folder, const std::string& command, bool force) {
  OutputsToReplace(folder, command, force);
}

void RefuseInputAsOutput(const fs::path& out, const std::vector<fs::path>& inputs) {
  std::error_code error;
  for (const fs::path& input : inputs) {
    const bool is_header =
        input.has_parent_path() && data_io::IsRecordingFolder(input) && !fs::is_directory(input);
    const fs::path read = is_header ? input.parent_path() : input;
    const bool is_in_recording = fs::is_regular_file(out, error) && data_io::IsRecordingFolder(read) &&
                                 fs::equivalent(fs::absolute(out).parent_path(), read, error);
    if (is_in_recording || fs::equivalent(out, read, error))
      throw UsageError("--out is '{}', which this command reads, expected another name", out.string());
  }
}

void CheckOutFile(const fs::path& out, const std::vector<fs::path>& inputs, bool force) {
  RefuseInputAsOutput(out, inputs);
  std::error_code error;
  if (force || !fs::exists(fs::symlink_status(out, error))) return;
  for (const char* suffix : {".provenance.json", ".account.json"}) {
    if (fs::exists(out.string() + suffix, error)) return;
  }
  throw DataError("{}: exists, and no earlier run of this command wrote it, expected a new file or --force",
                  out.string());
}

CLI::Option* AddOutFolder(CLI::App& command, fs::path& out, CommonOptions& common,
                          const std::string& description) {
  command.add_flag("--force", common.force,
                   "Write into --out although it holds other files; files of the same names are replaced");
  return command.add_option("--out", out, description)->type_name("DIR");
}

RunOutput::RunOutput(const fs::path& folder, std::string command, bool force, data_io::Aside aside)
    : command_(std::move(command)),
      force_(force),
      replaces_(OutputsToReplace(folder, command_, force).has_value()),
      directory_(folder, aside),
      staging_(directory_.staging()) {
  // Again, because `directory_` restores a folder that a killed run left aside.
  replaces_ = OutputsToReplace(folder, command_, force).has_value();
  if (!directory_.found()) Register();
  const std::lock_guard lock(Unfinished().mutex);
  if (directory_.found()) Unfinished().kept.insert(staging_);
  Unfinished().folders.insert(final_path());
}

RunOutput::RunOutput(const fs::path& folder, data_io::Aside aside)
    : directory_(folder, aside), staging_(directory_.staging()) {
  Register();
}

void RunOutput::Register() {
  const std::lock_guard lock(Unfinished().mutex);
  Unfinished().staging.insert(staging_);
  is_registered_ = true;
}

void RunOutput::Keep() {
  const std::lock_guard lock(Unfinished().mutex);
  Unfinished().staging.erase(staging_);
  Unfinished().kept.insert(staging_);
  directory_.Keep();
}

void RunOutput::Commit() {
  std::vector<std::string> written;  // for --verbose
  std::set<std::string> outputs;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(staging())) {
    if (entry.is_directory()) continue;
    const fs::path name = entry.path().lexically_relative(staging());
    written.push_back(fmt::format("wrote {} ({} bytes)", (final_path() / name).string(), entry.file_size()));
    if (name != kProvenance) outputs.insert(name.generic_string());
  }
  if (!command_.empty()) ListOutputs(std::move(outputs));
  MoveIntoPlace();
  std::ranges::sort(written);
  for (const std::string& sentence : written) PrintDetail(sentence);
}

// Writes the names into provenance.json.
void RunOutput::ListOutputs(std::set<std::string> outputs) {
  if (goes_on_) {
    for (const fs::path& name : OutputsOfEarlierRun()) outputs.insert(name.generic_string());
  }
  // Keeps the order of the members. This run wrote the file.
  auto provenance = nlohmann::ordered_json::parse(
      data_io::ReadFileBytes(staging() / kProvenance, data_io::kMaxJsonBytes), nullptr, false);
  SONARCAL_CHECK(provenance.is_object(), "{}: no provenance of this run", final_path().string());
  provenance["outputs"] = outputs;
  data_io::WriteJson(staging() / kProvenance, provenance);
}

std::set<fs::path> RunOutput::OutputsOfEarlierRun() const {
  return OutputsToReplace(final_path(), command_, force_).value_or(std::set<fs::path>());
}

// An interruption waits for the end of it, because it needs the same mutex.
void RunOutput::MoveIntoPlace() {
  Registry& registry = Unfinished();
  const std::lock_guard lock(registry.mutex);
  if (is_registered_ && !registry.staging.contains(staging_) && !registry.kept.contains(staging_)) {
    throw DataError("{}: cannot be written: interrupted", final_path().string());
  }
  if (replaces_) {
    directory_.Replace([this] { return goes_on_ ? std::set<fs::path>() : OutputsOfEarlierRun(); });
  } else {
    directory_.Commit();
  }
  registry.staging.erase(staging_);
  registry.kept.erase(staging_);
}

RunOutput::~RunOutput() {
  const std::lock_guard lock(Unfinished().mutex);
  Unfinished().staging.erase(staging_);
  Unfinished().kept.erase(staging_);
  auto& folders = Unfinished().folders;
  if (const auto folder = folders.find(final_path()); folder != folders.end()) folders.erase(folder);
}

bool IsBeingWritten(const fs::path& folder) {
  const std::lock_guard lock(Unfinished().mutex);
  return std::ranges::any_of(Unfinished().folders, [&](const fs::path& written) {
    std::error_code error;
    return fs::equivalent(written, folder, error);
  });
}

LeftOutputs RemoveUnfinishedOutputs() {
  Registry& registry = Unfinished();
  const std::lock_guard lock(registry.mutex);
  const bool any = !registry.staging.empty();
  for (const fs::path& staging : registry.staging) {
    // Repeats the removal: it fails if another thread writes a file meanwhile.
    std::error_code error;
    for (int attempt = 0; attempt < 10; ++attempt) {
      fs::remove_all(staging, error);
      if (!error) break;
    }
  }
  registry.staging.clear();
  if (!registry.kept.empty()) return LeftOutputs::kKept;
  return any ? LeftOutputs::kRemoved : LeftOutputs::kNone;
}

}  // namespace sonarcal::cli
