// The law of an image's background as plain numbers, from whoever fitted it (`sonarcal fit --noise-only`).
//
// A pixel's received power is mean_power times a Gamma variable of mean 1 and shape `looks`, independent of
// its neighbours'; the display shows power P as that value v for which power_of_value(v) = P.
#pragma once

#include <functional>

#include "core/types/image.h"

namespace sonarcal::metrics {

struct BackgroundLaw {
  Grid<float> mean_power;  // range_bins x beam_count, more than 0, in any unit
  double looks = 1.0;      // 0.5..1000
  // Power shown as v, in parts of full scale, 0..1; rising, in the unit of mean_power.
  std::function<double(double value)> power_of_value;
};

// Powers of grey levels 0..full_scale. Level g stands for values from g - 1/2 to g + 1/2, of which the middle
// is taken; 0 stands for all that is clipped, of which half the power at its upper edge is.
Grid<float> PowerOfGrey(const Grid<float>& grey, double full_scale,
                        const std::function<double(double value)>& power_of_value);

// v = level / span_db: a logarithm over `span_db` > 0, in units of the power shown as 0.
std::function<double(double value)> LogDisplayPower(double span_db);

}  // namespace sonarcal::metrics
