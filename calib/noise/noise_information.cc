#include "calib/noise/noise_information.h"

#include <algorithm>
#include <cmath>

namespace sonarcal::calib {
namespace {

constexpr double kStep = 0.1;  // step of ln N: 0.4 dB, at most a few grey levels
constexpr double kLeastChance = 1e-12;

}  // namespace

PixelInformation ExpectedInformation(const GreyLevels& grey, int full_scale, double noise_power) {
  PixelInformation information = PixelInformation::Zero();
  GreyLevels::Chance lower = grey.Below(-1, noise_power);
  for (int level = 0; level <= full_scale && lower.beyond > kLeastChance; ++level) {
    const GreyLevels::Chance upper = grey.Below(level, noise_power);
    const GreyLevels::Chance chance = GreyLevels::Between(lower, upper);
    lower = upper;
    if (chance.value < kLeastChance) continue;
    const Eigen::Map<const Eigen::Vector<double, GreyLevels::kDerivatives>> derivative(
        chance.derivative.data());
    information += derivative * derivative.transpose() / chance.value;
  }
  return information;
}

InformationTable::InformationTable(const GreyLevels& grey, int full_scale, double least_power,
                                   double most_power)
    : first_(std::log(least_power)) {
  const int count = static_cast<int>(std::ceil((std::log(most_power) - first_) / kStep)) + 1;
  for (int i = 0; i < count; ++i) {
    entry_.push_back(ExpectedInformation(grey, full_scale, std::exp(first_ + kStep * i)));
  }
}

PixelInformation InformationTable::operator()(double noise_power) const {
  const double position = std::max(0.0, (std::log(noise_power) - first_) / kStep);
  const auto i = static_cast<std::size_t>(position);
  if (i + 1 >= entry_.size()) return entry_.back();
  const double fraction = position - static_cast<double>(i);
  return (1.0 - fraction) * entry_[i] + fraction * entry_[i + 1];
}

}  // namespace sonarcal::calib
