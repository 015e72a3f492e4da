#include "apps/report/pictures/depth_picture.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "data_io/pictures/picture.h"

namespace sonarcal::report {

Grid<std::uint16_t> DepthInMillimetres(const Grid<float>& range_m) {
  constexpr double kMax = std::numeric_limits<std::uint16_t>::max();
  Grid<std::uint16_t> depth_mm(range_m.rows(), range_m.cols());
  for (std::size_t i = 0; i < range_m.size(); ++i) {
    if (!(range_m.values()[i] > 0.0F)) continue;
    // At least 1, because 0 means that nothing was hit.
    depth_mm.values()[i] = static_cast<std::uint16_t>(
        std::clamp(std::round(1000.0 * static_cast<double>(range_m.values()[i])), 1.0, kMax));
  }
  return depth_mm;
}

RgbImage DepthPicture(const Grid<float>& range_m, double farthest_m) {
  Grid<float> nearness(range_m.rows(), range_m.cols());
  Mask met(range_m.rows(), range_m.cols());
  for (std::size_t i = 0; i < range_m.size(); ++i) {
    met.values()[i] = range_m.values()[i] > 0.0F ? 1 : 0;
    nearness.values()[i] = -range_m.values()[i];
  }
  return data_io::Colorize(nearness, {-farthest_m, 0.0}, data_io::ColorMap::kViridis, &met);
}

}  // namespace sonarcal::report
