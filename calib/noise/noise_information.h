// Expected information of one pixel on a noise law (Fisher): the sum over grey levels of (d chance)(d
// chance)^T / chance, with the derivatives of GreyLevels. It is positive semi-definite for any law. The outer
// product of observed scores would replace it only near the optimum. For a pixel x times brighter than the
// law it is (x - 1)^2 instead of 1.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "calib/noise/noise_likelihood.h"

namespace sonarcal::calib {

using PixelInformation = Eigen::Matrix<double, GreyLevels::kDerivatives, GreyLevels::kDerivatives>;

// `full_scale` as in `grey`. noise_power > 0.
PixelInformation ExpectedInformation(const GreyLevels& grey, int full_scale, double noise_power);

// As above for many cells: a table over ln N, interpolated, accurate to 1 % of the diagonal.
class InformationTable {
 public:
  // 0 < least_power <= most_power: range of the powers in later calls.
  InformationTable(const GreyLevels& grey, int full_scale, double least_power, double most_power);

  PixelInformation operator()(double noise_power) const;

 private:
  double first_ = 0.0;  // ln N of the first entry
  std::vector<PixelInformation> entry_;
};

}  // namespace sonarcal::calib
