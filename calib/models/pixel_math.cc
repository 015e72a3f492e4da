#include "calib/models/pixel_math.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

#include "calib/models/power_likelihood.h"
#include "core/math/vector_versions.h"

namespace sonarcal::calib::pixel_math {
namespace {

constexpr int kLanes = 4;
using Lanes = double __attribute__((vector_size(kLanes * sizeof(double))));

__attribute__((always_inline)) inline Lanes Load(const double* from) {
  Lanes lanes;
  std::memcpy(&lanes, from, sizeof(lanes));
  return lanes;
}

__attribute__((always_inline)) inline void Store(const Lanes& lanes, double* to) {
  std::memcpy(to, &lanes, sizeof(lanes));
}

// Adds the entries of one pixel for one material, from `e` on. `first_node` is the first node of its curves.
// Returns the start of the next material.
__attribute__((always_inline)) inline const sim::PixelEchoes::Entry* AddMaterial(
    const sim::PixelEchoes::Entry* e, const sim::PixelEchoes::Entry* last, std::uint32_t next_material,
    std::uint32_t first_node, const double* curves, double* sums) {
  static_assert(sim::kCurveStride == 2 * kLanes);
  Lanes first = {};
  Lanes second = {};
  for (; e < last && e->node < next_material; ++e) {
    const double weight = e->weight;
    const double* at = curves + std::size_t{sim::kCurveStride} * (e->node - first_node);
    first += weight * Load(at);
    second += weight * Load(at + kLanes);
  }
  Store(first, sums);
  Store(second, sums + kLanes);
  return e;
}

}  // namespace

SONARCAL_VECTOR_VERSIONS
void SumCurves(const sim::PixelEchoes& echoes, std::span<const std::uint32_t> pixels,
               std::span<const double> curves, double* sums) {
  const auto nodes = static_cast<std::uint32_t>(sim::CoarseIncidenceDeg().size());
  const std::size_t stride = static_cast<std::size_t>(echoes.materials) * sim::kCurveStride;
  std::fill(sums, sums + stride * pixels.size(), 0.0);
  const sim::PixelEchoes::Entry* entries = echoes.entries.data();
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const sim::PixelEchoes::Entry* e = entries + echoes.start[pixels[i]];
    const sim::PixelEchoes::Entry* last = entries + echoes.start[pixels[i] + 1];
    for (std::uint32_t material = 0; e < last; ++material) {
      e = AddMaterial(e, last, (material + 1) * nodes, 0, curves.data(),
                      sums + i * stride + std::size_t{sim::kCurveStride} * material);
    }
  }
}

SONARCAL_VECTOR_VERSIONS
void AddGhosts(const sim::PixelEchoes& ghosts, std::span<const std::uint32_t> pixels,
               std::span<const double> parts, std::span<const double> passed, double* sums, double* by_way) {
  const auto nodes = static_cast<std::uint32_t>(sim::CoarseIncidenceDeg().size());
  const auto ways = static_cast<std::uint32_t>(passed.size());
  // number of parts per path
  const std::uint32_t of_a_way = static_cast<std::uint32_t>(ghosts.materials) / ways;
  const std::uint32_t materials = of_a_way / sim::kCurveParts;
  const std::size_t stride = std::size_t{materials} * sim::kCurveStride;
  const sim::PixelEchoes::Entry* entries = ghosts.entries.data();
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const sim::PixelEchoes::Entry* e = entries + ghosts.start[pixels[i]];
    const sim::PixelEchoes::Entry* last = entries + ghosts.start[pixels[i] + 1];
    while (e < last) {
      const std::uint32_t run = e->node / nodes;
      const std::uint32_t way = run / of_a_way;
      const std::uint32_t part = run % of_a_way;
      double of[sim::kCurveStride];
      e = AddMaterial(e, last, (run + 1) * nodes, way * of_a_way * nodes, parts.data(), of);
      double* to = sums + i * stride + std::size_t{sim::kCurveStride} * (part / sim::kCurveParts);
      for (int k = 0; k < sim::kCurveStride; ++k) to[k] += passed[way] * of[k];
      by_way[i * ways + way] += passed[way] * of[0];
    }
  }
}

