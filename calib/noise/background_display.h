// Display law from target-free pixels. Maximum likelihood of exponential power (or power with L looks)
// through the law, on counts of grey.
//
// Noise power is 0 dB in the result, because a recording without a stated level leaves it free. Fitted are
// the start of the display (db_min), the softening of the soft laws (soft_db) and, if the image states no dB
// span, the span; of a power law its full scale (db_max) and its exponent. Span or exponent and looks are one
// number on background alone, so that the looks are those given. Grey levels may have gaps, as in a stretched
// picture: a level that occurs stands for values up to half-way to its neighbours.
#pragma once

#include "core/types/image.h"
#include "core/types/mask.h"
#include "core/types/parameters.h"

namespace sonarcal::calib {

struct BackgroundDisplay {
  DisplayParameters<double> display;
  double looks = 1.0;
  double nats_per_pixel = 0.0;  // -log likelihood of a pixel's grey
  double ks = 0.0;              // largest distance between the cumulative distributions of law and pixels
};

// Throws DataError if `background` has no pixel.
BackgroundDisplay FitBackgroundDisplay(const PolarImage& image, const Mask& background, DisplayLaw law,
                                       double looks = 1.0);

}  // namespace sonarcal::calib
