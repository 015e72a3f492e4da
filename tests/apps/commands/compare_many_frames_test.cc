// A recording of any length is compared in constant memory but for the figures of its frames.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <random>

#include "data_io/images/image_io.h"
#include "tests/apps/tiny_world.h"

namespace sonarcal::commands {
namespace {

using testing::Quoted;
using testing::TempDir;

constexpr int kBins = 512;
constexpr int kManyBeams = 128;

// A recording of `count` frames that are all one picture: reading them costs what reading others would.
void WriteRecordingOf(const std::filesystem::path& folder, int count, std::uint64_t seed) {
  std::filesystem::create_directory(folder);
  std::mt19937_64 random(seed);
  Grid<std::uint8_t> grey(kBins, kManyBeams);
  for (std::uint8_t& value : grey.values()) value = static_cast<std::uint8_t>(40 + random() % 40);
  for (int bin = 200; bin < 300; ++bin) {
    for (int beam = 40; beam < 80; ++beam) grey(bin, beam) = 200;
  }
  data_io::WritePng(folder / "frame.png", grey);
  nlohmann::json json = {{"format", "sonar-recording/1"},
                         {"sonar",
                          {{"name", "test"},
                           {"frequency_hz", 900000},
                           {"azimuth_beam_width_deg", 0.15},
                           {"elevation_beam_width_deg", 14},
                           {"range_min_m", 1.0},
                           {"range_max_m", 5.0},
                           {"range_bins", kBins},
                           {"sound_speed_m_per_s", 1480}}},
                         {"image", {{"layout", "polar"}, {"bits", 8}, {"db_min", 0}, {"db_max", 80}}},
                         {"frames", nlohmann::json::array()}};
  for (int beam = 0; beam < kManyBeams; ++beam) {
    json["sonar"]["beam_azimuth_deg"].push_back(0.15 * (beam - 0.5 * (kManyBeams - 1)));
  }
  for (int i = 0; i < count; ++i) json["frames"].push_back({{"file", "frame.png"}, {"time_s", 0.1 * i}});
  testing::WriteFile(folder / "recording.json", json.dump());
}

// Peak resident memory of a comparison of `count` pairs, by a process of its own.
double PeakMiB(const TempDir& dir, int count) {
  WriteRecordingOf(dir / fmt::format("real{}", count), count, 1);
  WriteRecordingOf(dir / fmt::format("sim{}", count), count, 2);
  const std::string command =
      fmt::format("exec {} {} compare --quiet --pictures 2 --real {} --sim {} --out {} >/dev/null",
                  testing::kFreeSoon, SONARCAL_BINARY, Quoted(dir / fmt::format("real{}", count)),
                  Quoted(dir / fmt::format("sim{}", count)), Quoted(dir / fmt::format("out{}", count)));
  const pid_t child = fork();
  if (child == 0) {
    execl("/bin/sh", "sh", "-c", command.c_str(), static_cast<char*>(nullptr));
    _exit(127);
  }
  int status = -1;
  rusage usage{};
  EXPECT_EQ(wait4(child, &status, 0, &usage), child);
  EXPECT_EQ(status, 0);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

TEST(CompareManyFrames, MemoryDoesNotGrowWithTheImages) {
  const TempDir dir;
  constexpr int kFew = 100;  // more than go into the report, and as many as the floor compares
  constexpr int kMany = 300;
  const double few = PeakMiB(dir, kFew);
  const double many = PeakMiB(dir, kMany);
  const double images = (kMany - kFew) * 2.0 * kBins * kManyBeams * sizeof(float) / (1024.0 * 1024.0);
  RecordProperty("few_MiB", fmt::format("{}", few));
  RecordProperty("many_MiB", fmt::format("{}", many));
  EXPECT_LT(many - few, 0.25 * images) << few << " MiB, then " << many << ", the images being " << images;

  const nlohmann::json metrics = testing::ReadJsonFile(dir / fmt::format("out{}/metrics.json", kMany));
  EXPECT_EQ(metrics["frames"].size(), static_cast<std::size_t>(kMany));
  EXPECT_EQ(metrics["residuals"]["frames"], kMany);
  EXPECT_LT(std::filesystem::file_size(dir / fmt::format("out{}/report.html", kMany)), 20'000'000U);
}

}  // namespace
}  // namespace sonarcal::commands
