#include "metrics/measures/level_histograms.h"

#include <algorithm>
#include <cmath>

#include "core/math/distribution.h"

namespace sonarcal::metrics {
namespace {

constexpr double kMaxLevels = 4096.0;

std::vector<double> Shares(const std::vector<double>& counts) {
  double sum = 0.0;
  for (const double count : counts) sum += count;
  if (sum == 0.0) return {};
  std::vector<double> shares = counts;
  for (double& share : shares) share /= sum;
  return shares;
}

void AddCounts(std::vector<double>& counts, const std::vector<double>& other) {
  if (other.empty()) return;
  if (counts.empty()) counts.assign(other.size(), 0.0);
  if (counts.size() != other.size()) {
    throw DataError("frames have {} and {} grey levels, expected as many in all", counts.size(),
                    other.size());
  }
  for (std::size_t i = 0; i < counts.size(); ++i) counts[i] += other[i];
}

}  // namespace

LevelDistances LevelCounts::Distances(std::optional<double> span_db) const {
  const std::vector<double> p = Shares(real);
  const std::vector<double> q = Shares(simulated);
  if (p.empty() || q.empty()) return {};
  const double steps = std::max(1.0, static_cast<double>(p.size()) - 1.0);
  const double wasserstein = WassersteinLevels(p, q) / steps;
  return {.l1_half = HistogramL1Half(p, q),
          .wasserstein = wasserstein,
          .emd_db = span_db ? std::optional(wasserstein * *span_db) : std::nullopt,
          .hellinger = Hellinger(p, q),
          .kolmogorov_smirnov = KolmogorovSmirnov(p, q),
          .upper_anderson_darling = UpperTailAndersonDarling(p, q)};
}

LevelCounts& LevelCounts::operator+=(const LevelCounts& other) {
  AddCounts(real, other.real);
  AddCounts(simulated, other.simulated);
  return *this;
}

std::array<LevelDistances, kLevelDomains.size()> LevelHistograms::Distances() const {
  std::array<LevelDistances, kLevelDomains.size()> distances;
  for (std::size_t i = 0; i < over.size(); ++i) distances[i] = over[i].Distances(span_db);
  return distances;
}

LevelHistograms& LevelHistograms::operator+=(const LevelHistograms& other) {
  const bool is_first = Over(LevelDomain::kWhole).real.empty();
  if (is_first) span_db = other.span_db;
  if (span_db != other.span_db) span_db.reset();
  for (std::size_t i = 0; i < over.size(); ++i) over[i] += other.over[i];
  return *this;
}

LevelHistograms CountLevels(const Grid<float>& real, const Grid<float>& simulated, double full_scale,
                            const Mask& real_object, const Mask& simulated_object, double echo_level,
                            const Mask* inside) {
  SONARCAL_CHECK(full_scale > 0.0, "full scale {}", full_scale);
  const auto steps = std::max(1.0, std::min(std::round(full_scale), kMaxLevels - 1.0));
  const auto level_of = [&](float value) {
    const double level = std::round(static_cast<double>(value) / full_scale * steps);
    return static_cast<std::size_t>(std::clamp(level, 0.0, steps));
  };
  LevelHistograms levels;
  for (LevelCounts& counts : levels.over) {
    counts.real.assign(static_cast<std::size_t>(steps) + 1, 0.0);
    counts.simulated = counts.real;
  }
  const auto add_both = [&](LevelDomain domain, std::size_t r, std::size_t s) {
    ++levels.Over(domain).real[r];
    ++levels.Over(domain).simulated[s];
  };
  for (std::size_t i = 0; i < real.size(); ++i) {
    if (inside != nullptr && inside->values()[i] == 0) continue;
    const std::size_t r = level_of(real.values()[i]);
    const std::size_t s = level_of(simulated.values()[i]);
    const bool in_real = real_object.values()[i] != 0;
    const bool in_simulated = simulated_object.values()[i] != 0;
    add_both(LevelDomain::kWhole, r, s);
    if (in_real || in_simulated) add_both(LevelDomain::kUnion, r, s);
    if (in_real && in_simulated) add_both(LevelDomain::kOverlap, r, s);
    if (in_real) ++levels.Over(LevelDomain::kObjects).real[r];
    if (in_simulated) ++levels.Over(LevelDomain::kObjects).simulated[s];
    if (real.values()[i] > echo_level) ++levels.Over(LevelDomain::kEchoes).real[r];
    if (simulated.values()[i] > echo_level) ++levels.Over(LevelDomain::kEchoes).simulated[s];
  }
  return levels;
}

}  // namespace sonarcal::metrics
