// Overlap of two object regions: Park 2024, Section 6, Table 6 and Fig. 13.
//
// Ns: pixels of the object region in the simulated image; Nr: in the real one; Na: in both (bitwise AND). All
// ratios approach 1 as the images become alike, but only Na/Ns, Na/Nr, IoU and Dice cannot exceed 1. A ratio
// whose denominator is zero has no value (null in JSON): never 0, never NaN.
#pragma once

#include <cstdint>
#include <optional>

#include "core/types/mask.h"

namespace sonarcal::metrics {

// Counts of one frame, or of several frames pooled.
struct Occupancy {
  std::int64_t ns = 0;
  std::int64_t nr = 0;
  std::int64_t na = 0;

  std::int64_t union_count() const { return ns + nr - na; }

  std::optional<double> ns_over_nr() const { return Ratio(ns, nr); }
  std::optional<double> na_over_ns() const { return Ratio(na, ns); }
  std::optional<double> na_over_nr() const { return Ratio(na, nr); }  // = (Na/Ns)(Ns/Nr)
  std::optional<double> iou() const { return Ratio(na, union_count()); }
  std::optional<double> dice() const { return Ratio(2 * na, ns + nr); }  // = 2 IoU / (1 + IoU)

  Occupancy& operator+=(const Occupancy& other) {
    ns += other.ns;
    nr += other.nr;
    na += other.na;
    return *this;
  }
  bool operator==(const Occupancy&) const = default;

 private:
  static std::optional<double> Ratio(std::int64_t numerator, std::int64_t denominator) {
    if (denominator == 0) return std::nullopt;
    return static_cast<double>(numerator) / static_cast<double>(denominator);
  }
};

// Masks of the same shape.
Occupancy CountOccupancy(const Mask& real, const Mask& simulated);

}  // namespace sonarcal::metrics
