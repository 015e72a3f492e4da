// A pixel against the ring around it: how far it lies above the mean of the pixels within a larger rectangle
// but not within a smaller one. What is bright over a large area, as a floor or a wall, is no object to it;
// an object no larger than the smaller rectangle is.
#pragma once

#include "core/math/training_window.h"
#include "core/types/image.h"
#include "core/types/mask.h"

namespace sonarcal::metrics {

// In the unit of `value`. Rectangles are cut at the image's border; pixels outside `valid` (null: all count)
// have no part in any mean. A pixel whose ring is empty has contrast 0.
Grid<float> LocalContrast(const Grid<float>& value, const TrainingShape& ring, const Mask* valid = nullptr);

}  // namespace sonarcal::metrics
