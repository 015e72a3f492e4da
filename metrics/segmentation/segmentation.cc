#include "metrics/segmentation/segmentation.h"

#include "metrics/segmentation/scored_image.h"

namespace sonarcal::metrics {
namespace {

Segmentation SegmentScored(const Grid<float>& value, const ImageScale& scale,
                           const SegmentationOptions& options, const Mask* region, const Mask* valid) {
  const ScoredImage scored(value, scale, options, region, valid);
  const double threshold = scored.ThresholdAt(scored.setting());
  return {scored.ObjectAbove(threshold), threshold};
}

}  // namespace

Segmentation Segment(const Grid<float>& value, double full_scale, const SegmentationOptions& options,
                     const Mask* region, const Mask* valid) {
  ImageScale scale;
  scale.full_scale = full_scale;
  return SegmentScored(value, scale, options, region, valid);
}

Segmentation Segment(const PolarImage& image, const SegmentationOptions& options, const Mask* region,
                     const Mask* valid) {
  return SegmentScored(image.value, image.scale, options, region, valid);
}

Segmentation Segment(const FanImage& image, const SegmentationOptions& options, const Mask* region) {
  if (StatesFalseAlarmRate(options.method)) {
    throw DataError("segmentation by {} of a fan image, whose pixels are interpolated; expected a polar one",
                    ToString(options.method));
  }
  return SegmentScored(image.value, image.scale, options, region, &image.inside);
}

}  // namespace sonarcal::metrics
