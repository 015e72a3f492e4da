#include "apps/cli/provenance.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include <nlohmann/json.hpp>

#include "apps/cli/command.h"
#include "apps/cli/messages.h"
#include "apps/cli/options_file.h"
#include "apps/cli/run_output.h"
#include "core/types/error.h"
#include "data_io/files/folder_exchange.h"
#include "data_io/files/hash.h"
#include "data_io/json/json_writer.h"

namespace sonarcal::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// True for what programs write into a folder while it is read: staged outputs (data_io/files/atomic_output.h)
// and the folder of this run.
bool IsOutput(const fs::directory_entry& entry) {
  return data_io::IsStagedName(entry.path().filename().string()) ||
         (entry.is_directory() && IsBeingWritten(entry.path()));
}

Json InputToJson(const fs::path& input) {
  if (!fs::is_directory(input)) {
    if (!fs::exists(input)) throw DataError("{}: no such file or folder", input.string());
    return {
        {"path", input.string()}, {"bytes", fs::file_size(input)}, {"sha256", data_io::Sha256OfFile(input)}};
  }
  std::vector<fs::path> files;
  for (fs::recursive_directory_iterator entry(input), end; entry != end; ++entry) {
    if (IsOutput(*entry)) {
      entry.disable_recursion_pending();
    } else if (entry->is_regular_file()) {
      files.push_back(entry->path());
    }
  }
  std::sort(files.begin(), files.end());
  std::uintmax_t byte_count = 0;
  std::string manifest;
  for (const fs::path& file : files) {
    byte_count += fs::file_size(file);
    manifest += data_io::Sha256OfFile(file) + "  " + file.lexically_relative(input).generic_string() + '\n';
  }
  return {{"path", input.string()},
          {"files", files.size()},
          {"bytes", byte_count},
          {"sha256", data_io::Sha256(manifest)}};
}

}  // namespace

Json ProvenanceToJson(const Provenance& provenance) {
  Json json = {{"format", "sonarcal-provenance/1"}, {"program", "sonarcal"},
               {"version", SONARCAL_VERSION},       {"command", provenance.command},
               {"command_line", CommandLine()},     {"configuration", provenance.configuration}};
  if (provenance.seed) json["seed"] = *provenance.seed;
  if (!provenance.made_of.is_null()) json["made_of"] = provenance.made_of;
  json["inputs"] = Json::array();
  for (const fs::path& input : provenance.inputs) {
    if (!input.empty()) json["inputs"].push_back(InputToJson(input));
  }
  if (!OptionsFile().empty()) json["inputs"].push_back(InputToJson(OptionsFile()));
  return json;
}

void WriteProvenance(const fs::path& folder, const Provenance& provenance) {
  const Json json = ProvenanceToJson(provenance);
  for (const Json& input : json["inputs"]) {
    const std::string files =
        input.contains("files") ? fmt::format("{} files, ", input["files"].get<int>()) : "";
    PrintDetail(fmt::format("read {} ({}{} bytes)", input["path"].get<std::string>(), files,
                            input["bytes"].get<std::uintmax_t>()));
  }
  data_io::WriteJson(folder / "provenance.json", json);
}

}  // namespace sonarcal::cli
