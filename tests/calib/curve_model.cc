#include "tests/calib/curve_model.h"

#include <ceres/jet.h>

#include <algorithm>
#include <cmath>

#include "core/math/random.h"
#include "sim/physics/gsab.h"

namespace sonarcal::testing {
namespace {

using Dual = ceres::Jet<double, 6>;

class Evaluation final : public calib::FrameEvaluation {
 public:
  Evaluation(const std::vector<CurvePixel>& recorded, const CurveModelOptions& options,
             const calib::ParameterValues& values, std::span<const int> active)
      : recorded_(recorded), beams_(options.pixels), active_(active.begin(), active.end()) {
    const GsabParameters<Dual> gsab = {Dual(values[0], 0), Dual(values[1], 1), Dual(values[2], 2),
                                       Dual(values[3], 3), Dual(values[4], 4), Dual(values[5], 5)};
    for (int angle = 0; angle < options.angles; ++angle)
      means_.push_back(sim::GsabPower(gsab, angle + 0.5) + options.noise);
  }

  bool Bins(int first, int last, calib::PixelTerms& terms) const override {
    const std::size_t pixels = static_cast<std::size_t>(last - first) * beams_;
    terms.residual.assign(pixels, 0.0);
    terms.slope.assign(pixels, 0.0);
    terms.information.assign(pixels, 0.0);
    terms.eta_jacobian.assign(pixels * active_.size(), 0.0);
    for (std::size_t i = 0; i < pixels; ++i) {
      const CurvePixel& pixel = recorded_[static_cast<std::size_t>(first) * beams_ + i];
      if (pixel.power == 0.0) continue;
      const Dual& mean = means_[pixel.angle];
      // Half the squared residual is ratio - 1 - ln ratio, whose derivative by ln mean is 1 - ratio.
      const double ratio = pixel.power / mean.a;
      const double deviance = std::max(0.0, 2.0 * (ratio - 1.0 - std::log(ratio)));
      terms.residual[i] = std::copysign(std::sqrt(deviance), 1.0 - ratio);
      terms.slope[i] = std::abs(1.0 - ratio) < 1e-4 ? 1.0 : (1.0 - ratio) / terms.residual[i];
      terms.information[i] = 1.0;
      for (std::size_t k = 0; k < active_.size(); ++k)
        terms.eta_jacobian[i * active_.size() + k] = mean.v[active_[k]] / mean.a;
    }
    return true;
  }

 private:
  const std::vector<CurvePixel>& recorded_;
  int beams_;
  std::vector<int> active_;
  std::vector<Dual> means_;  // by angle
};

}  // namespace

CurveModel::CurveModel(const CurveModelOptions& options) : options_(options) {
  SonarModel sonar;
  sonar.axes = {0.5, 4.5, 10, {-0.1, 0.1}};
  for (const calib::CatalogEntry& entry : calib::BuildAcousticCatalog(names_, sonar, {})) {
    if (entry.group == calib::ParameterGroup::kGsab) catalog_.push_back(entry);
  }
  // Angles in an order that leads everywhere: neighbouring pixels see unlike ones, so that no parameter hangs
  // on a few blocks of the covariance.
  constexpr std::size_t kStride = 7919;
  const std::size_t count = static_cast<std::size_t>(options.angles) * options.pixels;
  const CounterRandom random(options.seed);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t place = i * kStride % count;
    const int angle = static_cast<int>(place / options.pixels);
    const auto number = static_cast<int>(place % options.pixels);
    const double share = std::min(1.0, (angle + 0.5) / 20.0);
    const bool measured = angle >= options.first_angle &&
                          number < std::max<double>(options.least_pixels, share * options.pixels);
    const double mean = sim::GsabPower(options.truth, angle + 0.5) + options.noise;
    recorded_.push_back({angle, measured ? -mean * std::log(random.Uniform2(i).first) : 0.0});
  }
}

calib::ParameterValues CurveModel::truth() const {
  const GsabParameters<double>& t = options_.truth;
  return {t.a, t.b_deg, t.c, t.d, t.e, t.f_deg};
}

std::unique_ptr<calib::FrameEvaluation> CurveModel::At(int, const calib::ParameterValues& values,
                                                       std::span<const int> active, Terms) const {
  return std::make_unique<Evaluation>(recorded_, options_, values, active);
}

}  // namespace sonarcal::testing
