// When another pose or place counts as equally good.
#pragma once

namespace sonarcal::calib {

inline constexpr double kMaxWorseNats = 4.0;  // its fit is worse by at most this: odds of 55 to 1
// It differs from the best one by less than this, in standard deviations of the sum over the image.
inline constexpr double kMaxWorseSigmas = 2.0;

}  // namespace sonarcal::calib
