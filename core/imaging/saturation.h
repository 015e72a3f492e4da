// Traces of a saturated receiver in an image of grey levels.
//
// Level: a receiver or recorder that reaches its limit below full scale gives all stronger echoes one value.
// So the values pile up at the highest one. It then stands for all higher powers, as full scale always does.
//
// Streaks: a saturated channel disturbs all beams of its range bins. Crosstalk and the products of two strong
// echoes make them brighter. A receiver array that follows the strong echo loses the others, and makes them
// darker. The beams are divided into up to eight sections. A streak is a group of range bins, at most 1/64 of
// all (at least 2), in which three quarters of the sections are above both sides and none is below, or three
// quarters are below and at least one is above. "Above" is by more than three standard deviations of eight
// neighbouring groups on that side and by more than one 255th of full scale, and for each bin by more than
// one standard deviation of eight bins: a wall across the beams changes its bin from section to section. A
// guard as wide as the group is left out on both sides. Without saturation, the same image comes from a thin
// echo at one range in all directions, or from side lobes of an echo that is far stronger than all else.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/types/image.h"
#include "core/types/mask.h"

namespace sonarcal {

struct AzimuthStreak {
  int first_bin = 0;
  int end_bin = 0;  // one past the last
  bool bright = true;

  bool operator==(const AzimuthStreak&) const = default;
};

// Streaks from near to far. Pixels that are not set in `valid` (null: all are) do not count. Images of fewer
// than 16 beams have none, because too few sections can agree.
std::vector<AzimuthStreak> FindAzimuthStreaks(const PolarImage& image, const Mask* valid = nullptr);

// Text such as "5.31 to 5.35 m brighter, 7.2 to 7.24 m darker"; empty without streaks.
std::string Describe(const std::vector<AzimuthStreak>& streaks, const PolarAxes& axes);

// Level below full scale at which the values pile up: it occurs at least 16 times, and more than four times
// as often as any of the next eight lower levels that occur. Absent: there is none.
std::optional<double> FindSaturationLevel(const PolarImage& image);

// Lowest level that stands for all higher powers: FindSaturationLevel, or full scale.
double TopLevel(const PolarImage& image);

}  // namespace sonarcal
