#include "apps/batch/batch_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include <CLI/CLI.hpp>

#include "apps/batch/batch_ledger.h"
#include "core/types/error.h"
#include "data_io/files/hash.h"
#include "data_io/json/json_reader.h"

namespace sonarcal::batch {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPlanFormat = "sonarcal-batch/1";
constexpr std::array<std::string_view, 4> kCommands = {"simulate", "compare", "fit", "calibrate"};
constexpr std::array<std::string_view, 8> kOwnOptions = {"out",     "resume", "json",    "quiet",
                                                         "verbose", "log",    "options", "help"};
constexpr std::size_t kMaxJobs = 100'000;

// An option of an entry, in the order of the plan.
struct PlannedOption {
  std::string name;
  std::vector<std::string> values;  // words of a command line; "true" or "false" for a flag
};
using Chosen = std::vector<std::pair<std::string, std::string>>;

// Returns the result of `read`, or nullopt if the value has another type.
template <typename Read>
auto IfOfThisKind(Read read) -> std::optional<decltype(read())> {
  try {
    return read();
  } catch (const DataError&) {
    return {};
  }
}

// Converts one value to a word of a command line.
std::string WordOf(const data_io::JsonReader& value, const CLI::Option& option) {
  if (option.get_items_expected_max() == 0) return value.Bool() ? "true" : "false";
  if (const auto given = IfOfThisKind([&] { return value.Bool(); })) {
    value.Fail(fmt::format("is {}, expected a value of --{}", *given, option.get_lnames().front()));
  }
  using Limits = std::numeric_limits<std::int64_t>;
  if (const auto whole = IfOfThisKind([&] { return value.Integer(Limits::min(), Limits::max()); }))
    return fmt::format("{}", *whole);
  if (const auto number = IfOfThisKind([&] { return value.Number(); })) return fmt::format("{}", *number);
  return value.String();
}

const CLI::Option& FindOption(const CLI::App& command, const std::string& name,
                              const data_io::JsonReader& where) {
  if (std::find(kOwnOptions.begin(), kOwnOptions.end(), name) != kOwnOptions.end())
    where.Fail(fmt::format("is an option that the batch sets itself, expected one of {} --help",
                           command.get_name()));
  for (const CLI::Option* option : command.get_options()) {
    if (!option->get_lnames().empty() && option->get_lnames().front() == name) return *option;
  }
  where.Fail(fmt::format("is no option of {}, expected one of {} --help, without dashes", command.get_name(),
                         command.get_name()));
}

// Returns the ranges that {"from", "to", "step"} stands for.
std::vector<std::string> RangesOf(const data_io::JsonReader& value) {
  const auto read = [&](const char* key) {
    const double number = value.At(key).Number();
    if (number < 0.0 || number > 1e9 || number != std::floor(number))
      value.At(key).Fail(fmt::format("is {}, expected a number of a frame", number));
    return static_cast<std::int64_t>(number);
  };
  const std::int64_t from = read("from");
  const std::int64_t to = read("to");
  const std::int64_t step = read("step");
  value.Finish();
  if (from >= to || step < 1) value.Fail("has no range, expected from below to, and a step of 1 or more");
  if ((to - from) / step > static_cast<std::int64_t>(kMaxJobs))
    value.Fail(fmt::format("makes more than {} jobs", kMaxJobs));
  std::vector<std::string> ranges;
  for (std::int64_t begin = from; begin < to; begin += step)
    ranges.push_back(fmt::format("{}:{}", begin, std::min(to, begin + step)));
  return ranges;
}

std::vector<PlannedOption> ReadOptions(const data_io::JsonReader& json, const CLI::App& command, bool lists) {
  std::vector<PlannedOption> options;
  for (const auto& [name, value] : json.Members()) {
    PlannedOption option{.name = name, .values = {}};
    const CLI::Option& known = FindOption(command, name, value);
    if (value.is_object()) {
      if (!lists) value.Fail("is a list of ranges, expected one value, because each row is one job");
      option.values = RangesOf(value);
    } else if (value.is_array()) {
      if (!lists) value.Fail("is a list, expected one value, as each row is one job");
      for (const data_io::JsonReader& item : value.Items()) option.values.push_back(WordOf(item, known));
      if (option.values.empty()) value.Fail("is an empty list, expected at least one value");
    } else {
      option.values.push_back(WordOf(value, known));
    }
    options.push_back(std::move(option));
  }
  return options;
}

// Returns all combinations of the options' values, with the last option varying fastest.
std::vector<Chosen> Combinations(const std::vector<PlannedOption>& options,
                                 const data_io::JsonReader& where) {
  std::vector<Chosen> combinations = {{}};
  for (const PlannedOption& option : options) {
    if (combinations.size() * option.values.size() > kMaxJobs)
      where.Fail(fmt::format("makes more than {} jobs", kMaxJobs));
    std::vector<Chosen> longer;
    for (const Chosen& chosen : combinations) {
      for (const std::string& value : option.values) {
        longer.push_back(chosen);
        longer.back().emplace_back(option.name, value);
      }
    }
    combinations = std::move(longer);
  }
  return combinations;
}

// Replaces "{out}" by the output folders of the previous jobs, and "{option}" by the value of the only one.
std::string Filled(const std::string& text, const std::vector<const BatchJob*>& before, const fs::path& out,
                   const data_io::JsonReader& where) {
  std::vector<std::string> outputs;
  for (const BatchJob* job : before) outputs.push_back((out / job->id).string());
  const std::map<std::string, std::string> none;
  const auto& options = before.size() == 1 ? before.front()->options : none;
  std::string filled;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t open = text.find('{', at);
    filled += text.substr(at, open - at);
    if (open == std::string::npos) break;
    const std::size_t close = text.find('}', open);
    const std::string word = text.substr(open + 1, close - open - 1);
    const auto option = options.find(word);
    if (close == std::string::npos || (word != "out" && option == options.end())) {
      where.Fail(before.size() == 1 ? fmt::format("has '{}', expected {{out}} or an option of {} in braces",
                                                  text, before.front()->id)
                                    : fmt::format("has '{}', expected {{out}} in braces", text));
    }
    filled += word == "out" ? fmt::format("{}", fmt::join(outputs, ",")) : option->second;
    at = close + 1;
  }
  return filled;
}

