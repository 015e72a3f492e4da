// Distributions of the grey values of a recorded and a simulated image, regardless of the pixels' positions.
// This is the paper's "difference in the pixel value distribution" (Park 2024, Section 6). It is not
// sensitive to a displaced object.
//
// A value counts for the nearest of the levels 0 .. full scale. Displays with more than 4096 levels use 4096
// even classes. Distances: core/math/distribution.h.
//
// Over the union, the whole image and the overlap, both images are read at the same pixels. Over `objects`,
// each is read in its own object region, over `echoes` at its own echoes (metrics/measures/echoes.h).
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

enum class LevelDomain { kUnion, kWhole, kOverlap, kObjects, kEchoes };
constexpr auto WordsOf(std::type_identity<LevelDomain>) {
  return Words<LevelDomain, 5>{{{"union", LevelDomain::kUnion},
                                {"whole", LevelDomain::kWhole},
                                {"overlap", LevelDomain::kOverlap},
                                {"objects", LevelDomain::kObjects},
                                {"echoes", LevelDomain::kEchoes}}};
}

inline constexpr std::array kLevelDomains = {LevelDomain::kUnion, LevelDomain::kWhole, LevelDomain::kOverlap,
                                             LevelDomain::kObjects, LevelDomain::kEchoes};

// Distances between the two distributions; without a value if either has no pixel.
struct LevelDistances {
  std::optional<double> l1_half;             // 0 .. 1
  std::optional<double> wasserstein;         // fraction of full scale
  std::optional<double> emd_db;              // earth mover's distance: Wasserstein-1 in dB of the display
  std::optional<double> hellinger;           // 0 .. 1
  std::optional<double> kolmogorov_smirnov;  // 0 .. 1
  std::optional<double> upper_anderson_darling;
};

// Number of pixels per level.
struct LevelCounts {
  std::vector<double> real;  // empty: nothing counted
  std::vector<double> simulated;

  // `span_db`: dB between 0 and full scale; without it no distance is in dB.
  LevelDistances Distances(std::optional<double> span_db = {}) const;
  // Throws DataError if the numbers of levels differ.
  LevelCounts& operator+=(const LevelCounts& other);
};

// Levels of one frame, or of several pooled, by domain.
struct LevelHistograms {
  std::array<LevelCounts, kLevelDomains.size()> over;
  std::optional<double> span_db;  // dB between 0 and full scale; none if unknown or if the frames differ

  LevelCounts& Over(LevelDomain domain) { return over[static_cast<std::size_t>(domain)]; }
  const LevelCounts& Over(LevelDomain domain) const { return over[static_cast<std::size_t>(domain)]; }
  std::array<LevelDistances, kLevelDomains.size()> Distances() const;
  LevelHistograms& operator+=(const LevelHistograms& other);
};

// All arrays have one shape; values are finite, full_scale > 0; `inside` null: every pixel counts. The caller
// sets span_db.
LevelHistograms CountLevels(const Grid<float>& real, const Grid<float>& simulated, double full_scale,
                            const Mask& real_object, const Mask& simulated_object, double echo_level,
                            const Mask* inside = nullptr);

}  // namespace sonarcal::metrics
