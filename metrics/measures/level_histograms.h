// Distributions of the grey values of a recorded and a simulated image, regardless of the pixels' positions.
// This is the paper's "difference in the pixel value distribution" (Park 2024, Section 6). It is not
// sensitive to a displaced object.
//
// A value counts for the nearest of the levels 0 .. full scale. Displays with more than 4096 levels use 4096
// even classes. Distances: core/math/distribution.h.
//
// Over the union, the whole image and the overlap, both images are read at the same pixels. Over `objects`,
// each is read in its own object region.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <type_traits>
#include <vector>

#include "core/types/image.h"
#include "core/types/mask.h"
#include "core/types/words.h"

namespace sonarcal::metrics {

enum class LevelDomain { kUnion, kWhole, kOverlap, kObjects };
constexpr auto WordsOf(std::type_identity<LevelDomain>) {
  return Words<LevelDomain, 4>{{{"union", LevelDomain::kUnion},
                                {"whole", LevelDomain::kWhole},
                                {"overlap", LevelDomain::kOverlap},
                                {"objects", LevelDomain::kObjects}}};
}

inline constexpr std::array kLevelDomains = {LevelDomain::kUnion, LevelDomain::kWhole, LevelDomain::kOverlap,
                                             LevelDomain::kObjects};

// Distances between the two distributions; without a value if either has no pixel.
struct LevelDistances {
  std::optional<double> l1_half;             // 0 .. 1
  std::optional<double> wasserstein;         // fraction of full scale
  std::optional<double> hellinger;           // 0 .. 1
  std::optional<double> kolmogorov_smirnov;  // 0 .. 1
  std::optional<double> upper_anderson_darling;
};

// Number of pixels per level.
struct LevelCounts {
  std::vector<double> real;  // empty: nothing counted
  std::vector<double> simulated;

  LevelDistances Distances() const;
  // Throws DataError if the numbers of levels differ.
  LevelCounts& operator+=(const LevelCounts& other);
};

// Levels of one frame, or of several pooled, by domain.
struct LevelHistograms {
  std::array<LevelCounts, kLevelDomains.size()> over;

  LevelCounts& Over(LevelDomain domain) { return over[static_cast<std::size_t>(domain)]; }
  const LevelCounts& Over(LevelDomain domain) const { return over[static_cast<std::size_t>(domain)]; }
  LevelHistograms& operator+=(const LevelHistograms& other);
};

// All arrays have one shape; values are finite, full_scale > 0; `inside` null: every pixel counts.
LevelHistograms CountLevels(const Grid<float>& real, const Grid<float>& simulated, double full_scale,
                            const Mask& real_object, const Mask& simulated_object,
                            const Mask* inside = nullptr);

}  // namespace sonarcal::metrics