std::vector<std::string> ArgumentsOf(const Chosen& chosen, const CLI::App& command) {
  std::vector<std::string> arguments;
  for (const auto& [name, value] : chosen) {
    const bool is_flag = command.get_option("--" + name)->get_items_expected_max() == 0;
    if (is_flag && value == "false") continue;
    arguments.push_back("--" + name);
    if (!is_flag) arguments.push_back(value);
  }
  return arguments;
}

// Words with "{out}" for the folder of the batch, which may be moved.
std::string WithoutFolder(std::string words, const fs::path& out) {
  const std::string folder = out.string() + '/';
  constexpr std::string_view kOut = "{out}/";
  for (std::size_t at = words.find(folder); at != std::string::npos;
       at = words.find(folder, at + kOut.size()))
    words.replace(at, folder.size(), kOut);
  return words;
}

// Hash of all inputs of a job: its arguments and the contents of the files that they name; for a recording
// folder, of its recording.json. For outputs of the batch itself, the key of the previous job is used.
// `digests`: cache of files already read, because many jobs name the same ones.
std::string KeyOf(const BatchJob& job, const fs::path& folder, const fs::path& out,
                  const std::string& key_before, std::map<fs::path, std::string>& digests) {
  std::string text = job.command + '\n' + key_before + '\n';
  for (const std::string& argument : job.arguments) {
    text += WithoutFolder(argument, out) + '\n';
    if (argument.starts_with(out.string() + '/')) continue;
    fs::path path = folder / argument;
    std::error_code error;
    if (fs::is_directory(path, error)) path /= "recording.json";
    if (!fs::is_regular_file(path, error)) continue;
    std::string& digest = digests[path];
    if (digest.empty()) digest = data_io::Sha256OfFile(path);
    text += digest + '\n';
  }
  return data_io::Sha256(text);
}

class Reader {
 public:
  Reader(const fs::path& file, fs::path out, const CLI::App& root)
      : root_(root), out_(std::move(out)), json_(data_io::JsonReader::FromFile(file)) {
    plan_.folder = fs::absolute(file).parent_path();
  }

  BatchPlan Read() {
    json_.CheckFormat(kPlanFormat);
    const data_io::JsonReader entries = json_.At("entries");
    for (const data_io::JsonReader& entry : entries.Items()) AddEntry(entry);
    json_.Finish();
    if (plan_.jobs.empty()) entries.Fail("is empty, expected at least one entry");
    return std::move(plan_);
  }

 private:
  void AddEntry(const data_io::JsonReader& entry) {
    const std::string name = NameOf(entry.At("name"));
    const CLI::App& command = CommandOf(entry.At("command"));
    const std::vector<PlannedOption> options =
        entry.Find("options") ? ReadOptions(*entry.Find("options"), command, /*lists=*/true)
                              : std::vector<PlannedOption>{};
    std::vector<Chosen> rows = {{}};
    if (const auto list = entry.Find("rows")) rows = ReadRows(*list, command, options);
    std::vector<std::vector<std::string>> before = {{}};  // each is what one group of jobs follows
    if (const auto other = entry.Find("for_each")) {
      before.clear();
      for (const std::string& id : JobsOf(*other)) before.push_back({id});
    }
    if (const auto others = entry.Find("for_all")) {
      if (entry.Find("for_each")) others->Fail("is given beside 'for_each', expected one of them");
      before = {JobsOf(*others)};
    }
    std::vector<std::string>& jobs = jobs_of_entry_[name];
    for (const std::vector<std::string>& ids_before : before) {
      for (const Chosen& row : rows) {
        for (Chosen& chosen : Combinations(options, entry)) {
          chosen.insert(chosen.begin(), row.begin(), row.end());
          const std::string id = fmt::format("{}/{:04}", name, jobs.size());
          AddJob(id, command.get_name(), std::move(chosen), ids_before, entry);
          jobs.push_back(id);
        }
      }
    }
  }

