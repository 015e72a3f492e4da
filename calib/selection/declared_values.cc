#include "calib/selection/declared_values.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

namespace sonarcal::calib {
namespace {

// Chi-square of some values less its mean, in its standard deviations.
double Excess(const Eigen::VectorXd& moved, const Eigen::MatrixXd& covariance) {
  const auto count = static_cast<double>(moved.size());
  return (moved.dot(covariance.ldlt().solve(moved)) - count) / std::sqrt(2.0 * count);
}

std::vector<Eigen::Index> IndicesOf(const std::vector<std::string>& origins, const std::string& origin,
                                    bool equal) {
  std::vector<Eigen::Index> indices;
  for (std::size_t i = 0; i < origins.size(); ++i) {
    if ((origins[i] == origin) == equal) indices.push_back(static_cast<Eigen::Index>(i));
  }
  return indices;
}

// Sets the values of an origin to what is declared. Returns the others, as they are on this condition.
DeclaredValues Without(const DeclaredValues& values, const std::string& origin) {
  const std::vector<Eigen::Index> held = IndicesOf(values.origins, origin, true);
  const std::vector<Eigen::Index> rest = IndicesOf(values.origins, origin, false);
  const Eigen::MatrixXd shared = values.covariance(rest, held);
  const auto held_covariance = Eigen::MatrixXd(values.covariance(held, held)).ldlt();
  DeclaredValues others;
  for (const Eigen::Index i : rest) others.origins.push_back(values.origins[i]);
  others.moved = values.moved(rest) - shared * held_covariance.solve(Eigen::VectorXd(values.moved(held)));
  others.covariance = values.covariance(rest, rest) - shared * held_covariance.solve(shared.transpose());
  return others;
}

std::vector<std::string> Distinct(const std::vector<std::string>& origins) {
  std::vector<std::string> distinct;
  for (const std::string& origin : origins) {
    if (std::ranges::find(distinct, origin) == distinct.end()) distinct.push_back(origin);
  }
  return distinct;
}

}  // namespace

std::vector<std::string> ContradictedOrigins(DeclaredValues values) {
  constexpr double kDeviations = 2.0;
  while (true) {
    std::vector<std::string> origins = Distinct(values.origins);
    double least = std::numeric_limits<double>::infinity();
    std::string trusted;
    for (const std::string& origin : origins) {
      const std::vector<Eigen::Index> of = IndicesOf(values.origins, origin, true);
      const double excess = Excess(values.moved(of), values.covariance(of, of));
      if (excess >= least) continue;
      least = excess;
      trusted = origin;
    }
    if (origins.empty() || least > kDeviations) return origins;
    if (origins.size() == 1) return {};  // it is trusted, and no other is left
    values = Without(values, trusted);
  }
}

std::string OriginOf(const std::string& parameter) {
  if (parameter.starts_with("pose.")) return "poses";
  if (parameter.starts_with("geometry.")) return "geometry of the sonar";
  constexpr std::string_view kObject = "object.";
  if (!parameter.starts_with(kObject)) return {};
  return "object " + parameter.substr(kObject.size(), parameter.rfind('.') - kObject.size());
}

DeclaredValues DeclaredPlacement(const FitReport& report) {
  DeclaredValues values;
  std::vector<Eigen::Index> of_correlation;
  std::vector<double> moved;
  std::vector<double> sigma;
  for (std::size_t i = 0; i < report.correlation_names.size(); ++i) {
    const FittedParameter* parameter = report.Find(report.correlation_names[i]);
    if (parameter == nullptr || !parameter->sigma || !std::isfinite(*parameter->sigma)) continue;
    std::string origin = OriginOf(parameter->name);
    if (origin.empty()) continue;
    values.origins.push_back(std::move(origin));
    of_correlation.push_back(static_cast<Eigen::Index>(i));
    moved.push_back(Moved(*parameter));
    sigma.push_back(*parameter->sigma);
  }
  const auto count = static_cast<Eigen::Index>(moved.size());
  values.moved = Eigen::Map<const Eigen::VectorXd>(moved.data(), count);
  const Eigen::Map<const Eigen::VectorXd> scale(sigma.data(), count);
  values.covariance =
      scale.asDiagonal() * report.correlation(of_correlation, of_correlation) * scale.asDiagonal();
  return values;
}

double Moved(const FittedParameter& parameter) {
  const double moved = parameter.value - parameter.initial;
  return parameter.name.ends_with("_deg") ? std::remainder(moved, 360.0) : moved;
}

}  // namespace sonarcal::calib
