#include "metrics/json/sweep_json.h"

#include <nlohmann/json.hpp>

#include "metrics/segmentation/scored_image.h"

namespace sonarcal::metrics {
namespace {

using Json = nlohmann::ordered_json;

Json CurveJson(const ThresholdSweep& sweep, const std::vector<std::optional<double>>& curve) {
  Json heights = Json::array();
  for (const std::optional<double>& height : curve) heights.push_back(height ? Json(*height) : Json(nullptr));
  const std::optional<SweepArea> area = sweep.AreaUnder(curve);
  return {{"curve", std::move(heights)},
          {"area", area ? Json(area->area) : Json(nullptr)},
          {"axis_share", area ? area->axis_share : 0.0}};
}

}  // namespace

Json SweepJson(const ThresholdSweep& sweep, SegmentationMethod method) {
  Json json;
  json["method"] = std::string(ToString(method));
  json["setting"] = std::string(SettingUnit(method));
  json["settings"] = sweep.settings();
  json["frames"] = sweep.frames();
  for (std::size_t i = 0; i < sweep.settings().size(); ++i) {
    json["counts"]["ns"].push_back(sweep.Pooled(i).ns);
    json["counts"]["nr"].push_back(sweep.Pooled(i).nr);
    json["counts"]["na"].push_back(sweep.Pooled(i).na);
  }
  for (int ratio = 0; ratio < kSweepRatios; ++ratio) {
    json["micro"][kSweptRatios[ratio].name] = CurveJson(sweep, sweep.MicroCurve(ratio));
    json["macro"][kSweptRatios[ratio].name] = CurveJson(sweep, sweep.MacroCurve(ratio));
  }
  return json;
}

}  // namespace sonarcal::metrics
