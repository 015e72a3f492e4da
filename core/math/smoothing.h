// Gaussian smoothing of polar images before poses are looked for: edges that lie apart overlap again, and a
// cost has a slope that leads from one to the other.
#pragma once

#include "core/types/image.h"

namespace sonarcal {

// Standard deviations in range bins and beams; 0 leaves that direction as it is. Near the edge of the image
// the kernel is what lies within.
void Smooth(Grid<float>& image, double sigma_bins, double sigma_beams);

}  // namespace sonarcal
