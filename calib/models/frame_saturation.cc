#include "calib/models/frame_saturation.h"

#include <fmt/format.h>

#include <algorithm>

namespace sonarcal::calib {
namespace {

const Mask* PointerTo(const std::optional<Mask>& mask) {
  return mask ? &*mask : nullptr;
}

void LeaveOut(const PolarImage& image, std::vector<std::uint8_t>& use, int bin, int beam) {
  if (use.empty()) use.assign(image.value.size(), 1);
  use[static_cast<std::size_t>(bin) * image.value.cols() + beam] = 0;
}

}  // namespace

std::optional<FrameSaturation> FindSaturation(int frame, const PolarImage& image,
                                              const std::optional<Mask>& valid) {
  FrameSaturation found{.frame = frame,
                        .level = FindSaturationLevel(image),
                        .streaks = FindAzimuthStreaks(image, PointerTo(valid))};
  if (!found.level && found.streaks.empty()) return std::nullopt;
  if (found.level) {
    found.pixels_at_level =
        std::ranges::count_if(image.value.values(), [&](float value) { return value > *found.level - 0.5; });
  }
  return found;
}

std::vector<FrameSaturation> FindSaturation(const RecordingSource& recording,
                                            const std::vector<int>& frames) {
  std::vector<FrameSaturation> all;
  for (const int frame : frames) {
    if (auto found = FindSaturation(frame, recording.ReadFrame(frame).image, recording.info().valid))
      all.push_back(std::move(*found));
  }
  return all;
}

void LeaveOutStreaks(const PolarImage& image, const std::optional<Mask>& valid,
                     std::vector<std::uint8_t>& use) {
  for (const AzimuthStreak& streak : FindAzimuthStreaks(image, PointerTo(valid))) {
    for (int bin = streak.first_bin; bin < streak.end_bin; ++bin) {
      for (int beam = 0; beam < image.value.cols(); ++beam) LeaveOut(image, use, bin, beam);
    }
  }
}

void LeaveOutSaturated(const PolarImage& image, const std::optional<Mask>& valid,
                       std::vector<std::uint8_t>& use) {
  LeaveOutStreaks(image, valid, use);
  const std::optional<double> level = FindSaturationLevel(image);
  if (!level) return;
  for (int bin = 0; bin < image.value.rows(); ++bin) {
    for (int beam = 0; beam < image.value.cols(); ++beam) {
      if (image.value(bin, beam) > *level - 0.5) LeaveOut(image, use, bin, beam);
    }
  }
}

std::string SaturationText(const std::vector<FrameSaturation>& saturation) {
  if (saturation.empty()) return {};
  const auto frames = [](std::int64_t count) {
    return fmt::format("{} frame{}", count, count == 1 ? "" : "s");
  };
  std::int64_t streaked = 0;
  std::int64_t piled = 0;
  std::int64_t bins = 0;
  std::int64_t pixels = 0;
  for (const FrameSaturation& of : saturation) {
    streaked += of.streaks.empty() ? 0 : 1;
    piled += of.level ? 1 : 0;
    pixels += of.pixels_at_level;
    for (const AzimuthStreak& streak : of.streaks) bins += streak.end_bin - streak.first_bin;
  }
  std::string text = "traces of a saturated receiver:";
  if (streaked > 0) {
    text +=
        fmt::format(" {} range bins with streaks along azimuth are left out in {}", bins, frames(streaked));
  }
  if (piled > 0) {
    text +=
        fmt::format("{} {} pixels have the highest grey level of {}, below full scale, where values pile up",
                    streaked > 0 ? ";" : "", pixels, frames(piled));
  }
  return text;
}

}  // namespace sonarcal::calib
