// Gaussian smoothing of polar images before a pose search. Edges that lie apart overlap after it, so a cost
// function has a gradient that leads from one to the other.
#pragma once

#include "core/types/image.h"

namespace sonarcal {

// Standard deviations in range bins and beams; 0 does not smooth in that direction. Near the edge of the
// image the kernel is renormalised to the part inside.
void Smooth(Grid<float>& image, double sigma_bins, double sigma_beams);

}  // namespace sonarcal
