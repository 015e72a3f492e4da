// Power of one look of reverberation with texture, relative to its mean: the K law (Jakeman and Pusey 1976).
// Given its local mean, the power is exponential; the local mean is Gamma distributed, with shape nu.
//
//   P(x > t) = 2 (nu t)^(nu / 2) K_nu(2 sqrt(nu t)) / Gamma(nu)
//
// The variance is that of `looks` looks if nu = 2 looks / (1 - looks). Above shape 50 the law is a mixture of
// shape 50 and of no texture with this variance. So there is no step where looks = 1 and the law is
// exponential.
#pragma once

namespace sonarcal::sim {

inline constexpr double kLeastTexturedLooks = 0.05;  // shape 0.1
inline constexpr double kLargestTextureShape = 50.0;

// Both functions: kLeastTexturedLooks <= looks < 1, ratio > 0.

// P(x > ratio).
double KLawSurvival(double looks, double ratio);

// Density of x at `ratio`.
double KLawDensity(double looks, double ratio);

}  // namespace sonarcal::sim
