// Where a fit starts from. Levels far from the recorded ones leave every pixel at a clamp, where nothing has
// a slope; and a backscatter curve has more than one valley, as narrow and wide Gaussians can trade places.
#pragma once

#include <array>
#include <vector>

#include "calib/models/frame_model.h"

namespace sonarcal::calib {

// A parameter's place in a catalog, -1 where it has none of that name.
int FindEntry(const std::vector<CatalogEntry>& catalog, const std::string& name);

// Tries dB ranges and common level offsets of all curves on the first frame, as far as they are free, and
// returns the values that explain it best, within the bounds.
ParameterValues SearchLevel(const FrameModel& model, const std::vector<CatalogEntry>& catalog,
                            const std::vector<bool>& free, const ParameterValues& start);

// A, B, C, D, E and F of the curves that a fit starts from besides the given one, relative to C = 1; `shape`
// counts from 1, any number of them.
inline constexpr int kStartShapeCount = 3;
std::array<double, 6> StartCurve(int shape);

// The values with other curves for the materials that are free: `shape` counts from 1, any number of them.
ParameterValues WithCurveShape(const std::vector<CatalogEntry>& catalog, const std::vector<bool>& free,
                               const ParameterValues& start, int shape);

// Values outside their bounds moved to them.
void MoveInsideBounds(const std::vector<CatalogEntry>& catalog, const std::vector<bool>& free,
                      ParameterValues& values);

}  // namespace sonarcal::calib
