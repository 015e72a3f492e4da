// What one pixel tells about a noise law before it is seen: Fisher's expected information
// sum over grey levels of (d chance)(d chance)^T / chance, by the derivatives of GreyLevels. Positive
// semi-definite whatever the law, and never larger than a pixel deserves: the outer product of scores that
// were seen stands for it near the optimum only, and is (x - 1)^2 where 1 is right for a pixel x times
// brighter than the law says.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/noise/noise_likelihood.h"

namespace sonarcal::calib {

using PixelInformation = Eigen::Matrix<double, GreyLevels::kDerivatives, GreyLevels::kDerivatives>;

// `full_scale` as of `grey`. noise_power > 0.
PixelInformation ExpectedInformation(const GreyLevels& grey, int full_scale, double noise_power);

// The same for many cells: tabulated over ln N and interpolated, to 1 % of the diagonal.
class InformationTable {
 public:
  // 0 < least_power <= most_power: the powers that will be asked for.
  InformationTable(const GreyLevels& grey, int full_scale, double least_power, double most_power);

  PixelInformation operator()(double noise_power) const;

 private:
  double first_ = 0.0;  // ln N of the first entry
  std::vector<PixelInformation> entry_;
};

}  // namespace sonarcal::calib
