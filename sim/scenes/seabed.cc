#include "sim/scenes/seabed.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/math/random.h"
#include "core/types/error.h"
#include "core/types/units.h"
#include "sim/scenes/scene_primitives.h"

namespace sonarcal::sim {
namespace {

using Eigen::Vector3d;

constexpr int kRippleTrains = 2;
constexpr int kSpanCells = 200;  // cells per side of the grid on which the extremes are found

}  // namespace

void SeabedOptions::Validate() const {
  const auto require = [](const char* field, double value, double low, double high) {
    if (!(value >= low && value <= high)) {
      throw DataError("seabed: {} is {}, expected {}..{}", field, value, low, high);
    }
  };
  require("length_m", length_m, 0.1, 1e4);
  require("width_m", width_m, 0.1, 1e4);
  require("height_m", height_m, 1e-3, 1e3);
  require("hills", hills, 1, 1000);
  require("ripple_length_m", ripple_length_m, 0.01, 1e4);
  require("ripple_share", ripple_share, 0.0, 0.2);
  if (!(max_edge_m > 0.0)) throw DataError("seabed: max_edge_m is {}, expected more than 0", max_edge_m);
}

SeabedRelief::SeabedRelief(const SeabedOptions& options) : height_m_(options.height_m) {
  options.Validate();
  const CounterRandom hill_random(options.seed, 0);
  const double side_m = std::min(options.length_m, options.width_m);
  for (int hill = 0; hill < options.hills; ++hill) {
    const auto [x, y] = hill_random.Uniform2(2 * static_cast<std::uint64_t>(hill));
    const auto [width, height] = hill_random.Uniform2(2 * static_cast<std::uint64_t>(hill) + 1);
    hills_.push_back({(x - 0.5) * options.length_m, (y - 0.5) * options.width_m,
                      (0.07 + 0.09 * width) * side_m, 2.0 * height - 1.0});
  }
  const auto find_span = [&] {
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (int row = 0; row <= kSpanCells; ++row) {
      for (int col = 0; col <= kSpanCells; ++col) {
        const double raw = Raw((double(col) / kSpanCells - 0.5) * options.length_m,
                               (double(row) / kSpanCells - 0.5) * options.width_m);
        low = std::min(low, raw);
        high = std::max(high, raw);
      }
    }
    return std::pair(low, high - low);
  };
  const double hills_span = find_span().second;
  const CounterRandom ripple_random(options.seed, 1);
  for (int train = 0; train < kRippleTrains; ++train) {
    const auto [turn, phase] = ripple_random.Uniform2(train);
    // Crests cross at up to 40 degrees, as with a turning current.
    const double heading_rad = (turn - 0.5) * 40.0 * kRadPerDeg + 0.5;
    const double wave_rad_per_m = 2.0 * kPi / options.ripple_length_m * (train == 0 ? 1.0 : 1.3);
    ripples_.push_back({wave_rad_per_m * std::cos(heading_rad), wave_rad_per_m * std::sin(heading_rad),
                        2.0 * kPi * phase, options.ripple_share * hills_span / kRippleTrains});
  }
  const auto [low, span] = find_span();
  lowest_ = low;
  scale_m_ = options.height_m / span;
}

double SeabedRelief::Raw(double x_m, double y_m) const {
  double raw = 0.0;
  for (const Hill& hill : hills_) {
    const double dx = (x_m - hill.x_m) / hill.width_m;
    const double dy = (y_m - hill.y_m) / hill.width_m;
    raw += hill.height * std::exp(-0.5 * (dx * dx + dy * dy));
  }
  for (const Ripple& ripple : ripples_) {
    raw += ripple.height * std::sin(ripple.x_rad_per_m * x_m + ripple.y_rad_per_m * y_m + ripple.phase_rad);
  }
  return raw;
}

double SeabedRelief::HeightM(double x_m, double y_m) const {
  return std::clamp((Raw(x_m, y_m) - lowest_) * scale_m_, 0.0, height_m_);
}

Scene MakeSeabed(const SeabedOptions& options) {
  const SeabedRelief relief(options);
  const Vector3d corner_m(-0.5 * options.length_m, -0.5 * options.width_m, 0.0);
  Scene scene = MakePatch(corner_m, options.length_m * Vector3d::UnitX(), options.width_m * Vector3d::UnitY(),
                          options.max_edge_m, options.material);
  for (Eigen::Vector3f& vertex_m : scene.vertices_m) {
    vertex_m.z() = static_cast<float>(relief.HeightM(vertex_m.x(), vertex_m.y()));
  }
  return scene;
}

}  // namespace sonarcal::sim
