// 95 % confidence intervals by resampling frames: Efron's percentile bootstrap. Each draw takes as many
// frames as there are, with replacement. The interval of a statistic reaches from the 2.5th to the 97.5th
// percentile of its values over the draws.
//
// Frames that follow each other in time are correlated. Drawn one by one they would give an interval that is
// too narrow, so they are drawn in blocks of consecutive frames, the last followed by the first (circular
// block bootstrap, Politis & Romano 1992). The block length is that of Politis & White, Econometric Reviews
// 23(1), 2004, as corrected by Patton, Politis & White, 28(4), 2009.
//
// The seed is fixed, so the same frames give the same interval on every machine.
#pragma once

#include <cstdint>
#include <random>
#include <span>
#include <vector>

namespace sonarcal::metrics {

inline constexpr int kBootstrapDraws = 2000;
inline constexpr std::uint64_t kBootstrapSeed = 20240107;
// Min number of frames for an interval: with two frames there are only three different draws.
inline constexpr int kBootstrapMinFrames = 3;

struct Interval {
  double lo = 0.0;
  double hi = 0.0;

  bool operator==(const Interval&) const = default;
};

// Draws frames. Blocks of one frame treat frames as independent.
class FrameResampler {
 public:
  explicit FrameResampler(int frame_count, int block_frames = 1)
      : indices_(frame_count), block_frames_(block_frames) {}

  // Returns frame_count frame indices, valid until the next call.
  std::span<const int> Next();

 private:
  std::mt19937_64 random_{kBootstrapSeed};
  std::vector<int> indices_;
  int block_frames_;
};

// Block length of the circular bootstrap of the mean of a series, which is in the order of time. 1 if there
// is no correlation; at most 3 sqrt(n) and n / 3, rounded up.
int PolitisWhiteBlockLength(std::span<const double> series);

// Interval from the 2.5th to the 97.5th percentile, interpolated linearly between order statistics. Needs at
// least one draw.
Interval PercentileInterval95(std::vector<double> draws);

}  // namespace sonarcal::metrics