SONARCAL_VECTOR_VERSIONS
void Likelihood(const double* __restrict power, const double* __restrict mean, int count, double looks,
                double* __restrict residual, double* __restrict slope) {
  // Near x = 1 the root loses its digits: x - 1 - ln x = e^2 / 2 - e^3 / 3 + ..., e = x - 1.
  constexpr double kNear = 1e-4;
  const double root_looks = std::sqrt(looks);
  for (int i = 0; i < count; ++i) {
    const double x = std::min(std::max(power[i] / mean[i], kMinPowerRatio), kMaxPowerRatio);
    const double e = x - 1.0;
    const double size = std::abs(e);
    const bool near = size < kNear;
    const double by_series = size * std::sqrt(1.0 - 2.0 / 3.0 * (near ? e : 0.0));
    const double by_logarithm = std::sqrt(std::max(2.0 * (e - std::log(x)), 1e-300));
    const double root = near ? by_series : by_logarithm;
    residual[i] = root_looks * (e < 0.0 ? root : -root);
    slope[i] = root_looks * (near ? 1.0 + e / 3.0 : size / by_logarithm);
  }
}

SONARCAL_VECTOR_VERSIONS
void SingleLookInformation(double lowest, double highest, const double* __restrict mean, int count,
                           double* __restrict information) {
  // Sum of the integrals of ExpectedInformation: with a and b the ends of the display divided by the mean, (1
  // + a^2) exp(-a) + a^2 exp(-2 a) / (1 - exp(-a)) - exp(-b).
  // exp(-kFarthest) is nearly 0, and its product with kFarthest^2 is not NaN
  constexpr double kFarthest = 700.0;
  for (int i = 0; i < count; ++i) {
    const double a = std::min(lowest / mean[i], kFarthest);
    const double b = std::min(highest / mean[i], kFarthest);
    const double beyond_a = std::exp(-a);
    const double beyond_b = std::exp(-b);
    // 1 - exp(-a) is at least a - a^2 / 2, which keeps its digits near 0. The min value avoids 0 / 0.
    const double below = std::max(std::max(1.0 - beyond_a, a - 0.5 * a * a), 1e-300);
    const double of_bottom = a * beyond_a;
    information[i] = std::max((1.0 + a * a) * beyond_a + of_bottom * of_bottom / below - beyond_b, 0.0);
  }
}

SONARCAL_VECTOR_VERSIONS
void AddOuterProducts(const double* __restrict rows, const double* __restrict weight,
                      const double* __restrict along, int count, int n, double* __restrict sum,
                      double* __restrict projection) {
  constexpr int kAtOnce = 8;
  const int width = (n + kLanes - 1) / kLanes * kLanes;
  // Pads to whole vectors. Values beyond n are never read.
  static thread_local std::vector<double> scratch;
  scratch.assign(static_cast<std::size_t>(width) * (n + 1), 0.0);
  double* square = scratch.data();
  double* line = square + static_cast<std::size_t>(width) * n;
  int i = 0;
  for (; i + kAtOnce <= count; i += kAtOnce) {
    const double* row = rows + static_cast<std::size_t>(i) * n;
    for (int k = 0; k < n; k += kLanes) {
      Lanes weighted[kAtOnce];
      Lanes along_rows = Load(line + k);
      for (int p = 0; p < kAtOnce; ++p) {
        const Lanes lanes = Load(row + p * n + k);
        along_rows += along[i + p] * lanes;
        weighted[p] = weight[i + p] * lanes;
      }
      Store(along_rows, line + k);
      for (int j = k; j < n; ++j) {
        double* to = square + static_cast<std::size_t>(j) * width + k;
        Lanes sum_of = Load(to);
        for (int p = 0; p < kAtOnce; ++p) sum_of += row[p * n + j] * weighted[p];
        Store(sum_of, to);
      }
    }
  }
  for (; i < count; ++i) {
    const double* __restrict r = rows + static_cast<std::size_t>(i) * n;
    for (int j = 0; j < n; ++j) {
      const double w = weight[i] * r[j];
      for (int k = 0; k <= j; ++k) square[static_cast<std::size_t>(j) * width + k] += w * r[k];
    }
    for (int k = 0; k < n; ++k) line[k] += along[i] * r[k];
  }
  for (int j = 0; j < n; ++j) {
    for (int k = 0; k <= j; ++k) sum[j * n + k] += square[static_cast<std::size_t>(j) * width + k];
    projection[j] += line[j];
  }
}

}  // namespace sonarcal::calib::pixel_math
