// Soft display law from target-free pixels, where the slope of the display is known. Maximum likelihood of
// exponential power (or power with L looks) through the law, on counts of grey.
//
// Noise power is 0 dB in the result, because a recording without a stated level leaves it free. Two numbers
// are fitted: the start of the display (db_min) and its softening (soft_db). db_max follows from the span.
// Grey levels may have gaps, as in a stretched picture: a level that occurs stands for values up to half-way
// to its neighbours.
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

// `law` is kSoftLog or kSoftAmplitude. Throws DataError if the image states no dB span or if `background` has
// no pixel.
BackgroundDisplay FitBackgroundDisplay(const PolarImage& image, const Mask& background, DisplayLaw law,
                                       double looks = 1.0);

}  // namespace sonarcal::calib
