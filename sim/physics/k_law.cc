#include "sim/physics/k_law.h"

#include <cmath>
#include <unsupported/Eigen/SpecialFunctions>

#include <boost/math/special_functions/bessel.hpp>

namespace sonarcal::sim {
namespace {

// ln(2 (argument / 2)^power K_order(argument) / Gamma(shape)); not finite where the Bessel function
// overflows.
double LogTerm(double shape, double power, double order, double argument) {
  namespace policies = boost::math::policies;
  using Fast =
      policies::policy<policies::overflow_error<policies::ignore_error>, policies::promote_double<false>>;
  return std::log(2.0 * boost::math::cyl_bessel_k(order, argument, Fast())) +
         power * std::log(0.5 * argument) - Eigen::numext::lgamma(shape);
}

double Argument(double shape, double ratio) {
  return 2.0 * std::sqrt(shape * ratio);
}

constexpr double kLargestArgument = 700.0;  // beyond, exp(-argument) is 0

// Large shapes overflow at small ratios. There the first terms of the series hold.
double SurvivalOfShape(double shape, double ratio) {
  const double argument = Argument(shape, ratio);
  if (argument > kLargestArgument) return 0.0;
  const double log_survival = LogTerm(shape, shape, shape, argument);
  return std::isfinite(log_survival) ? std::exp(log_survival) : 1.0 - ratio * shape / (shape - 1.0);
}

double DensityOfShape(double shape, double ratio) {
  const double argument = Argument(shape, ratio);
  if (argument > kLargestArgument) return 0.0;
  const double log_density = LogTerm(shape, shape - 1.0, std::abs(shape - 1.0), argument);
  return std::isfinite(log_density) ? shape * std::exp(log_density) : shape / (shape - 1.0);
}

template <typename OfShape>
double OfLooks(double looks, double ratio, const OfShape& of_shape) {
  const double shape = 2.0 * looks / (1.0 - looks);
  if (shape <= kLargestTextureShape) return of_shape(shape, ratio);
  return std::lerp(std::exp(-ratio), of_shape(kLargestTextureShape, ratio), kLargestTextureShape / shape);
}

}  // namespace

double KLawSurvival(double looks, double ratio) {
  return OfLooks(looks, ratio, SurvivalOfShape);
}

double KLawDensity(double looks, double ratio) {
  return OfLooks(looks, ratio, DensityOfShape);
}

}  // namespace sonarcal::sim
