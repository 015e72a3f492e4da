#include "metrics/intensity.h"

#include <cmath>

namespace sonarcal {
namespace {

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

std::string_view ToString(IntensityDomain domain) {
  switch (domain) {
    case IntensityDomain::kUnion:
      return "union";
    case IntensityDomain::kWhole:
      return "whole";
    case IntensityDomain::kOverlap:
      return "overlap";
  }
  return "unknown domain";
}

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

void DifferenceSums::Add(double difference) {
  ++pixels;
  absolute += std::abs(difference);
  square += difference * difference;
  signed_sum += difference;
}

DifferenceSums& DifferenceSums::operator+=(const DifferenceSums& other) {
  pixels += other.pixels;
  absolute += other.absolute;
  square += other.square;
  signed_sum += other.signed_sum;
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
    const double difference =
        (static_cast<double>(simulated.values()[i]) - static_cast<double>(real.values()[i])) / full_scale;
    const bool in_real = real_object.values()[i] != 0;
    const bool in_simulated = simulated_object.values()[i] != 0;
    error.whole.Add(difference);
    if (in_real || in_simulated) error.union_region.Add(difference);
    if (in_real && in_simulated) error.overlap.Add(difference);
  }
  return error;
}

}  // namespace sonarcal
