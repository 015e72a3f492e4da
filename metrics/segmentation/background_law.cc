#include "metrics/segmentation/background_law.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/types/units.h"

namespace sonarcal::metrics {

Grid<float> PowerOfGrey(const Grid<float>& grey, double full_scale,
                        const std::function<double(double value)>& power_of_value) {
  SONARCAL_CHECK(full_scale > 0.0, "full scale {}", full_scale);
  const double clipped = 0.5 * power_of_value(0.5 / full_scale);
  const auto power_of = [&](double level) {
    const double value = std::min(level / full_scale, 1.0);
    // Values below half a level were clipped. A display may show no power that low.
    return level < 0.5 ? clipped : std::max(power_of_value(value), clipped);
  };
  // Whole levels are few, so they are looked up in a table.
  constexpr double kMaxLevels = 65535.0;
  std::vector<float> of_level;
  if (full_scale <= kMaxLevels) {
    for (int level = 0; level <= static_cast<int>(full_scale); ++level) {
      of_level.push_back(static_cast<float>(power_of(level)));
    }
  }
  Grid<float> power(grey.rows(), grey.cols());
  for (std::size_t i = 0; i < grey.size(); ++i) {
    const float level = grey.values()[i];
    const bool whole =
        level >= 0.0F && level < static_cast<float>(of_level.size()) && level == std::floor(level);
    power.values()[i] =
        whole ? of_level[static_cast<std::size_t>(level)] : static_cast<float>(power_of(level));
  }
  return power;
}

std::function<double(double value)> LogDisplayPower(double span_db) {
  SONARCAL_CHECK(span_db > 0.0, "a display over {} dB", span_db);
  const double nepers = span_db * kNeperPerDb;
  return [nepers](double value) { return std::exp(nepers * value); };
}

}  // namespace sonarcal::metrics
