#include "calib/standard_target/target_sighting.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "calib/models/acoustic_frame_model.h"
#include "core/math/statistics.h"
#include "core/types/units.h"
#include "sim/physics/display.h"

namespace sonarcal::calib {
namespace {

// A mean power from the median of exponential powers.
constexpr double kMeanOverMedian = 1.0 / std::numbers::ln2;
constexpr int kNoiseBins = 8;    // on either side of the peak
constexpr int kCandidates = 32;  // peaks that are looked at

double NoiseAround(const ReceivedPowers& image, int bin) {
  std::vector<double> powers;
  for (int row = std::max(0, bin - kNoiseBins); row <= std::min(image.power.rows() - 1, bin + kNoiseBins);
       ++row) {
    const auto values = image.power.row(row);
    powers.insert(powers.end(), values.begin(), values.end());
  }
  return kMeanOverMedian * Median(std::move(powers));
}

// Samples at which a line through the peak crosses half of it, interpolated, and whether it falls to a tenth.
struct Profile {
  double extent = 0.0;  // in samples
  bool falls = true;
};

// `at(i)`: power at i samples from the peak, on a line of samples -before..after.
template <typename At>
Profile ProfileOf(const At& at, int before, int after) {
  constexpr double kTenth = 0.1;
  constexpr double kReachInExtents = 3.0;
  Profile profile;
  for (const int sign : {-1, 1}) {
    const int last = sign < 0 ? before : after;
    int i = 1;
    while (i <= last && at(sign * i) > 0.5 * at(0)) ++i;
    if (i > last) {
      // Only the part within the image is seen.
      profile.extent += last + 0.5;
      continue;
    }
    const double inner = at(sign * (i - 1));
    profile.extent += i - 1 + (inner - 0.5 * at(0)) / (inner - at(sign * i));
  }
  const int reach = static_cast<int>(std::ceil(kReachInExtents * std::max(profile.extent, 1.0)));
  for (const int sign : {-1, 1}) {
    const int last = std::min(sign < 0 ? before : after, reach);
    double lowest = at(0);
    for (int i = 1; i <= last; ++i) lowest = std::min(lowest, at(sign * i));
    if (last == reach && lowest > kTenth * at(0)) profile.falls = false;
  }
  return profile;
}

}  // namespace

ReceivedPowers PowersOf(const PolarImage& image, const DisplayParameters<double>& display) {
  const std::vector<RecordedPower> recorded = RecordedPowers(image, display);
  const int rows = image.value.rows();
  const int cols = image.value.cols();
  ReceivedPowers powers{Grid<double>(rows, cols), Grid<double>(rows, cols), Grid<std::uint8_t>(rows, cols)};
  for (std::size_t i = 0; i < recorded.size(); ++i) {
    const double power = recorded[i].power;
    const bool hidden = recorded[i].censoring == Censoring::kAtMost;
    powers.power.values()[i] = hidden ? 0.5 * power : power;
    const double step =
        hidden
            ? power
            : 1.0 / (image.scale.full_scale * std::abs(sim::DisplaySlope(display, std::max(power, 1e-300))));
    powers.rounding_variance.values()[i] = step * step / 12.0;
    powers.clipped.values()[i] = recorded[i].censoring == Censoring::kAtLeast;
  }
  return powers;
}

TargetSearchResult FindTarget(const ReceivedPowers& image, const PolarAxes& axes,
                              const TargetSearch& search) {
  const Grid<double>& power = image.power;
  const double nearest_m = search.range_min_m.value_or(axes.range_min_m);
  const double farthest_m = search.range_max_m.value_or(axes.range_max_m);
  struct Peak {
    int bin;
    int beam;
  };
  std::vector<Peak> peaks;
  for (int bin = 1; bin + 1 < power.rows(); ++bin) {
    const double range_m = axes.range_centre_m(bin);
    if (range_m < nearest_m || range_m > farthest_m) continue;
    for (int beam = 1; beam + 1 < power.cols(); ++beam) {
      const double here = power(bin, beam);
      if (here >= power(bin - 1, beam) && here > power(bin + 1, beam) && here >= power(bin, beam - 1) &&
          here > power(bin, beam + 1)) {
        peaks.push_back({bin, beam});
      }
    }
  }
  const std::size_t count = std::min<std::size_t>(peaks.size(), kCandidates);
  std::partial_sort(
      peaks.begin(), peaks.begin() + static_cast<std::ptrdiff_t>(count), peaks.end(),
      [&](const Peak& a, const Peak& b) { return power(a.bin, a.beam) > power(b.bin, b.beam); });
  peaks.resize(count);
  std::optional<double> highest_db;  // of the peaks too close to the noise
  bool extended = false;
  for (const auto [bin, beam] : peaks) {
    const double peak = power(bin, beam);
    const double noise = NoiseAround(image, bin);
    const double above_db = DbFromPower(peak / noise);
    if (above_db < search.above_noise_db) {
      highest_db = std::max(highest_db.value_or(above_db), above_db);
      continue;
    }
    const Profile range =
        ProfileOf([&, b = bin, c = beam](int i) { return power(b + i, c); }, bin, power.rows() - 1 - bin);
    const Profile azimuth =
        ProfileOf([&, b = bin, c = beam](int i) { return power(b, c + i); }, beam, power.cols() - 1 - beam);
    if (!range.falls || !azimuth.falls) {
      extended = true;
      continue;
    }
    for (int row = bin - 1; row <= bin + 1; ++row) {
      for (int col = beam - 1; col <= beam + 1; ++col) {
        if (image.clipped(row, col) != 0)
          return {{}, "the target's echo is clipped at the top of the display", {}};
      }
    }
    return {TargetSighting{.bin = bin,
                           .beam = beam,
                           .peak_power = peak,
                           .noise_power = noise,
                           .range_extent_m = range.extent * axes.range_bin_m(),
                           .azimuth_extent_rad = azimuth.extent * axes.beam_spacing_rad()},
            {},
            {}};
  }
  if (extended) return {{}, "its bright echoes are extended, none stands alone", {}};
  if (!highest_db) return {{}, "it has no peak in the window of range", {}};
  return {{},
          fmt::format("its brightest peak is not {:.0f} dB above the noise", search.above_noise_db),
          fmt::format("{:.1f} dB", *highest_db)};
}

}  // namespace sonarcal::calib
