#include "metrics/json/segmentation_json.h"

#include <string>
#include <utility>

#include <nlohmann/json.hpp>

namespace sonarcal::metrics {
namespace {

using Json = nlohmann::ordered_json;

void PutRing(Json& parameters, const SegmentationOptions& options) {
  parameters["guard_rows"] = options.guard_rows;
  parameters["guard_cols"] = options.guard_cols;
  parameters["training_rows"] = options.training_rows;
  parameters["training_cols"] = options.training_cols;
}

void PutCell(Json& parameters, const SegmentationOptions& options) {
  parameters["false_alarm_rate"] = options.false_alarm_rate;
  parameters["cell_rows"] = options.cell_rows;
  parameters["cell_cols"] = options.cell_cols;
}

void PutSmoothing(Json& parameters, const SegmentationOptions& options) {
  parameters["median_px"] = options.median_px;
  parameters["blur_rows"] = options.blur_rows;
  parameters["blur_cols"] = options.blur_cols;
}

void PutTidying(Json& parameters, const SegmentationOptions& options) {
  parameters["open_rows"] = options.open_rows;
  parameters["open_cols"] = options.open_cols;
  parameters["close_rows"] = options.close_rows;
  parameters["close_cols"] = options.close_cols;
  parameters["min_area_px"] = options.min_area_px;
  parameters["max_rows"] = options.max_rows;
  parameters["max_cols"] = options.max_cols;
  parameters["largest_component_only"] = options.largest_component_only;
  parameters["fill"] = std::string(ToString(options.fill));
}

}  // namespace

Json SegmentationJson(const SegmentationOptions& options) {
  Json parameters = Json::object();
  switch (options.method) {
    case SegmentationMethod::kBackgroundSigma:
      parameters["background"] = std::string(ToString(options.background));
      parameters["sigma_count"] = options.sigma_count;
      parameters["min_contrast"] = options.min_contrast;
      PutSmoothing(parameters, options);
      break;
    case SegmentationMethod::kFixedThreshold:
      parameters["threshold_fraction"] = options.threshold_fraction;
      PutSmoothing(parameters, options);
      break;
    case SegmentationMethod::kOtsu:
    case SegmentationMethod::kTriangle:
      PutSmoothing(parameters, options);
      break;
    case SegmentationMethod::kLocalContrast:
      if (options.contrast_db) {
        parameters["contrast_db"] = *options.contrast_db;
      } else {
        parameters["contrast"] = options.contrast;
      }
      PutRing(parameters, options);
      PutSmoothing(parameters, options);
      break;
    case SegmentationMethod::kOsCfar:
    case SegmentationMethod::kCaCfar:
      PutCell(parameters, options);
      parameters["looks"] = options.looks;
      parameters["domain"] = std::string(ToString(options.cfar_domain));
      if (options.method == SegmentationMethod::kOsCfar) parameters["os_quantile"] = options.os_quantile;
      PutRing(parameters, options);
      break;
    case SegmentationMethod::kLikelihoodRatio:
      PutCell(parameters, options);
      if (options.background_law) parameters["looks"] = options.background_law->looks;
      break;
  }
  PutTidying(parameters, options);
  Json json;
  json["method"] = std::string(ToString(options.method));
  json["parameters"] = std::move(parameters);
  return json;
}

}  // namespace sonarcal::metrics
