// Power of one look of reverberation with texture, relative to its mean: the K law (Jakeman and Pusey 1976).
// Given its local mean, the power is exponential; the local mean is Gamma distributed, with shape nu.
//
//   P(x > t) = 2 (nu t)^(nu / 2) K_nu(2 sqrt(nu t)) / Gamma(nu)
//
// nu = 2 looks / (1 - looks), 0.05 <= looks < 1: the variance is that of `looks` looks. Above shape 50 it is
// the mixture of that shape and of no texture which has the right variance; so it goes over to the
// exponential law at one look.
#pragma once

namespace sonarcal::sim {

// P(x > ratio), ratio > 0.
double KLawSurvival(double looks, double ratio);

// Density of x at ratio > 0.
double KLawDensity(double looks, double ratio);

}  // namespace sonarcal::sim
