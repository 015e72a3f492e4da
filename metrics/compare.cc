#include "metrics/compare.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "metrics/find_objects.h"

namespace sonarcal::metrics {
namespace {

void CheckWhole(const PolarImage& image, std::string_view which) {
  image.axes.Validate(fmt::format("the {} frame", which));
  if (image.value.rows() != image.axes.range_bins || image.value.cols() != image.axes.beam_count()) {
    throw DataError("the {} frame holds {} x {} pixels, expected {} range bins x {} beams", which,
                    image.value.rows(), image.value.cols(), image.axes.range_bins, image.axes.beam_count());
  }
  if (image.scale.quantity != Quantity::kGrey) {
    throw DataError("quantity: the {} frame holds {}, expected grey levels as displayed", which,
                    ToString(image.scale.quantity));
  }
  if (!(std::isfinite(image.scale.full_scale) && image.scale.full_scale > 0.0)) {
    throw DataError("full_scale: that of the {} frame is {}, expected more than 0", which,
                    image.scale.full_scale);
  }
}

void CheckLevel(std::string_view field, const std::optional<double>& real,
                const std::optional<double>& simulated, double tolerance) {
  if (!real || !simulated || std::abs(*real - *simulated) <= tolerance) return;
  throw DataError("{}: the real frame has {} dB, the simulated one {} dB; expected the same", field, *real,
                  *simulated);
}

bool StatesScale(const ImageScale& scale) {
  return scale.db_min || scale.db_max || scale.db_span;
}

// Returns null if there is no mask.
const Mask* MaskFor(const std::optional<Mask>& mask, const PolarImage& image, std::string_view which) {
  if (!mask) return nullptr;
  if (mask->rows() != image.value.rows() || mask->cols() != image.value.cols()) {
    throw DataError("{} has {} x {} pixels, expected {} range bins x {} beams", which, mask->rows(),
                    mask->cols(), image.value.rows(), image.value.cols());
  }
  return &*mask;
}

// Pixels of the fan that are interpolated from valid samples only.
Mask MadeOf(const Mask& valid, const FanMap& map) {
  Grid<float> share(valid.rows(), valid.cols());
  std::ranges::copy(valid.values(), share.values().begin());
  const Grid<float> in_fan = map.Apply(share);
  Mask made(in_fan.rows(), in_fan.cols());
  for (std::size_t i = 0; i < made.size(); ++i) {
    made.values()[i] = map.inside().values()[i] != 0 && in_fan.values()[i] > 0.9999F;
  }
  return made;
}

// `levels` receives the counts from which the distances are computed.
ViewMetrics Measure(const Grid<float>& real, const Grid<float>& simulated, const ImageScale& scale,
                    const Mask& real_object, const Mask& simulated_object, double echo_level,
                    const Mask* inside, LevelHistograms& levels) {
  const double full_scale = scale.full_scale;
  levels = CountLevels(real, simulated, full_scale, real_object, simulated_object, echo_level, inside);
  levels.span_db = DbSpan(scale);
  return {
      .occupancy = CountOccupancy(real_object, simulated_object),
      .outline = {},
      .intensity = MeasureIntensityError(real, simulated, full_scale, real_object, simulated_object, inside),
      .ssim = MeasureSsim(real, simulated, full_scale, real_object, simulated_object, inside),
      .echoes = CountEchoes(real, simulated, echo_level, inside),
      .texture = MeasureTexture(real, simulated, real_object, simulated_object, inside),
      .speckle = {},
      .distribution = levels.Distances()};
}

}  // namespace

void CompareOptions::Check() const {
  segmentation.Check();
  sweep.Check(segmentation.method);
  if (!(echo_fraction >= 0.0 && echo_fraction <= 1.0)) {
    throw DataError("echo_fraction is {}, expected 0 to 1", echo_fraction);
  }
  if (region_margin_m && !(*region_margin_m >= 0.0 && *region_margin_m <= 100.0)) {
    throw DataError("region_margin_m is {} m, expected 0 to 100", *region_margin_m);
  }
  fan.Check();
  if (!(db_tolerance >= 0.0)) throw DataError("db_tolerance is {} dB, expected 0 or more", db_tolerance);
}

ViewMetrics& ViewMetrics::operator+=(const ViewMetrics& other) {
  occupancy += other.occupancy;
  outline += other.outline;
  intensity += other.intensity;
  ssim += other.ssim;
  echoes += other.echoes;
  texture += other.texture;
  speckle += other.speckle;
  distribution = {};
  return *this;
}

FrameLevels& FrameLevels::operator+=(const FrameLevels& other) {
  polar += other.polar;
  fan += other.fan;
  return *this;
}

std::optional<double> DbSpan(const ImageScale& scale) {
  if (scale.db_min && scale.db_max) return *scale.db_max - *scale.db_min;
  return scale.db_span;
}

void CheckComparable(const PolarImage& real, const PolarImage& simulated, double db_tolerance,
                     std::vector<std::string>* notes) {
  // Differences between the frames are reported before faults of one frame: two frames in dB do not differ.
  if (real.scale.quantity != simulated.scale.quantity) {
    throw DataError("quantity: the real frame holds {}, the simulated one {}; expected the same",
                    ToString(real.scale.quantity), ToString(simulated.scale.quantity));
  }
  CheckWhole(real, "real");
  CheckWhole(simulated, "simulated");
  if (real.scale.full_scale != simulated.scale.full_scale) {
    throw DataError("full_scale: the real frame has {}, the simulated one {}; expected the same",
                    real.scale.full_scale, simulated.scale.full_scale);
  }
  CheckLevel("db_min", real.scale.db_min, simulated.scale.db_min, db_tolerance);
  CheckLevel("db_max", real.scale.db_max, simulated.scale.db_max, db_tolerance);
  CheckLevel("db_span", DbSpan(real.scale), DbSpan(simulated.scale), db_tolerance);
  std::string why;
  if (!real.axes.Matches(simulated.axes, &why)) {
    throw DataError("geometry: the real and the simulated frame have {}; expected the same", why);
  }
  if (notes != nullptr && StatesScale(real.scale) != StatesScale(simulated.scale)) {
    notes->push_back(
        fmt::format("only the {} frame states its dB scale; the other is assumed to have the same",
                    StatesScale(real.scale) ? "real" : "simulated"));
  }
}

FrameComparer::FrameComparer(CompareOptions options) : options_(std::move(options)) {
  options_.Check();
}

const FanMap& FrameComparer::MapFor(const PolarAxes& axes) {
  if (!map_ || !map_->polar_axes().Matches(axes)) map_.emplace(axes, options_.fan);
  return *map_;
}

FrameMetrics FrameComparer::Compare(const PolarImage& real, const PolarImage& simulated,
                                    const PixelBox* box) {
  FrameMetrics metrics;
  CheckComparable(real, simulated, options_.db_tolerance, &metrics.notes);
  const Mask* region = MaskFor(options_.region, real, "the region of interest");
  std::optional<Mask> in_box;
  if (box != nullptr) {
    in_box = Both(options_.region, MaskOf(*box, real.value.rows(), real.value.cols()));
    region = &*in_box;
    metrics.object_box = *box;
    if (box->empty()) metrics.notes.emplace_back("the object of the scene is not visible in the frame");
  }
  const Mask* valid = MaskFor(options_.valid, real, "the mask of valid samples");
  ObjectRegions found = FindObjects(real, simulated, options_, region, valid);
  const Segmentation& in_real = found.real;
  const Segmentation& in_simulated = found.simulated;
  metrics.sweep = std::move(found.sweep);
  metrics.threshold_real = in_real.threshold;
  metrics.threshold_simulated = in_simulated.threshold;
  const ImageScale& scale = StatesScale(real.scale) ? real.scale : simulated.scale;
  const double echo_level = EchoLevel(real.value, valid);
  FrameLevels& levels = metrics.levels.emplace();
  metrics.polar = Measure(real.value, simulated.value, scale, in_real.object, in_simulated.object, echo_level,
                          valid, levels.polar);
  metrics.polar.outline = MeasureOutlines(in_real.object, in_simulated.object, real.axes);
  metrics.polar.speckle =
      MeasureSpeckle(real.value, simulated.value, scale, in_real.object, in_simulated.object, valid);

  for (const auto& [which, count] :
       {std::pair{"real", metrics.polar.occupancy.nr}, std::pair{"simulated", metrics.polar.occupancy.ns}}) {
    if (count == 0) metrics.notes.push_back(fmt::format("no object was found in the {} frame", which));
  }

  const FanMap& map = MapFor(real.axes);
  Mask fan_real = map.ApplyNearest(in_real.object);
  Mask fan_simulated = map.ApplyNearest(in_simulated.object);
  std::optional<Mask> fan_inside;  // set if some samples are invalid
  if (valid != nullptr) fan_inside = MadeOf(*valid, map);
  metrics.fan = Measure(map.Apply(real.value), map.Apply(simulated.value), scale, fan_real, fan_simulated,
                        echo_level, fan_inside ? &*fan_inside : &map.inside(), levels.fan);
  if (options_.keep_masks) {
    metrics.masks = FrameMasks{std::move(found.real.object), std::move(found.simulated.object),
                               std::move(fan_real), std::move(fan_simulated)};
  }
  return metrics;
}

FrameMetrics CompareFrames(const PolarImage& real, const PolarImage& simulated,
                           const CompareOptions& options) {
  return FrameComparer(options).Compare(real, simulated);
}

}  // namespace sonarcal::metrics
