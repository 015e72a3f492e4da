#include "calib/noise/background_display.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

#include "core/types/error.h"
#include "sim/physics/speckle.h"

namespace sonarcal::calib {
namespace {

// Search interval about the noise level, dB.
constexpr double kReachDb = 25.0;
constexpr double kMinSpanDb = 8.0;  // of displays whose span is not stated
constexpr double kMaxDisplaySpanDb = 160.0;
constexpr double kMinExponent = 0.1;
constexpr double kMaxExponent = 4.0;

struct GreyCell {
  double upper = 0.0;  // end of the cell, full scale 1
  double share = 0.0;  // share of the pixels
};

// Returns the levels that occur anywhere in the image, each with its share of the background.
std::vector<GreyCell> CountGrey(const PolarImage& image, const Mask& background) {
  std::map<float, double> count;
  double pixels = 0.0;
  for (std::size_t i = 0; i < image.value.size(); ++i) {
    const bool counts = background.values()[i] != 0;
    count[image.value.values()[i]] += counts ? 1.0 : 0.0;
    pixels += counts ? 1.0 : 0.0;
  }
  if (!(pixels > 0.0)) throw DataError("display: no background pixel to learn from");
  std::vector<GreyCell> cells;
  for (auto level = count.begin(); level != count.end(); ++level) {
    const auto next = std::next(level);
    const double end = next == count.end() ? image.scale.full_scale
                                           : 0.5 * (static_cast<double>(level->first) + next->first);
    cells.push_back({end / image.scale.full_scale, level->second / pixels});
  }
  return cells;
}

double NatsPerPixel(const std::vector<GreyCell>& cells, const BackgroundDisplay& law) {
  constexpr double kLeast = 1e-12;
  double nats = 0.0;
  double below = 0.0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const bool last = i + 1 == cells.size();
    const double up_to = last ? 1.0 : sim::DisplayedCdf(law.display, law.looks, 1.0, cells[i].upper);
    nats -= cells[i].share * std::log(std::max(up_to - below, kLeast));
    below = up_to;
  }
  return nats;
}

double GreyKolmogorovSmirnov(const std::vector<GreyCell>& cells, const BackgroundDisplay& law) {
  double recorded = 0.0;
  double largest = 0.0;
  for (std::size_t i = 0; i + 1 < cells.size(); ++i) {
    recorded += cells[i].share;
    largest = std::max(largest,
                       std::abs(recorded - sim::DisplayedCdf(law.display, law.looks, 1.0, cells[i].upper)));
  }
  return largest;
}

// Finds the minimum of a function between two ends by a grid, then golden sections.
std::pair<double, double> Lowest(const std::function<double(double)>& cost, double low, double high) {
  constexpr int kGrid = 26;
  constexpr double kGolden = 0.6180339887498949;
  const double step = (high - low) / (kGrid - 1);
  double best = low;
  double best_cost = cost(low);
  for (int i = 1; i < kGrid; ++i) {
    const double at = low + i * step;
    const double value = cost(at);
    if (value < best_cost) std::tie(best, best_cost) = std::pair(at, value);
  }
  double a = std::max(low, best - step);
  double b = std::min(high, best + step);
  double c = b - kGolden * (b - a);
  double d = a + kGolden * (b - a);
  double at_c = cost(c);
  double at_d = cost(d);
  while (b - a > 1e-4) {
    const bool left = at_c < at_d;
    (left ? b : a) = left ? d : c;
    (left ? d : c) = left ? c : d;
    (left ? at_d : at_c) = left ? at_c : at_d;
    double& fresh = left ? c : d;
    fresh = left ? b - kGolden * (b - a) : a + kGolden * (b - a);
    (left ? at_c : at_d) = cost(fresh);
  }
  return {0.5 * (a + b), cost(0.5 * (a + b))};
}

}  // namespace

BackgroundDisplay FitBackgroundDisplay(const PolarImage& image, const Mask& background, DisplayLaw law,
                                       double looks) {
  const std::vector<GreyCell> cells = CountGrey(image, background);
  BackgroundDisplay fitted{.display = {.law = law}, .looks = looks};
  const bool softens = law == DisplayLaw::kSoftLog || law == DisplayLaw::kSoftAmplitude;
  const bool is_power = law == DisplayLaw::kPower;
  double span_db = image.scale.db_span.value_or(kMaxDisplaySpanDb);
  // Each fits what is left, keeps it in `fitted`, and returns the cost.
  const auto cost_from = [&](double start_db) {
    fitted.display.db_min = is_power ? start_db - span_db : start_db;
    fitted.display.db_max = fitted.display.db_min + span_db;
    return NatsPerPixel(cells, fitted);
  };
  const auto best_level = [&] {
    // Levels shown as full scale lie above the noise.
    const double reach_db = is_power ? kMaxDisplaySpanDb : kReachDb;
    return cost_from(Lowest(cost_from, -kReachDb, reach_db).first);
  };
  const auto with_soft = [&](double soft_db) {
    fitted.display.soft_db = soft_db;
    return best_level();
  };
  const auto best_shape = [&] {
    return softens ? with_soft(Lowest(with_soft, -kReachDb, kReachDb).first) : best_level();
  };
  const auto with_span = [&](double log_span_db) {
    span_db = std::exp(log_span_db);
    return best_shape();
  };
  const auto with_exponent = [&](double log_exponent) {
    fitted.display.exponent = std::exp(log_exponent);
    return best_level();
  };
  if (is_power) {
    fitted.nats_per_pixel =
        with_exponent(Lowest(with_exponent, std::log(kMinExponent), std::log(kMaxExponent)).first);
  } else if (!image.scale.db_span) {
    fitted.nats_per_pixel =
        with_span(Lowest(with_span, std::log(kMinSpanDb), std::log(kMaxDisplaySpanDb)).first);
  } else {
    fitted.nats_per_pixel = best_shape();
  }
  fitted.ks = GreyKolmogorovSmirnov(cells, fitted);
  return fitted;
}

}  // namespace sonarcal::calib
