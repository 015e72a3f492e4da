// Mask of an image with the same shape: 1 is yes, 0 is no; no other values occur.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

#include "core/types/error.h"
#include "core/types/image.h"

namespace sonarcal {

using Mask = Grid<std::uint8_t>;

inline std::int64_t CountSet(const Mask& mask) {
  return std::count_if(mask.values().begin(), mask.values().end(), [](std::uint8_t set) { return set != 0; });
}

// Set where both masks are set; both must have one shape.
inline Mask Both(const Mask& a, const Mask& b) {
  SONARCAL_CHECK(a.rows() == b.rows() && a.cols() == b.cols(), "masks {} x {} and {} x {}", a.rows(),
                 a.cols(), b.rows(), b.cols());
  Mask both(a.rows(), a.cols());
  std::transform(a.values().begin(), a.values().end(), b.values().begin(), both.values().begin(),
                 [](std::uint8_t in_a, std::uint8_t in_b) { return std::uint8_t{in_a != 0 && in_b != 0}; });
  return both;
}

// An absent mask is set everywhere.
inline std::optional<Mask> Both(const std::optional<Mask>& a, const std::optional<Mask>& b) {
  if (!a || !b) return a ? a : b;
  return Both(*a, *b);
}

}  // namespace sonarcal
