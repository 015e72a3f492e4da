// What the frame in plain NumPy (numpy_frame.py) starts from, and what it is compared with: the hits of
// 1500 x 1200 rays in the paper's tank, the program's own images of them, and the time they took.
//
//   sonarcal_frame_hits DIR      writes DIR/*.npy and DIR/frame.json
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <bit>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/imaging/fan_image.h"
#include "data_io/json/json_writer.h"
#include "tests/benchmarks/benchmark_world.h"

namespace sonarcal::benchmarks {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr int kNoisyFrames = 8;

// Format 1.0 of numpy.lib.format: a header padded to 64 bytes, then the numbers.
template <typename T>
void WriteNpy(const fs::path& file, const std::string& type, const std::vector<int>& shape, const T* values) {
  static_assert(std::endian::native == std::endian::little);
  std::string header = fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({},), }}", type,
                                   fmt::join(shape, ", "));
  header.append(63 - (10 + header.size()) % 64, ' ');
  header += '\n';
  const std::size_t count =
      std::accumulate(shape.begin(), shape.end(), std::size_t{1}, [](std::size_t a, int b) { return a * b; });
  std::ofstream stream(file, std::ios::binary);
  const char magic[] = {'\x93',
                        'N',
                        'U',
                        'M',
                        'P',
                        'Y',
                        1,
                        0,
                        static_cast<char>(header.size() & 0xff),
                        static_cast<char>(header.size() >> 8)};
  stream.write(magic, sizeof(magic));
  stream << header;
  stream.write(reinterpret_cast<const char*>(values), static_cast<std::streamsize>(count * sizeof(T)));
  if (!stream) throw DataError("{}: cannot be written", file.string());
}

void WriteImage(const fs::path& file, const Grid<float>& value) {
  WriteNpy(file, "<f4", {value.rows(), value.cols()}, value.values().data());
}

// Ranges (infinity for a miss), directions and normals in the sonar's frame, materials.
void WriteHits(const fs::path& folder, const sim::Simulator& simulator, const Pose& pose,
               double max_range_m) {
  const sim::RayFan& fan = simulator.fan();
  const sim::FanHits hits = simulator.caster().Cast(fan, pose, max_range_m);
  const Eigen::Matrix3f sonar_from_world = pose.rotation.toRotationMatrix().transpose().cast<float>();
  std::vector<Eigen::Vector3f> directions(fan.size());
  std::vector<Eigen::Vector3f> normals(fan.size(), Eigen::Vector3f::Zero());
  std::vector<std::uint16_t> materials(fan.size(), 0);
  for (int ray = 0; ray < fan.size(); ++ray) {
    directions[ray] = fan.Direction(ray / fan.cols(), ray % fan.cols());
    if (hits.triangle[ray] < 0) continue;
    normals[ray] = sonar_from_world * simulator.caster().TriangleNormal(hits.triangle[ray]);
    materials[ray] = simulator.caster().TriangleMaterial(hits.triangle[ray]);
  }
  WriteNpy(folder / "range_m.npy", "<f4", {fan.size()}, hits.range_m.data());
  WriteNpy(folder / "direction.npy", "<f4", {fan.size(), 3}, directions.data()->data());
  WriteNpy(folder / "normal.npy", "<f4", {fan.size(), 3}, normals.data()->data());
  WriteNpy(folder / "material.npy", "<u2", {fan.size()}, materials.data());
}

// Medians of a frame from the cast of its rays to the fan image: seconds, and processor seconds.
std::pair<double, double> FrameSeconds(const sim::Simulator& simulator, const Pose& pose, const FanMap& map) {
  std::vector<double> seconds;
  std::vector<double> cpu_seconds;
  for (int round = 0; round < 9; ++round) {
    const double began = Now();
    const std::clock_t cpu_began = std::clock();
    const FanImage fan = map.Apply(simulator.Render(pose, Parameters(), round));
    cpu_seconds.push_back(static_cast<double>(std::clock() - cpu_began) / CLOCKS_PER_SEC);
    seconds.push_back(Now() - began);
  }
  return {Median(seconds), Median(cpu_seconds)};
}

Json FrameJson(const sim::Simulator& simulator, const FanMap& map) {
  const ParameterSet parameters = Parameters();
  const PolarAxes& axes = simulator.sonar().axes;
  Json json = {{"range_min_m", axes.range_min_m},
               {"range_max_m", axes.range_max_m},
               {"range_bins", axes.range_bins},
               {"beam_azimuth_rad", axes.beam_azimuth_rad},
               {"frequency_hz", simulator.sonar().frequency_hz},
               {"absorption_db_per_m", simulator.absorption_db_per_m()},
               {"source_level_db", parameters.source_level_db},
               {"db_min", parameters.display.db_min},
               {"db_max", parameters.display.db_max},
               {"full_scale", simulator.options().full_scale()}};
  for (const std::string& name : simulator.caster().material_names()) {
    const auto& gsab = parameters.Material(name).gsab;
    json["gsab"].push_back({gsab.a, gsab.b_deg, gsab.c, gsab.d, gsab.e, gsab.f_deg});
  }
  json["jitter"] = {{"sigma_range_m", parameters.jitter.sigma_range_m},
                    {"sigma_azimuth_deg", parameters.jitter.sigma_azimuth_deg},
                    {"reference_range_m", parameters.jitter.reference_range_m},
                    {"reference_frequency_hz", parameters.jitter.reference_frequency_hz}};
  const FanAxes& fan = map.axes();
  json["fan"] = {{"rows", fan.rows},
                 {"cols", fan.cols},
                 {"pixel_m", fan.pixel_m},
                 {"x_min_m", fan.x_min_m},
                 {"y_max_m", fan.y_max_m}};
  return json;
}

void WriteAll(const fs::path& folder) {
  fs::create_directories(folder);
  const sim::SonarPreset& preset = sim::FindSonarPreset("p900-45");
  const Scene scene = Tank(300'000);
  const Pose pose = sim::MockupTankPoses(3).front();
  const FanMap map(preset.sonar.axes, FanAxesFor(preset.sonar.axes, {}));
  sim::SimulationOptions options = Options(preset, kPaperRays);
  const sim::Simulator noisy(scene, preset.sonar, options);
  options.noise = false;
  const sim::Simulator clean(scene, preset.sonar, options);
  WriteHits(folder, clean, pose, preset.sonar.axes.range_max_m);
  const PolarImage image = clean.Render(pose, Parameters());
  WriteImage(folder / "polar.npy", image.value);
  WriteImage(folder / "fan.npy", map.ApplyNearest(image.value));
  for (int i = 0; i < kNoisyFrames; ++i) {
    WriteImage(folder / fmt::format("noisy_{}.npy", i), noisy.Render(pose, Parameters(), i).value);
  }
  Json json = FrameJson(clean, map);
  json["frame_s"] = FrameSeconds(noisy, pose, map).first;
  {
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    json["frame_cpu_s"] = FrameSeconds(noisy, pose, map).second;
  }
  data_io::WriteJson(folder / "frame.json", json);
}

}  // namespace
}  // namespace sonarcal::benchmarks

int main(int argc, char** argv) {
  if (argc != 2) {
    fmt::print(stderr, "usage: {} DIR\n", argv[0]);
    return 2;
  }
  try {
    sonarcal::benchmarks::WriteAll(argv[1]);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}: {}\n", argv[0], error.what());
    return 1;
  }
}
