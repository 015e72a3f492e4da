// How the time to read or refuse a file grows with its number of entries. The ratio is the time for all
// entries over the time for a quarter of them. It is 4 if each entry takes the same time, and 16 if each is
// compared with all others. Such files are too large for a fuzzer to make.
#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>

#include <nlohmann/json.hpp>

#include "core/types/error.h"
#include "data_io/files/file_bytes.h"
#include "data_io/json/json_document.h"
#include "data_io/mcap/mcap_writer.h"
#include "data_io/open_recording.h"
#include "data_io/parameters/camera_io.h"
#include "data_io/parameters/parameters_io.h"
#include "data_io/scenes/cad_io.h"
#include "data_io/scenes/scene_io.h"
#include "data_io/sonars/frame_tree.h"
#include "data_io/trajectory_io.h"
#include "tests/benchmarks/benchmark_world.h"

namespace sonarcal::benchmarks {
namespace {

namespace fs = std::filesystem;

// Joins entry(0) to entry(count - 1).
template <typename Entry>
std::string Entries(int count, const std::string& between, const Entry& entry) {
  std::string text;
  for (int i = 0; i < count; ++i) {
    if (i > 0) text += between;
    text += entry(i);
  }
  return text;
}

std::string JsonOfKeys(int count) {
  return fmt::format("{{{}}}", Entries(count, ",", [](int i) { return fmt::format(R"("k{}":0)", i); }));
}

std::string YamlOfKeys(int count) {
  return Entries(count, "", [](int i) { return fmt::format("k{}:\n", i); });
}

std::string XmlOfKeys(int count) {
  return fmt::format("<opencv_storage>{}</opencv_storage>",
                     Entries(count, "", [](int i) { return fmt::format("<k{}/>", i); }));
}

std::string Materials(int count) {
  const auto material = [](int i) {
    return fmt::format(R"("m{}": {{"gsab": {{"A": 90, "B_deg": 4, "C": 100, "D": 1, "E": 90, "F_deg": 8}}}})",
                       i);
  };
  return fmt::format(R"({{"format": "sonar-parameters/1", "model": "paper", "materials": {{{}}}}})",
                     Entries(count, ",", material));
}

std::string Nodes(int count) {
  return fmt::format(
      R"({{"asset": {{"version": "2.0"}}, "scene": 0, "scenes": [{{"nodes": [{}]}}], "nodes": [{}]}})",
      Entries(count, ",", [](int i) { return std::to_string(i); }),
      Entries(count, ",", [](int) { return std::string("{}"); }));
}

std::string Groups(int count) {
  return "v 0 0 0\nv 1 0 0\nv 0 1 0\n" +
         Entries(count, "", [](int i) { return fmt::format("o p{}\nusemtl m{}\nf 1 2 3\n", i, i % 4000); });
}

std::string Solids(int count) {
  return Entries(count, "", [](int i) { return fmt::format("solid s{}\nendsolid\n", i); });
}

std::string TrajectoryRows(int count) {
  return Entries(count, "", [](int i) { return fmt::format("{} 0 0 0 0 0 0 1\n", i); });
}

std::string TopicsOfMcap(int count) {
  const fs::path file = fs::temp_directory_path() / fmt::format("sonarcal_large_inputs_{}.mcap", getpid());
  data_io::McapWriter writer(file, "", "");
  for (int i = 0; i < count; ++i) {
    writer.AddChannel({.topic = fmt::format("/t{}", i),
                       .message_encoding = "cdr",
                       .schema_name = "std_msgs/msg/String",
                       .schema_encoding = "ros2msg",
                       .schema = "string data"});
  }
  writer.Close();
  std::string bytes = data_io::ReadFileBytes(file, std::size_t{1} << 30);
  fs::remove(file);
  return bytes;
}

struct Reader {
  const char* name;
  int entries;  // the larger number
  std::string (*text)(int entries);
  const char* file;
  void (*read)(const fs::path& file, const std::string& text);
};

constexpr Reader kReaders[] = {
    {"KeysOfParameters", 200'000, JsonOfKeys, "params.json",
     [](const fs::path& file, const std::string&) { data_io::ReadParameters(file); }},
    {"Materials", 100'000, Materials, "params.json",
     [](const fs::path& file, const std::string&) { data_io::ReadParameters(file); }},
    {"KeysOfProvenance", 200'000, JsonOfKeys, "provenance.json",
     [](const fs::path&, const std::string& text) { data_io::ParseLeniently(text); }},
    {"KeysOfCameraYaml", 100'000, YamlOfKeys, "camera.yaml",
     [](const fs::path&, const std::string& text) { data_io::CameraFromText(text, "camera.yaml"); }},
    {"KeysOfCameraXml", 80'000, XmlOfKeys, "camera.xml",
     [](const fs::path&, const std::string& text) { data_io::CameraFromText(text, "camera.xml"); }},
    {"KeysOfFrameTree", 100'000, YamlOfKeys, "tree.yaml",
     [](const fs::path& file, const std::string&) { data_io::FrameTree{file}; }},
    {"NodesOfGltf", 100'000, Nodes, "scene.gltf",
     [](const fs::path& file, const std::string&) { data_io::ReadGltf(file); }},
    {"GroupsOfObj", 200'000, Groups, "scene.obj",
     [](const fs::path&, const std::string& text) { data_io::ParseObj(text, "scene.obj"); }},
    {"SolidsOfStl", 4000, Solids, "scene.stl",
     [](const fs::path&, const std::string& text) { data_io::ParseStl(text, "scene.stl"); }},
    {"RowsOfTrajectory", 400'000, TrajectoryRows, "trajectory.txt",
     [](const fs::path& file, const std::string&) {
       data_io::ReadTrajectory(file, data_io::GuessTrajectoryFormat(file));
     }},
    {"TopicsOfMcap", 65'000, TopicsOfMcap, "bag.mcap",
     [](const fs::path& file, const std::string&) { data_io::OpenRecording(file); }},
};

// Shortest of five times. Other programs on the machine can only make a time longer.
double ReadSeconds(const Reader& reader, int entries, const fs::path& folder) {
  constexpr int kRounds = 5;
  const fs::path file = folder / reader.file;
  const std::string text = reader.text(entries);
  std::ofstream(file, std::ios::binary) << text;
  double least_s = std::numeric_limits<double>::infinity();
  for (int round = 0; round < kRounds; ++round) {
    const double began = Now();
    try {
      reader.read(file, text);
    } catch (const DataError&) {
      // Most of these files are refused, after all of their entries have been read.
    }
    least_s = std::min(least_s, Now() - began);
  }
  return least_s;
}

void LargeInput(benchmark::State& state, const Reader& reader) {
  const fs::path folder = fs::temp_directory_path() / fmt::format("sonarcal_large_inputs_{}", getpid());
  fs::create_directories(folder);
  while (state.KeepRunning()) {
    const double few_s = ReadSeconds(reader, reader.entries / 4, folder);
    const double many_s = ReadSeconds(reader, reader.entries, folder);
    state.counters["entries"] = reader.entries;
    state.counters["time_ms"] = 1e3 * many_s;
    state.counters["growth"] = many_s / few_s;
    state.counters["limit"] = 8.0;
  }
  fs::remove_all(folder);
}

[[maybe_unused]] const bool kRegistered = [] {
  for (const Reader& reader : kReaders) {
    benchmark::RegisterBenchmark(fmt::format("LargeInput/{}", reader.name).c_str(),
                                 [&reader](benchmark::State& state) { LargeInput(state, reader); })
        ->Iterations(1)
        ->Unit(benchmark::kMillisecond);
  }
  return true;
}();

}  // namespace
}  // namespace sonarcal::benchmarks
