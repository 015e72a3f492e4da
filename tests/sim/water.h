// The water of the tests of images.
#pragma once

namespace sonarcal::testing {

inline constexpr double kAlphaDbPerM = 0.31;

}  // namespace sonarcal::testing
