#include "core/imaging/saturation.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>

#include "core/math/local_sums.h"

namespace sonarcal {
namespace {

constexpr int kSections = 8;
constexpr int kMinBeamsOfSection = 4;
constexpr int kMinSections = 4;
constexpr int kGroupsOfSide = 8;
constexpr double kDeviations = 3.0;
constexpr double kDeviationsOfBin = 1.0;
constexpr double kMinShare = 0.75;
constexpr int kWidestShare = 64;
constexpr double kLeastStep = 1.0 / 255.0;  // of full scale

constexpr int kMinPiled = 16;
constexpr int kLevelsBelow = 8;
constexpr double kPileFactor = 4.0;

// Means over the valid pixels of sections of beams.
class SectionMeans {
 public:
  SectionMeans(const Grid<float>& value, const Mask* valid)
      : beams_(value.cols()),
        sections_(std::min(kSections, value.cols() / kMinBeamsOfSection)),
        sum_(value.rows(), value.cols(),
             [&](int bin, int beam) { return IsValid(valid, bin, beam) ? value(bin, beam) : 0.0; }),
        count_(value.rows(), value.cols(),
               [&](int bin, int beam) { return IsValid(valid, bin, beam) ? 1.0 : 0.0; }) {}

  int sections() const { return sections_; }

  // Mean over `bins` range bins from `first`; absent if less than half of the pixels are valid.
  std::optional<double> Over(int section, int first, int bins) const {
    const CellBlock block{first, first + bins, beams_ * section / sections_,
                          beams_ * (section + 1) / sections_};
    const double count = count_.Over(block);
    if (2.0 * count < block.count()) return std::nullopt;
    return sum_.Over(block) / count;
  }

 private:
  static bool IsValid(const Mask* valid, int bin, int beam) {
    return valid == nullptr || (*valid)(bin, beam) != 0;
  }

  int beams_;
  int sections_;
  BoxSums sum_;
  BoxSums count_;
};

// Mean and standard deviation of groups of range bins beside a tested one.
struct Side {
  double mean = 0.0;
  double deviation = 0.0;
};

// Groups of `bins` range bins from `first` on.
std::optional<Side> SideAt(const SectionMeans& means, int section, int first, int bins) {
  std::array<double, kGroupsOfSide> group{};
  Side side;
  for (int i = 0; i < kGroupsOfSide; ++i) {
    const std::optional<double> of_group = means.Over(section, first + i * bins, bins);
    if (!of_group) return std::nullopt;
    group[i] = *of_group;
    side.mean += group[i] / kGroupsOfSide;
  }
  double square = 0.0;
  for (const double value : group) square += (value - side.mean) * (value - side.mean);
  side.deviation = std::sqrt(square / (kGroupsOfSide - 1));
  return side;
}

// Both sides of a group of range bins in a section.
class Sides {
 public:
  // Sides of groups of `size` bins, beyond a guard of `bins` bins beside the group of `bins` bins at `first`.
  Sides(const SectionMeans& means, int section, int first, int bins, int size)
      : near_(SideAt(means, section, first - bins - kGroupsOfSide * size, size)),
        far_(SideAt(means, section, first + 2 * bins, size)) {}

  bool exist() const { return near_ && far_; }
  bool AreBelow(double mean, double deviations, double least_step) const {
    return mean > Step(*near_, deviations, least_step) && mean > Step(*far_, deviations, least_step);
  }
  bool AreAbove(double mean, double deviations, double least_step) const {
    return mean < Step(*near_, -deviations, -least_step) && mean < Step(*far_, -deviations, -least_step);
  }

 private:
  static double Step(const Side& side, double deviations, double least_step) {
    const double step = deviations * side.deviation;
    return side.mean + (std::abs(step) > std::abs(least_step) ? step : least_step);
  }

