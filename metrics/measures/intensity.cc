#include "metrics/measures/intensity.h"

#include <algorithm>
#include <cmath>

#include "core/types/units.h"

namespace sonarcal::metrics {
namespace {

constexpr double kRounding = 1e-12;  // relative rounding error of sums over the pixels of an image

std::optional<double> Mean(double sum, std::int64_t count) {
  if (count == 0) return std::nullopt;
  return sum / static_cast<double>(count);
}

template <typename T>
void CheckShape(const Grid<T>& grid, const Grid<float>& real, std::string_view name) {
  SONARCAL_CHECK(grid.rows() == real.rows() && grid.cols() == real.cols(), "{} {} x {}, real image {} x {}",
                 name, grid.rows(), grid.cols(), real.rows(), real.cols());
}

}  // namespace

std::optional<double> DifferenceSums::mean_absolute() const {
  return Mean(absolute, pixels);
}

std::optional<double> DifferenceSums::mean_square() const {
  return Mean(square, pixels);
}

std::optional<double> DifferenceSums::rmse() const {
  if (pixels == 0) return std::nullopt;
  return std::sqrt(*mean_square());
}

std::optional<double> DifferenceSums::bias() const {
  return Mean(signed_sum, pixels);
}

std::optional<double> DifferenceSums::relative() const {
  if (!(real > 0.0)) return std::nullopt;
  return absolute / real;
}

std::optional<double> DifferenceSums::correlation() const {
  if (pixels == 0) return std::nullopt;
  const auto count = static_cast<double>(pixels);
  const double real_variance = real_square - real * real / count;
  const double simulated_variance = simulated_square - simulated * simulated / count;
  // The variance of a constant image is below the rounding error.
  if (!(real_variance > kRounding * real_square) || !(simulated_variance > kRounding * simulated_square)) {
    return std::nullopt;
  }
  return std::clamp((product - real * simulated / count) / std::sqrt(real_variance * simulated_variance),
                    -1.0, 1.0);
}

void DifferenceSums::Add(double real_value, double simulated_value) {
  const double difference = simulated_value - real_value;
  ++pixels;
  absolute += std::abs(difference);
  square += difference * difference;
  signed_sum += difference;
  real += real_value;
  real_square += real_value * real_value;
  simulated += simulated_value;
  simulated_square += simulated_value * simulated_value;
  product += real_value * simulated_value;
}

DifferenceSums& DifferenceSums::operator+=(const DifferenceSums& other) {
  pixels += other.pixels;
  absolute += other.absolute;
  square += other.square;
  signed_sum += other.signed_sum;
  real += other.real;
  real_square += other.real_square;
  simulated += other.simulated;
  simulated_square += other.simulated_square;
  product += other.product;
  return *this;
}

std::optional<double> PsnrDb(double mean_square) {
  if (!(mean_square > 0.0)) return std::nullopt;
  return -DbFromPower(mean_square);
}

std::optional<double> ObjectLevels::mean_difference() const {
  if (real_pixels == 0 || simulated_pixels == 0) return std::nullopt;
  return std::abs(simulated / static_cast<double>(simulated_pixels) -
                  real / static_cast<double>(real_pixels));
}

ObjectLevels& ObjectLevels::operator+=(const ObjectLevels& other) {
  real_pixels += other.real_pixels;
  real += other.real;
  simulated_pixels += other.simulated_pixels;
  simulated += other.simulated;
  return *this;
}

const DifferenceSums& IntensityError::Over(IntensityDomain domain) const {
  switch (domain) {
    case IntensityDomain::kWhole:
      return whole;
    case IntensityDomain::kOverlap:
      return overlap;
    case IntensityDomain::kUnion:
      break;
  }
  return union_region;
}

IntensityError& IntensityError::operator+=(const IntensityError& other) {
  union_region += other.union_region;
  whole += other.whole;
  overlap += other.overlap;
  objects += other.objects;
  return *this;
}

IntensityError MeasureIntensityError(const Grid<float>& real, const Grid<float>& simulated, double full_scale,
                                     const Mask& real_object, const Mask& simulated_object,
                                     const Mask* inside) {
  CheckShape(simulated, real, "simulated image");
  CheckShape(real_object, real, "real object region");
  CheckShape(simulated_object, real, "simulated object region");
  if (inside != nullptr) CheckShape(*inside, real, "inside");
  SONARCAL_CHECK(full_scale > 0.0, "full scale {}", full_scale);

  IntensityError error;
  for (std::size_t i = 0; i < real.size(); ++i) {
    if (inside != nullptr && inside->values()[i] == 0) continue;
    const double r = static_cast<double>(real.values()[i]) / full_scale;
    const double s = static_cast<double>(simulated.values()[i]) / full_scale;
    const bool in_real = real_object.values()[i] != 0;
    const bool in_simulated = simulated_object.values()[i] != 0;
    error.whole.Add(r, s);
    if (in_real || in_simulated) error.union_region.Add(r, s);
    if (in_real && in_simulated) error.overlap.Add(r, s);
    if (in_real) {
      ++error.objects.real_pixels;
      error.objects.real += r;
    }
    if (in_simulated) {
      ++error.objects.simulated_pixels;
      error.objects.simulated += s;
    }
  }
  return error;
}

}  // namespace sonarcal::metrics
