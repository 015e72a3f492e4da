// Distance of the textures of two images by local binary patterns (LBP), Ojala, Pietikainen & Maenpaa, IEEE
// Trans. Pattern Anal. Mach. Intell. 24(7), 2002. Patterns used here: rotation-invariant uniform ones
// ("riu2") of 8 neighbours at a radius of one pixel.
//
//   bit p               1 if neighbour p (angle 2 pi p / 8, interpolated bilinearly) is at least as high as
//                       the centre
//   pattern             number of bits, 0 .. 8, if they change at most twice around the circle; otherwise 9
//   texture distance    Kullback-Leibler divergence sum p ln(p / q), p the shares of the patterns in the real
//                       image, q in the simulated one; 0 for equal textures, in nats
//
// Half a count is added to each pattern (Jeffreys' prior), so the divergence is finite. The literature also
// uses the 256 plain patterns, 59 uniform ones, other radii and base-2 logarithms: compare values of the same
// settings only. Patterns do not change with gain and offset. A clipped area is one texture, pattern 8.
//
// A polar image is read in bins and beams. An expected image has no speckle, so its texture is far from that
// of a recording.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "core/types/image.h"
#include "core/types/mask.h"

namespace sonarcal::metrics {

inline constexpr int kTexturePatterns = 10;

// Number of pixels by pattern, of one frame or of several pooled.
struct TextureCounts {
  std::array<std::int64_t, kTexturePatterns> real = {};
  std::array<std::int64_t, kTexturePatterns> simulated = {};

  std::optional<double> divergence() const;  // none without pixels
  TextureCounts& operator+=(const TextureCounts& other);
};

struct TextureMeasures {
  TextureCounts whole;
  TextureCounts union_region;  // pixels of either object region

  TextureMeasures& operator+=(const TextureMeasures& other);
};

// Pattern of a pixel that has eight neighbours.
int BinaryPattern(const Grid<float>& image, int row, int col);

// All arrays have one shape. Counts pixels whose 3 x 3 neighbourhood lies in the image and `inside` (null:
// everywhere).
TextureMeasures MeasureTexture(const Grid<float>& real, const Grid<float>& simulated, const Mask& real_object,
                               const Mask& simulated_object, const Mask* inside = nullptr);

}  // namespace sonarcal::metrics
