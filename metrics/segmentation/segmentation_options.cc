#include "metrics/segmentation/segmentation_options.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "core/types/error.h"

namespace sonarcal::metrics {
namespace {

template <typename T>
void Require(bool condition, std::string_view field, T value, std::string_view expected) {
  if (!condition) throw DataError("segmentation {} is {}, expected {}", field, value, expected);
}

}  // namespace

bool StatesFalseAlarmRate(SegmentationMethod method) {
  return method == SegmentationMethod::kCaCfar || method == SegmentationMethod::kOsCfar ||
         method == SegmentationMethod::kLikelihoodRatio;
}

void SegmentationOptions::Check() const {
  Require(std::isfinite(sigma_count) && sigma_count > 0.0, "sigma_count", sigma_count, "more than 0");
  Require(min_contrast >= 0.0 && min_contrast <= 1.0, "min_contrast", min_contrast, "0 to 1");
  Require(threshold_fraction >= 0.0 && threshold_fraction <= 1.0, "threshold_fraction", threshold_fraction,
          "0 to 1");
  Require(median_px == 0 || median_px == 3 || median_px == 5, "median_px", median_px, "0, 3 or 5");
  for (const auto& [field, value] : {std::pair{"blur_rows", blur_rows}, {"blur_cols", blur_cols}}) {
    Require(value >= 0.0 && value <= 100.0, field, value, "0 to 100");
  }
  for (const auto& [field, value] : {std::pair{"open_rows", open_rows},
                                     {"open_cols", open_cols},
                                     {"close_rows", close_rows},
                                     {"close_cols", close_cols}}) {
    Require(value >= 0 && value <= 1001, field, value, "0 to 1001");
  }
  for (const auto& [field, value] :
       {std::pair{"min_area_px", min_area_px}, {"max_rows", max_rows}, {"max_cols", max_cols}}) {
    Require(value >= 0, field, value, "0 or more");
  }

  Require(contrast >= 0.0 && contrast <= 1.0, "contrast", contrast, "0 to 1");
  if (contrast_db) {
    Require(*contrast_db >= 0.0 && *contrast_db <= 200.0, "contrast_db", *contrast_db, "0 to 200");
  }
  for (const auto& [field, value] : {std::pair{"guard_rows", guard_rows},
                                     {"guard_cols", guard_cols},
                                     {"training_rows", training_rows},
                                     {"training_cols", training_cols}}) {
    Require(value >= 0 && value <= 1000, field, value, "0 to 1000");
  }
  Require(training_rows + training_cols > 0, "training_rows", training_rows,
          "more than 0, as training_cols is 0");
  Require(false_alarm_rate > 0.0 && false_alarm_rate < 1.0, "false_alarm_rate", false_alarm_rate,
          "more than 0 and less than 1");
  for (const auto& [field, value] : {std::pair{"cell_rows", cell_rows}, {"cell_cols", cell_cols}}) {
    Require(value >= 1 && value <= 101 && value % 2 == 1, field, value, "an odd number from 1 to 101");
  }
  Require(looks >= kMinLooks && looks <= kMaxLooks, "looks", looks,
          fmt::format("{} to {}", kMinLooks, kMaxLooks));
  Require(os_quantile >= 0.01 && os_quantile <= 0.99, "os_quantile", os_quantile, "0.01 to 0.99");
  if (method == SegmentationMethod::kLikelihoodRatio && background_law == nullptr) {
    throw DataError(
        "segmentation by likelihood_ratio has no law of the background, expected one that was fitted to "
        "pings without targets");
  }
}

}  // namespace sonarcal::metrics
