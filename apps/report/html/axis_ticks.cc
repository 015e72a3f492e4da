#include "apps/report/html/axis_ticks.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace sonarcal::report {

double NiceStep(double span, int count) {
  const double rough = span / count;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= rough * (1.0 - 1e-9)) return factor * power;
  }
  return 10.0 * power;
}

int DecimalsOf(double step) {
  return std::max(0, -static_cast<int>(std::floor(std::log10(step) + 1e-9)));
}

std::vector<double> TicksWithin(double min, double max, double step) {
  std::vector<double> ticks;
  const auto first = static_cast<std::int64_t>(std::ceil(min / step - 1e-9));
  const auto last = static_cast<std::int64_t>(std::floor(max / step + 1e-9));
  for (std::int64_t i = first; i <= last; ++i) ticks.push_back(static_cast<double>(i) * step);
  return ticks;
}

}  // namespace sonarcal::report
