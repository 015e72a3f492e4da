#include "calib/models/down_weight.h"

#include <algorithm>
#include <cmath>

#include "core/types/error.h"
#include "core/types/units.h"

namespace sonarcal::calib {
namespace {

// Sums over rectangles of a grid of bins x beams, each in constant time.
class RectangleSums {
 public:
  RectangleSums(int bins, int beams)
      : stride_(beams + 1), sums_(static_cast<std::size_t>(bins + 1) * stride_, 0.0) {}

  // Must be called in order of bins, then beams.
  void Set(int bin, int beam, double value) {
    at(bin + 1, beam + 1) = value + at(bin, beam + 1) + at(bin + 1, beam) - at(bin, beam);
  }
  double Sum(int first_bin, int last_bin, int first_beam, int last_beam) const {
    return at(last_bin, last_beam) - at(first_bin, last_beam) - at(last_bin, first_beam) +
           at(first_bin, first_beam);
  }

 private:
  double& at(int bin, int beam) { return sums_[static_cast<std::size_t>(bin) * stride_ + beam]; }
  double at(int bin, int beam) const { return sums_[static_cast<std::size_t>(bin) * stride_ + beam]; }

  int stride_;
  std::vector<double> sums_;
};

}  // namespace

void DownWeightOptions::Check() const {
  const auto at_least = [](const char* name, double value, double limit) {
    if (!(value >= limit)) throw DataError("down-weighting: {} {}, expected at least {}", name, value, limit);
  };
  at_least("tolerance_db", tolerance_db, 0.0);
  at_least("sigmas", sigmas, 1.0);
  at_least("cell_bins", cell_bins, 1.0);
  at_least("cell_beams", cell_beams, 1.0);
}

std::vector<float> CellWeights(std::span<const RecordedPower> recorded, std::span<const double> mean,
                               std::span<const std::uint8_t> use, int bins, int beams, double looks,
                               const DownWeightOptions& options) {
  options.Check();
  const std::size_t pixels = static_cast<std::size_t>(bins) * beams;
  SONARCAL_CHECK(recorded.size() == pixels && mean.size() == pixels, "{} and {} pixels, expected {}",
                 recorded.size(), mean.size(), pixels);
  // Limits the ratio, so that one very bright pixel does not dominate its window.
  constexpr double kMaxRatio = 1e3;
  RectangleSums ratios(bins, beams);
  RectangleSums counts(bins, beams);
  for (int bin = 0; bin < bins; ++bin) {
    for (int beam = 0; beam < beams; ++beam) {
      const std::size_t pixel = static_cast<std::size_t>(bin) * beams + beam;
      const bool counted = use.empty() || use[pixel] != 0;
      ratios.Set(bin, beam, counted ? std::min(recorded[pixel].power / mean[pixel], kMaxRatio) : 0.0);
      counts.Set(bin, beam, counted ? 1.0 : 0.0);
    }
  }
  const int reach_bins = static_cast<int>(std::ceil(options.cell_bins));
  const int reach_beams = static_cast<int>(std::ceil(options.cell_beams));
  const double cell_pixels = options.cell_bins * options.cell_beams;
  std::vector<float> weights(pixels, 1.0F);
  for (int bin = 0; bin < bins; ++bin) {
    for (int beam = 0; beam < beams; ++beam) {
      const int first_bin = std::max(bin - reach_bins, 0);
      const int last_bin = std::min(bin + reach_bins + 1, bins);
      const int first_beam = std::max(beam - reach_beams, 0);
      const int last_beam = std::min(beam + reach_beams + 1, beams);
      const double count = counts.Sum(first_bin, last_bin, first_beam, last_beam);
      if (count < 0.5) continue;
      const double ratio = ratios.Sum(first_bin, last_bin, first_beam, last_beam) / count;
      const double off_db = std::abs(kDbPerNeper * std::log(std::max(ratio, 1e-12)));
      const double independent = std::max(1.0, count / cell_pixels);
      const double z = (off_db - options.tolerance_db) / (kDbPerNeper / std::sqrt(independent * looks));
      if (z <= options.sigmas) continue;
      const double share = options.sigmas / z;
      weights[static_cast<std::size_t>(bin) * beams + beam] = static_cast<float>(share * share);
    }
  }
  return weights;
}

}  // namespace sonarcal::calib
