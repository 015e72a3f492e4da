// A soft display law read off target-free pixels, where the display's slope is known: maximum likelihood of
// exponential (or L looks') power carried through the law, on counts of grey.
//
// Noise power is 0 dB in the result: a recording that states no level leaves that free. So two numbers are
// fitted, where the display begins (db_min) and how it is softened (soft_db); db_max follows from the span.
// Grey levels may have gaps, as in a picture that was stretched: a level that occurs holds what lies half-way
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
  double ks = 0.0;              // largest distance between the law's and the pixels' cumulative shares
};

// `law` is kSoftLog or kSoftAmplitude. Throws DataError where the image states no dB span or `background` has
// no pixel.
BackgroundDisplay FitBackgroundDisplay(const PolarImage& image, const Mask& background, DisplayLaw law,
                                       double looks = 1.0);

}  // namespace sonarcal::calib
