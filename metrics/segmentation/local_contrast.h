// Local contrast: a pixel's value minus the mean of the ring around it, i.e. of the pixels inside a larger
// rectangle and outside a smaller one. Finds objects up to the size of the smaller rectangle. Large bright
// areas, such as a floor or a wall, are not objects.
#pragma once

#include "core/math/training_window.h"
#include "core/types/image.h"
#include "core/types/mask.h"

namespace sonarcal::metrics {

// Contrast in the unit of `value`. Rectangles are cut at the image's border. Pixels outside `valid` (null:
// all are valid) belong to no mean. A pixel with an empty ring has contrast 0.
Grid<float> LocalContrast(const Grid<float>& value, const TrainingShape& ring, const Mask* valid = nullptr);

}  // namespace sonarcal::metrics
