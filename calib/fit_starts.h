// Start values of a fit. Levels far from the recorded ones clamp every pixel, so that nothing has a slope.
// And a backscatter curve has several valleys, because narrow and wide Gaussians can trade places.
#pragma once

#include <array>
#include <vector>

#include "calib/models/frame_model.h"

namespace sonarcal::calib {

// Returns the index of a parameter in a catalog; -1 if it has none of that name.
int FindEntry(const std::vector<CatalogEntry>& catalog, const std::string& name);

// Tries dB ranges and common level offsets of all curves on the first frame, as far as they are free. Returns
// the values that match it best, within the bounds.
ParameterValues SearchLevel(const FrameModel& model, const std::vector<CatalogEntry>& catalog,
                            const std::vector<bool>& free, const ParameterValues& start);

// Returns A, B, C, D, E and F of an alternative start curve, relative to C = 1. `shape` counts from 1 and has
// no upper limit.
inline constexpr int kStartShapeCount = 3;
std::array<double, 6> StartCurve(int shape);

// Returns a curve with the level of another one at oblique incidence. Both are A, B, C, D, E and F.
std::array<double, 6> AtLevelOf(const std::array<double, 6>& level, std::array<double, 6> curve);

// Returns `start` with the curve `shape` (see StartCurve) for all free materials, at the levels that their
// curves have in `level`.
ParameterValues WithCurveShape(const std::vector<CatalogEntry>& catalog, const std::vector<bool>& free,
                               const ParameterValues& start, const ParameterValues& level, int shape);

// Moves values outside their bounds to the bounds.
void MoveInsideBounds(const std::vector<CatalogEntry>& catalog, const std::vector<bool>& free,
                      ParameterValues& values);

}  // namespace sonarcal::calib
