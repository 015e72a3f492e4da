// Distances between two distributions over the same ordered levels 0 .. n - 1, such as grey values. `p` and
// `q` hold the share of each level: non-negative, sum 1, same length. F and G are their cumulative sums. All
// distances are 0 for equal distributions and symmetric.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>

namespace sonarcal {

// 1/2 sum |p - q|: half the L1 distance of the histograms, 0 .. 1. Does not depend on how far apart levels
// are.
inline double HistogramL1Half(std::span<const double> p, std::span<const double> q) {
  double sum = 0.0;
  for (std::size_t i = 0; i < p.size(); ++i) sum += std::abs(p[i] - q[i]);
  return 0.5 * sum;
}

// Wasserstein-1 distance in levels: sum |F - G|, the mean number of levels by which pixels must move; 0 .. n
// - 1. (Vallender, Theory Probab. Appl. 18(4), 1974: on a line it is the area between the distribution
// functions.)
inline double WassersteinLevels(std::span<const double> p, std::span<const double> q) {
  double difference = 0.0;
  double area = 0.0;
  for (std::size_t i = 0; i + 1 < p.size(); ++i) {
    difference += p[i] - q[i];
    area += std::abs(difference);
  }
  return area;
}

// Kolmogorov-Smirnov: max |F - G|, 0 .. 1.
inline double KolmogorovSmirnov(std::span<const double> p, std::span<const double> q) {
  double difference = 0.0;
  double largest = 0.0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    difference += p[i] - q[i];
    largest = std::max(largest, std::abs(difference));
  }
  return largest;
}

// Hellinger: sqrt(1 - sum sqrt(p q)), 0 .. 1.
inline double Hellinger(std::span<const double> p, std::span<const double> q) {
  double affinity = 0.0;
  for (std::size_t i = 0; i < p.size(); ++i) affinity += std::sqrt(p[i] * q[i]);
  return std::sqrt(std::max(0.0, 1.0 - affinity));
}

// Upper-tail Anderson-Darling: the integral of (F - G)^2 / (1 - H) dH with H = (F + G) / 2; 0 .. 1.5. The sum
// takes the integrand at the end of each step. Disjoint distributions of fine levels have 4 ln 2 - 2 = 0.77;
// one level below many fine ones has nearly 1.5. It is the statistic AU^2 of Sinclair, Spurr & Ahmad (Commun.
// Stat. Theory Methods 19(10), 1990) between two samples, pooled as in Pettitt (Biometrika 63(1), 1976),
// without the factor that grows with the number of pixels. The weight 1 / (1 - H) emphasises the highest
// levels: the bright echoes.
inline double UpperTailAndersonDarling(std::span<const double> p, std::span<const double> q) {
  constexpr double kNothingAbove = 1e-12;  // tolerance for rounding of sums of shares
  double f = 0.0;
  double g = 0.0;
  double integral = 0.0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    f += p[i];
    g += q[i];
    const double above = 1.0 - 0.5 * (f + g);
    if (above <= kNothingAbove) break;  // F = G = 1 from here on
    integral += (f - g) * (f - g) / above * 0.5 * (p[i] + q[i]);
  }
  return integral;
}

}  // namespace sonarcal
