#include "metrics/find_objects.h"

#include <optional>
#include <utility>

#include "metrics/segmentation/scored_image.h"

namespace sonarcal::metrics {
namespace {

// Simulated object at any setting of the segmentation.
class SimulatedRegion {
 public:
  SimulatedRegion(const PolarImage& image, const CompareOptions& options, const Mask* region,
                  const Mask* valid) {
    if (options.simulated_object == SimulatedObject::kSameRule) {
      scored_.emplace(image.value, image.scale, options.segmentation, region, valid);
      return;
    }
    echoes_.threshold = options.echo_fraction * image.scale.full_scale;
    echoes_.object = Mask(image.value.rows(), image.value.cols());
    const auto may_be = [&](const Mask* mask, std::size_t i) {
      return mask == nullptr || mask->values()[i] != 0;
    };
    for (std::size_t i = 0; i < image.value.size(); ++i) {
      echoes_.object.values()[i] =
          may_be(region, i) && may_be(valid, i) && image.value.values()[i] > echoes_.threshold ? 1 : 0;
    }
  }

  Segmentation AsChosen() const { return scored_ ? At(scored_->setting()) : echoes_; }

  Segmentation At(double setting) const {
    if (!scored_) return echoes_;
    const double threshold = scored_->ThresholdAt(setting);
    return {scored_->ObjectAbove(threshold), threshold};
  }

 private:
  std::optional<ScoredImage> scored_;
  Segmentation echoes_;
};

}  // namespace

ObjectRegions FindObjects(const PolarImage& real, const PolarImage& simulated, const CompareOptions& options,
                          const Mask* region, const Mask* valid) {
  const SimulatedRegion simulated_region(simulated, options, region, valid);
  ObjectRegions found;
  found.simulated = simulated_region.AsChosen();
  // Region near the simulated object at the chosen setting. The sweep uses it at all settings.
  std::optional<Mask> near;
  if (options.region_margin_m) {
    near = DilatedByMetres(found.simulated.object, real.axes, *options.region_margin_m);
  }
  const Mask* within = near ? &*near : nullptr;
  const ScoredImage in_real(real.value, real.scale, options.segmentation, region, valid);
  found.real.threshold = in_real.ThresholdAt(in_real.setting());
  found.real.object = in_real.ObjectAbove(found.real.threshold, within);
  for (const double setting : SweepSettings(options.sweep, options.segmentation.method)) {
    found.sweep.push_back(CountOccupancy(in_real.ObjectAbove(in_real.ThresholdAt(setting), within),
                                         simulated_region.At(setting).object));
  }
  return found;
}

}  // namespace sonarcal::metrics
