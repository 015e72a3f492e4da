// Distribution of an image's background as plain numbers, e.g. from `sonarcal fit --noise-only`.
//
// The received power of a pixel is mean_power times a Gamma variable of mean 1 and shape `looks`, independent
// between pixels. For a background with texture (K law, fewer than one look) this has the right variance. The
// display shows power P as the value v with power_of_value(v) = P.
#pragma once

#include <functional>

#include "core/types/image.h"

namespace sonarcal::metrics {

inline constexpr double kMinLooks = 0.05;
inline constexpr double kMaxLooks = 1000.0;

struct BackgroundLaw {
  Grid<float> mean_power;  // range_bins x beam_count, positive, in any unit
  double looks = 1.0;      // kMinLooks..kMaxLooks
  // Power displayed as v (fraction of full scale, 0..1), increasing, in the unit of mean_power.
  std::function<double(double value)> power_of_value;
};

// Powers of grey levels 0..full_scale. Level g stands for values from g - 1/2 to g + 1/2; its power is that
// of the middle. Level 0 stands for all clipped values; its power is half the power at its upper edge.
Grid<float> PowerOfGrey(const Grid<float>& grey, double full_scale,
                        const std::function<double(double value)>& power_of_value);

// Logarithmic display over `span_db` > 0: v = level / span_db. Unit: the power displayed as 0.
std::function<double(double value)> LogDisplayPower(double span_db);

}  // namespace sonarcal::metrics
