// Strip of surface through the marks of the first return that a person made in a ping, if nothing else is
// known of the surface.
//
// A mark says how near the surface comes in a beam, not how high. Assumed here:
//
//   - In the vertical plane of each beam the surface is a straight line that leans away from the sonar by one
//     angle, the same in all beams: 0 upright to the plane of the image, 90 degrees lying in it. Leaning
//     towards the sonar from above or from below looks the same in the image.
//   - The line is as near as the mark says where it comes nearest within the half-power elevation beam: where
//     it leans no more than half of that beam's width, at the foot of the perpendicular, and at the beam's
//     lower edge where it leans more.
//   - The strip reaches two widths of that beam up and down. Where the line leans more than half of the
//     beam's width it ends at the beam's lower edge, below which it would come nearer than the mark.
//   - Marks are whole bins, whose steps would make a stair of the surface: they are smoothed by a local
//     parabola over kSmoothBeams beams. Beams without a mark have no surface, be there one or not.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/types/image.h"
#include "core/types/scene.h"

namespace sonarcal::reproduce {

inline constexpr int kSmoothBeams = 9;

// Marked range bin of each beam.
using FirstReturn = std::vector<std::optional<int>>;

// A PNG of range bins x beams, grey or colour, with or without alpha: a beam's mark is its nearest pixel
// whose colour is not black. Throws DataError where the picture is of another size than the axes.
FirstReturn ReadFirstReturn(const std::filesystem::path& file, const PolarAxes& axes);

// Ranges of the first return, smoothed, by beam; nothing where a beam has no mark.
std::vector<std::optional<double>> SmoothedRangesM(const FirstReturn& marks, const PolarAxes& axes);

struct MarkedStripOptions {
  double lean_deg = 0.0;        // 0 .. 80
  double elevation_deg = 14.0;  // half-power width of the beam, two-way
  std::string material = "surface";
};

// In the sonar's own frame. The strip reaches half a beam beyond the outer marks, and ends 10 % beyond the
// window. Throws DataError for a lean outside its domain or fewer than two marks next to each other.
Scene MakeMarkedStrip(const FirstReturn& marks, const PolarAxes& axes, const MarkedStripOptions& options);

// Warning for an angle at the end of the searched range; nullopt for one inside it.
std::optional<std::string> LeanAtEnd(double lean_deg, double largest_tried_deg);

// Range, in parts of the mark's, of the assumed line at an elevation.
double StripRangeRatio(double lean_rad, double half_beam_rad, double elevation_rad);

}  // namespace sonarcal::reproduce
