// Power of one look of reverberation with texture and of a diffuse component without, relative to its mean
// (Watts, IEEE Trans. Aerosp. Electron. Syst. 23(1), 1987, where the diffuse component is receiver noise).
// Given the texture tau, which is Gamma distributed with mean 1 and shape nu, the power is exponential:
//
//   m(tau) = (1 - rho) tau + rho                    mean of the power; rho: share of it that is diffuse
//   P(x > t) = E[exp(-t / m(tau))]
//   E[x] = 1, Var[x] = 1 / looks = 1 + 2 (1 - rho)^2 / nu, nu = 2 (1 - rho)^2 looks / (1 - looks)
//
// rho = 0 is the K law of k_law.h. Above shape 50 the law is a mixture as there, of shape 50 and of no
// texture.
//
// The expectation is a sum over about 100 values of m: the trapezoidal rule over a function of ln tau, which
// converges exponentially. The relative error is below 1e-6 in the lower tail and in the upper one down to
// 1e-70, and grows to 4 % at 1e-260.
#pragma once

#include <Eigen/Core>

namespace sonarcal::sim {

class KDiffuseLaw {
 public:
  // 0 < looks < 1, 0 <= diffuse_share < 1.
  KDiffuseLaw(double looks, double diffuse_share);

  struct Value {
    double cdf = 0.0;       // P(x <= ratio)
    double survival = 1.0;  // P(x > ratio)
    double density = 0.0;
    double cdf_by_log_looks = 0.0;  // derivatives of the cdf
    double cdf_by_logit_share = 0.0;
  };
  // The density is 0 for ratio <= 0.
  Value At(double ratio) const;

 private:
  enum Row { kWeight, kDensity, kByLogLooks, kByLogitShare, kByMean, kRows };

  Eigen::ArrayXd inverse_mean_;
  Eigen::Matrix<double, kRows, Eigen::Dynamic> coefficients_;  // of exp(-ratio * inverse_mean_)
};

}  // namespace sonarcal::sim
