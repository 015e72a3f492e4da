#include "sim/physics/k_diffuse_law.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <unsupported/Eigen/SpecialFunctions>
#include <vector>

#include "core/types/error.h"
#include "sim/physics/k_law.h"

namespace sonarcal::sim {
namespace {

// Ends of the sum in s = ln tau, by the exponent of the density of s. Towards strong texture it goes on to
// where the survival is least: at 1e-304, half of its exponent is that of the density.
constexpr double kLeastExponent = -45.0;
constexpr double kLeastExponentOfTail = -400.0;
constexpr double kDiffuseAlone = -23.0;  // ln of the power with texture over the diffuse power: 1e-10
constexpr double kStep = 0.35;
constexpr double kCloser = 0.75;
constexpr double kSmallRatio = 1e-3;  // below, 1 - exp(-t / m) needs expm1

struct Node {
  double mean = 0.0;
  double weight = 0.0;
  double weight_by_log_looks = 0.0;
  double weight_by_logit_share = 0.0;
  double mean_by_logit_share = 0.0;
};

// s as a function of the u in which the nodes are equally spaced. They lie closer above s = 0: at a survival
// of exp(-e) the integrand over s is as narrow as 1 / sqrt(e).
double LogTexture(double u) {
  return u - kCloser * (std::log1p(std::exp(u)) - std::numbers::ln2);
}

double LogTextureByU(double u) {
  return 1.0 - kCloser / (1.0 + std::exp(-u));
}

// Texture of shape nu as nodes in s = ln tau. The density of s is exp(log_constant + Exponent(s)).
class Texture {
 public:
  explicit Texture(double shape)
      : shape_(shape),
        log_constant_(shape * (std::log(shape) - 1.0) - Eigen::numext::lgamma(shape)),
        constant_by_shape_(std::log(shape) - Eigen::numext::digamma(shape)) {}

  double Step() const { return std::min(kStep, 0.6 / std::sqrt(shape_)); }
  double Exponent(double s) const { return shape_ * (s - std::expm1(s)); }
  double Density(double s) const { return std::exp(log_constant_ + Exponent(s)); }
  double LogDensityByShape(double s) const { return constant_by_shape_ + s - std::expm1(s); }

 private:
  double shape_;
  double log_constant_;
  double constant_by_shape_;
};

std::vector<Node> NodesOf(double looks, double share) {
  const double rest = 1.0 - share;
  const double shape = 2.0 * rest * rest * looks / (1.0 - looks);
  const bool is_mixture = shape > kLargestTextureShape;
  const double textured = is_mixture ? kLargestTextureShape / shape : 1.0;
  const double drawn_shape = std::min(shape, kLargestTextureShape);
  // Below the largest shape the shape varies, above it the share of texture.
  const double shape_by_log_looks = is_mixture ? 0.0 : shape / (1.0 - looks);
  const double shape_by_logit_share = is_mixture ? 0.0 : -2.0 * shape * share;
  const double textured_by_log_looks = is_mixture ? -textured / (1.0 - looks) : 0.0;
  const double textured_by_logit_share = is_mixture ? 2.0 * share * textured : 0.0;

  const Texture texture(drawn_shape);
  const double step = texture.Step();
  std::vector<Node> nodes;
  Node alone{.mean = share,
             .weight = textured,
             .weight_by_log_looks = textured_by_log_looks,
             .weight_by_logit_share = textured_by_logit_share,
             .mean_by_logit_share = share * rest};
  const auto add = [&](double u) {
    const double s = LogTexture(u);
    const double weight = step * LogTextureByU(u) * texture.Density(s);
    const double by_shape = textured * weight * texture.LogDensityByShape(s);
    const Node node{
        .mean = rest * std::exp(s) + share,
        .weight = textured * weight,
        .weight_by_log_looks = by_shape * shape_by_log_looks + textured_by_log_looks * weight,
        .weight_by_logit_share = by_shape * shape_by_logit_share + textured_by_logit_share * weight,
        .mean_by_logit_share = -std::expm1(s) * share * rest};
    alone.weight -= node.weight;
    alone.weight_by_log_looks -= node.weight_by_log_looks;
    alone.weight_by_logit_share -= node.weight_by_logit_share;
    nodes.push_back(node);
  };
  for (double u = 0.0; texture.Exponent(LogTexture(u)) > kLeastExponentOfTail; u += step) add(u);
  const double s_alone = std::log(share / rest) + kDiffuseAlone;
  for (double u = -step; texture.Exponent(LogTexture(u)) > kLeastExponent && LogTexture(u) > s_alone;
       u -= step)
    add(u);
  // Weaker texture adds nothing to the diffuse power. So the rest of the weight has the diffuse mean.
  alone.weight = std::max(0.0, alone.weight);
  if (share > 0.0) nodes.push_back(alone);
  if (is_mixture) {
    nodes.push_back({.mean = 1.0,
                     .weight = 1.0 - textured,
                     .weight_by_log_looks = -textured_by_log_looks,
                     .weight_by_logit_share = -textured_by_logit_share});
  }
  return nodes;
}

}  // namespace

KDiffuseLaw::KDiffuseLaw(double looks, double diffuse_share) {
  SONARCAL_CHECK(looks > 0.0 && looks < 1.0, "{} looks", looks);
  SONARCAL_CHECK(diffuse_share >= 0.0 && diffuse_share < 1.0, "a diffuse share of {}", diffuse_share);
  const std::vector<Node> nodes = NodesOf(looks, diffuse_share);
  const auto count = static_cast<Eigen::Index>(nodes.size());
  inverse_mean_.resize(count);
  coefficients_.resize(kRows, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Node& node = nodes[static_cast<std::size_t>(i)];
    inverse_mean_[i] = 1.0 / node.mean;
    coefficients_(kWeight, i) = node.weight;
    coefficients_(kDensity, i) = node.weight / node.mean;
    coefficients_(kByLogLooks, i) = node.weight_by_log_looks;
    coefficients_(kByLogitShare, i) = node.weight_by_logit_share;
    coefficients_(kByMean, i) = node.weight / node.mean * (node.mean_by_logit_share / node.mean);
  }
}

KDiffuseLaw::Value KDiffuseLaw::At(double ratio) const {
  if (!(ratio > 0.0)) return {};
  if (std::isinf(ratio)) return {.cdf = 1.0, .survival = 0.0};
  const Eigen::ArrayXd beyond = (-ratio * inverse_mean_).exp();
  const Eigen::Vector<double, kRows> sum = coefficients_ * beyond.matrix();
  Value value{.cdf = 1.0 - sum[kWeight],
              .survival = std::clamp(sum[kWeight], 0.0, 1.0),
              .density = sum[kDensity],
              .cdf_by_log_looks = -sum[kByLogLooks],
              .cdf_by_logit_share = -sum[kByLogitShare] - ratio * sum[kByMean]};
  if (ratio < kSmallRatio) {
    value.cdf = 0.0;
    value.cdf_by_log_looks = 0.0;
    value.cdf_by_logit_share = -ratio * sum[kByMean];
    for (Eigen::Index i = 0; i < inverse_mean_.size(); ++i) {
      const double below = -std::expm1(-ratio * inverse_mean_[i]);
      value.cdf += coefficients_(kWeight, i) * below;
      value.cdf_by_log_looks += coefficients_(kByLogLooks, i) * below;
      value.cdf_by_logit_share += coefficients_(kByLogitShare, i) * below;
    }
  }
  value.cdf = std::clamp(value.cdf, 0.0, 1.0);
  return value;
}

}  // namespace sonarcal::sim
