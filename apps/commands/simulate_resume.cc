#include "apps/commands/simulate_resume.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <optional>
#include <string_view>
#include <system_error>

#include <nlohmann/json.hpp>

#include "core/types/error.h"
#include "data_io/files/file_bytes.h"
#include "data_io/files/hash.h"
#include "data_io/json/json_document.h"
#include "data_io/parameters/parameters_io.h"
#include "data_io/recordings/recording_io.h"
#include "data_io/recordings/recording_json.h"

namespace sonarcal::commands {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// Data compared by digest: the message can only state that they differ.
constexpr const char* kDigests[] = {"scene", "sonar", "parameters", "poses"};
// Names of the options that determine the output. The other options are paths and threads; FramesMadeOf takes
// the seed that is used.
std::vector<std::string> NamesOfOptions() {
  std::vector<std::string> names;
  const workflow::SimulateOptions options;
  workflow::SimulateOptions::Visit(options, [&](const OptionInfo& info, const auto&) {
    if (info.name != "threads" && info.name != "seed") names.push_back(info.name);
  });
  names.insert(names.end(), {"fan", "depth", "frames"});
  return names;
}

template <typename T>
std::string DigestOf(const std::vector<T>& values) {
  return data_io::Sha256({reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)});
}

std::string TextOf(const nlohmann::json& value) {
  if (value.is_null() || (value.is_array() && value.empty())) return "none";
  return value.is_string() ? value.get<std::string>() : value.dump();
}

// Describes the differences between two runs; empty if they are equal.
std::string Differences(const nlohmann::json& then, const Json& now) {
  std::string text;
  for (const auto& [key, member] : now.items()) {
    const nlohmann::json value = member;
    const nlohmann::json before = then.contains(key) ? then[key] : nlohmann::json();
    if (before == value) continue;
    const bool is_digest = std::find(std::begin(kDigests), std::end(kDigests), key) != std::end(kDigests);
    text += text.empty() ? "" : ", ";
    text += is_digest ? fmt::format("other contents of '{}'", key)
                      : fmt::format("{} {} (now {})", key, TextOf(before), TextOf(value));
  }
  return text;
}

// Reads "made_of" of the frames in a folder; nullopt without frames.
std::optional<nlohmann::json> ReadMadeOf(const fs::path& folder) {
  const fs::path file = folder / "provenance.json";
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return std::nullopt;
  const nlohmann::json json = data_io::ParseLeniently(data_io::ReadFileBytes(file, data_io::kMaxJsonBytes));
  if (!json.is_object() || !json.contains("made_of") || !json["made_of"].is_object()) {
    throw DataError(
        "{}: does not state the inputs of the frames, expected the provenance of an unfinished 'sonarcal "
        "simulate'",
        file.string());
  }
  return json["made_of"];
}

// False for a file that a power failure left empty or, if it is a PNG, without its end.
bool IsWhole(const fs::path& file) {
  constexpr std::string_view kEndOfPng("IEND\xae\x42\x60\x82", 8);
  std::ifstream stream(file, std::ios::binary | std::ios::ate);
  if (!stream || stream.tellg() <= 0) return false;
  if (file.extension() != ".png") return true;
  std::array<char, kEndOfPng.size()> end{};
  stream.seekg(-static_cast<std::streamoff>(end.size()), std::ios::end);
  stream.read(end.data(), end.size());
  return stream && std::string_view(end.data(), end.size()) == kEndOfPng;
}

}  // namespace

std::string SceneDigest(const Scene& scene) {
  std::string parts =
      DigestOf(scene.vertices_m) + DigestOf(scene.triangles) + DigestOf(scene.triangle_material);
  for (const std::string& name : scene.material_names) parts += name + '\n';
  return data_io::Sha256(parts);
}

Json FramesMadeOf(const workflow::SimulatedRecording& recording, const std::string& scene_digest,
                  const ParameterSet& parameters, const cli::Provenance& provenance) {
  data_io::RecordingHeader header{recording.info(), 8, {}};
  for (int index = 0; index < recording.frame_count(); ++index) {
    header.frames.push_back(recording.frame_info(index));
  }
  const Json json = data_io::RecordingJson(header, "/");
  Json made_of = {{"program", "sonarcal " SONARCAL_VERSION},
                  {"scene", scene_digest},
                  {"sonar", data_io::Sha256(json["sonar"].dump())},
                  {"water", json["water"]},
                  {"parameters", data_io::Sha256(data_io::ParametersJson(parameters).dump())},
                  {"poses", data_io::Sha256(json["frames"].dump())},
                  {"frames", recording.frame_count()}};
  for (const std::string& key : NamesOfOptions()) {
    if (provenance.configuration.contains(key)) made_of[key] = provenance.configuration[key];
  }
  if (provenance.seed) made_of["seed"] = *provenance.seed;
  return made_of;
}

FinishedFrames::FinishedFrames(const cli::RunOutput& output, const Json& made_of) {
  const auto check = [&](const nlohmann::json& then) {
    const std::string differences = Differences(then, made_of);
    if (differences.empty()) return;
    throw DataError("{}: cannot be resumed: it was made with {}", output.final_path().string(), differences);
  };
  if (const auto then = ReadMadeOf(output.staging())) {
    check(*then);
    aside_ = output.staging();
  }
  const fs::path folder = output.final_path();
  if (!data_io::IsRecordingFolder(folder)) return;
  const auto then = ReadMadeOf(folder);
  if (!then || *then != nlohmann::json(made_of)) {
    if (!aside_.empty()) return;  // will be replaced by the staged frames
    if (then) check(*then);
    throw DataError("{}: cannot be resumed: it holds a recording, but no provenance.json", folder.string());
  }
  folder_ = folder;
  const auto recording = data_io::OpenRecordingFolder(folder);
  for (int index = 0; index < recording->frame_count(); ++index) {
    images_in_folder_.insert(recording->frame_info(index).name);
  }
}

bool FinishedFrames::Has(const std::string& image, const std::vector<std::string>& beside) const {
  const auto lie_in = [&](const fs::path& folder) {
    return IsWhole(folder / image) &&
           std::ranges::all_of(beside, [&](const std::string& file) { return IsWhole(folder / file); });
  };
  return (!aside_.empty() && lie_in(aside_)) || (images_in_folder_.contains(image) && lie_in(folder_));
}

}  // namespace sonarcal::commands
