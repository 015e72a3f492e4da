// 95 % intervals by resampling frames: Efron's percentile bootstrap. Frames are drawn with replacement, as
// many as there are; a statistic's interval lies between the 2.5th and the 97.5th percentile of its values
// over the draws.
//
// It treats frames as independent. Consecutive frames of a still scene share their speckle, and their
// interval is then too narrow. The seed is fixed, so that the same frames give the same interval on every
// machine.
#pragma once

#include <cstdint>
#include <random>
#include <span>
#include <vector>

namespace sonarcal {

inline constexpr int kBootstrapDraws = 2000;
inline constexpr std::uint64_t kBootstrapSeed = 20240107;
// With two frames a draw can only be one of three: no interval is given below this number.
inline constexpr int kBootstrapMinFrames = 3;

struct Interval {
  double lo = 0.0;
  double hi = 0.0;

  bool operator==(const Interval&) const = default;
};

class FrameResampler {
 public:
  explicit FrameResampler(int frame_count) : indices_(frame_count) {}

  // Frame indices, frame_count of them; valid until the next call.
  std::span<const int> Next();

 private:
  std::mt19937_64 random_{kBootstrapSeed};
  std::vector<int> indices_;
};

// Between the 2.5th and the 97.5th percentile, interpolated linearly between order statistics. At least one
// draw.
Interval PercentileInterval95(std::vector<double> draws);

}  // namespace sonarcal
