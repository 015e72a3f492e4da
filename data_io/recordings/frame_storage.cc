#include "data_io/recordings/frame_storage.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "core/types/error.h"

namespace sonarcal::data_io {

int MinBits(const ImageScale& scale) {
  const bool has_levels = scale.quantity == Quantity::kGrey && scale.full_scale > 1.0 &&
                          scale.full_scale <= 65535.0 && scale.full_scale == std::floor(scale.full_scale);
  return !has_levels ? 32 : scale.full_scale > 255.0 ? 16 : 8;
}

void CheckValues(const PolarImage& image, const std::string& what) {
  const bool is_grey = image.scale.quantity == Quantity::kGrey;
  const auto full_scale = static_cast<float>(image.scale.full_scale);
  const auto is_good = [&](float v) { return is_grey ? v >= 0.0F && v <= full_scale : std::isfinite(v); };
  const std::span<const float> values = image.value.values();
  const auto bad = std::find_if_not(values.begin(), values.end(), is_good);
  if (bad == values.end()) return;
  const auto index = static_cast<int>(bad - values.begin());
  throw DataError("{}: the pixel in row {}, column {} is {}, expected {}", what, index / image.value.cols(),
                  index % image.value.cols(), *bad,
                  is_grey ? fmt::format("0 .. full_scale, {}", full_scale) : "a finite number");
}

void CheckSameAsFirst(const RecordingInfo& info, const Frame& frame, int index) {
  std::string why;
  if (!info.sonar.axes.Matches(frame.image.axes, &why)) {
    throw DataError("{}: frame {} differs from the first: {}; expected one geometry for all frames",
                    info.source, index, why);
  }
  if (frame.image.scale != info.scale) {
    throw DataError(
        "{}: frame {} differs from the first in the scale of its values, expected one scale for all frames",
        info.source, index);
  }
}

}  // namespace sonarcal::data_io
