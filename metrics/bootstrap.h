// 95 % intervals by resampling frames: Efron's percentile bootstrap. Frames are drawn with replacement, as
// many as there are; a statistic's interval lies between the 2.5th and the 97.5th percentile of its values
// over the draws.
//
// Frames that follow each other in time resemble each other, and drawn one by one would give an interval too
// narrow. They are drawn in blocks of consecutive frames, the last followed by the first (circular block
// bootstrap, Politis & Romano 1992). The length of a block is that of Politis & White, Econometric Reviews
// 23(1), 2004, as corrected by Patton, Politis & White, 28(4), 2009.
//
// The seed is fixed, so that the same frames give the same interval on every machine.
#pragma once

#include <cstdint>
#include <random>
#include <span>
#include <vector>

namespace sonarcal::metrics {

inline constexpr int kBootstrapDraws = 2000;
inline constexpr std::uint64_t kBootstrapSeed = 20240107;
// With two frames a draw can only be one of three: no interval is given below this number.
inline constexpr int kBootstrapMinFrames = 3;

struct Interval {
  double lo = 0.0;
  double hi = 0.0;

  bool operator==(const Interval&) const = default;
};

// Blocks of one frame draw frames as independent.
class FrameResampler {
 public:
  explicit FrameResampler(int frame_count, int block_frames = 1)
      : indices_(frame_count), block_frames_(block_frames) {}

  // Frame indices, frame_count of them; valid until the next call.
  std::span<const int> Next();

 private:
  std::mt19937_64 random_{kBootstrapSeed};
  std::vector<int> indices_;
  int block_frames_;
};

// How many consecutive values of a series, in the order of time, a block of the circular bootstrap of its
// mean takes: 1 where no correlation shows, at most 3 sqrt(n) and n / 3, rounded up.
int PolitisWhiteBlockLength(std::span<const double> series);

// Between the 2.5th and the 97.5th percentile, interpolated linearly between order statistics. At least one
// draw.
Interval PercentileInterval95(std::vector<double> draws);

}  // namespace sonarcal::metrics
