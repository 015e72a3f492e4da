#include "metrics/segmentation/likelihood_ratio.h"

#include <cmath>

#include "core/math/local_sums.h"
#include "metrics/segmentation/false_alarm.h"

namespace sonarcal::metrics {

Grid<float> LikelihoodDecades(const Grid<float>& grey, double full_scale, const BackgroundLaw& law,
                              int cell_rows, int cell_cols, const Mask* valid) {
  if (law.mean_power.rows() != grey.rows() || law.mean_power.cols() != grey.cols()) {
    throw DataError("the background's law is one of {} x {} pixels, expected {} range bins x {} beams",
                    law.mean_power.rows(), law.mean_power.cols(), grey.rows(), grey.cols());
  }
  if (!(law.looks >= kMinLooks && law.looks <= kMaxLooks)) {
    throw DataError("the background's law has {} looks, expected {} to {}", law.looks, kMinLooks, kMaxLooks);
  }
  Grid<float> ratio = PowerOfGrey(grey, full_scale, law.power_of_value);
  for (std::size_t i = 0; i < ratio.size(); ++i) {
    const float background = law.mean_power.values()[i];
    if (!(background > 0.0F) || !std::isfinite(background)) {
      throw DataError("the background's law has power {} at (row {}, column {}), expected more than 0",
                      background, i / grey.cols(), i % grey.cols());
    }
    ratio.values()[i] /= background;
  }
  const double looks = law.looks * cell_rows * cell_cols;
  Grid<float> decades = BoxMean(ratio, cell_rows, cell_cols, valid);
  const DecadesTable tail([looks](double mean) { return GammaTailDecades(looks, mean); });
  for (float& value : decades.values()) value = static_cast<float>(tail(value));
  return decades;
}

}  // namespace sonarcal::metrics