  std::optional<Side> near_;
  std::optional<Side> far_;
};

enum class Level { kAbove, kBetween, kBelow };

// Level of a section of the group of `bins` range bins from `first`, and of each of its bins, beside those of
// both sides.
std::optional<Level> LevelOf(const SectionMeans& means, int section, int first, int bins, double least_step) {
  const std::optional<double> group = means.Over(section, first, bins);
  const Sides of_groups(means, section, first, bins, bins);
  const Sides of_bins(means, section, first, bins, 1);
  if (!group || !of_groups.exist() || !of_bins.exist()) return std::nullopt;
  const auto all_bins = [&](const auto& is_beyond) {
    for (int bin = first; bin < first + bins; ++bin) {
      const std::optional<double> mean = means.Over(section, bin, 1);
      if (mean && !is_beyond(*mean)) return false;
    }
    return true;
  };
  if (of_groups.AreBelow(*group, kDeviations, least_step) &&
      all_bins([&](double mean) { return of_bins.AreBelow(mean, kDeviationsOfBin, 0.0); })) {
    return Level::kAbove;
  }
  if (of_groups.AreAbove(*group, kDeviations, least_step) &&
      all_bins([&](double mean) { return of_bins.AreAbove(mean, kDeviationsOfBin, 0.0); })) {
    return Level::kBelow;
  }
  return Level::kBetween;
}

// Tests the group of `bins` range bins from `first`, whose sides must be within the image.
std::optional<AzimuthStreak> StreakAt(const SectionMeans& means, int first, int bins, double least_step) {
  int above = 0;
  int below = 0;
  for (int section = 0; section < means.sections(); ++section) {
    const std::optional<Level> level = LevelOf(means, section, first, bins, least_step);
    if (!level) return std::nullopt;
    above += *level == Level::kAbove;
    below += *level == Level::kBelow;
  }
  const double enough = kMinShare * means.sections();
  if (above >= enough && below == 0) return AzimuthStreak{first, first + bins, true};
  if (below >= enough && above > 0) return AzimuthStreak{first, first + bins, false};
  return std::nullopt;
}

}  // namespace

std::vector<AzimuthStreak> FindAzimuthStreaks(const PolarImage& image, const Mask* valid) {
  const int all = image.value.rows();
  const SectionMeans means(image.value, valid);
  std::vector<AzimuthStreak> streaks;
  if (means.sections() < kMinSections) return streaks;
  const double least_step = kLeastStep * image.scale.full_scale;
  int widest = 2;
  while (2 * widest <= all / kWidestShare) widest *= 2;
  // Wide groups first: a narrow one would find only the middle of a wide streak.
  for (int bins = widest; bins > 0; bins /= 2) {
    const std::size_t wider = streaks.size();
    const int margin = bins * (1 + kGroupsOfSide);
    for (int first = margin; first + bins + margin <= all; ++first) {
      const bool is_known =
          std::any_of(streaks.begin(), streaks.begin() + static_cast<std::ptrdiff_t>(wider),
                      [&](const AzimuthStreak& known) {
                        return first < known.end_bin + bins && known.first_bin < first + 2 * bins;
                      });
      if (is_known) continue;
      const std::optional<AzimuthStreak> streak = StreakAt(means, first, bins, least_step);
      if (!streak) continue;
      if (streaks.size() > wider && streak->first_bin <= streaks.back().end_bin &&
          streak->bright == streaks.back().bright) {
        streaks.back().end_bin = streak->end_bin;
      } else {
        streaks.push_back(*streak);
      }
    }
  }
  std::ranges::sort(streaks, {}, &AzimuthStreak::first_bin);
  return streaks;
}

std::string Describe(const std::vector<AzimuthStreak>& streaks, const PolarAxes& axes) {
  std::vector<std::string> each;
  each.reserve(streaks.size());
  for (const AzimuthStreak& streak : streaks) {
    each.push_back(fmt::format("{:.5g} to {:.5g} m {}", axes.range_edge_m(streak.first_bin),
                               axes.range_edge_m(streak.end_bin), streak.bright ? "brighter" : "darker"));
  }
  return fmt::format("{}", fmt::join(each, ", "));
}

std::optional<double> FindSaturationLevel(const PolarImage& image) {
  std::map<long, int, std::greater<>> counts;  // from the highest level
  for (const float value : image.value.values()) {
    if (std::isfinite(value)) ++counts[std::lround(value)];
  }
  if (counts.size() <= kLevelsBelow) return std::nullopt;
  const auto [top, piled] = *counts.begin();
  if (static_cast<double>(top) > image.scale.full_scale - 0.5 || piled < kMinPiled) return std::nullopt;
  auto next = std::next(counts.begin());
  for (int i = 0; i < kLevelsBelow; ++i, ++next) {
    if (piled <= kPileFactor * next->second) return std::nullopt;
  }
  return static_cast<double>(top);
}

double TopLevel(const PolarImage& image) {
  return FindSaturationLevel(image).value_or(image.scale.full_scale);
}

}  // namespace sonarcal