  const std::vector<std::string>& JobsOf(const data_io::JsonReader& entry_name) const {
    const auto found = jobs_of_entry_.find(entry_name.String());
    if (found == jobs_of_entry_.end())
      entry_name.Fail(
          fmt::format("is '{}', expected the name of an entry before this one", entry_name.String()));
    return found->second;
  }

  void AddJob(const std::string& id, const std::string& command, Chosen chosen,
              const std::vector<std::string>& ids_before, const data_io::JsonReader& entry) {
    if (plan_.jobs.size() == kMaxJobs) entry.Fail(fmt::format("makes more than {} jobs", kMaxJobs));
    BatchJob job{
        .id = id, .command = command, .options = {}, .arguments = {}, .after = ids_before, .key = {}};
    std::string key_before;
    if (!ids_before.empty()) {
      std::vector<const BatchJob*> before;
      for (const std::string& id_before : ids_before)
        before.push_back(&plan_.jobs[index_of_job_.at(id_before)]);
      for (auto& [name, value] : chosen) value = Filled(value, before, out_, entry);
      for (const BatchJob* job_before : before) key_before += job_before->key;
    }
    job.options.insert(chosen.begin(), chosen.end());
    job.arguments = ArgumentsOf(chosen, *root_.get_subcommand(command));
    job.key = KeyOf(job, plan_.folder, out_, key_before, digests_);
    index_of_job_[id] = plan_.jobs.size();
    plan_.jobs.push_back(std::move(job));
  }

  // Checks a name, which becomes a folder.
  std::string NameOf(const data_io::JsonReader& json) const {
    const std::string& name = json.String();
    const bool is_plain = !name.empty() && name.size() <= 100 && name.front() != '.' && name.front() != '-' &&
                          std::all_of(name.begin(), name.end(), [](unsigned char c) {
                            return std::isalnum(c) != 0 || c == '_' || c == '-' || c == '.';
                          });
    constexpr std::array<std::string_view, 5> kOwnNames = {kLedgerFile, kLocksFolder, kLogsFolder,
                                                           kSummaryCsvFile, kSummaryJsonFile};
    if (std::ranges::find(kOwnNames, name) != kOwnNames.end())
      json.Fail(fmt::format("is '{}', a name that the batch itself uses, expected another", name));
    if (!is_plain)
      json.Fail(fmt::format(
          "is '{}', expected letters, digits, dots, dashes and underscores, as for a folder", name));
    if (jobs_of_entry_.contains(name))
      json.Fail(fmt::format("is '{}', which another entry has already", name));
    return name;
  }

  const CLI::App& CommandOf(const data_io::JsonReader& json) const {
    const std::string& name = json.String();
    if (std::find(kCommands.begin(), kCommands.end(), name) == kCommands.end())
      json.Fail(fmt::format("is '{}', expected one of {}", name, fmt::join(kCommands, ", ")));
    return *root_.get_subcommand(name);
  }

  static std::vector<Chosen> ReadRows(const data_io::JsonReader& json, const CLI::App& command,
                                      const std::vector<PlannedOption>& options) {
    std::vector<Chosen> rows;
    for (const data_io::JsonReader& item : json.Items()) {
      Chosen row;
      for (const PlannedOption& option : ReadOptions(item, command, /*lists=*/false)) {
        for (const PlannedOption& other : options) {
          if (other.name == option.name)
            item.Fail(fmt::format("has '{}', which is also in options", other.name));
        }
        row.emplace_back(option.name, option.values.front());
      }
      rows.push_back(std::move(row));
    }
    if (rows.empty()) json.Fail("is an empty list, expected at least one row");
    return rows;
  }

  const CLI::App& root_;
  const fs::path out_;
  data_io::JsonReader json_;
  BatchPlan plan_;
  std::map<std::string, std::vector<std::string>> jobs_of_entry_;
  std::map<std::string, std::size_t> index_of_job_;
  std::map<fs::path, std::string> digests_;
};

}  // namespace

BatchPlan ReadBatchPlan(const fs::path& file, const fs::path& out, const CLI::App& root) {
  return Reader(file, out, root).Read();
}

}  // namespace sonarcal::batch
