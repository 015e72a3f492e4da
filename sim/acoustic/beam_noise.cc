#include "sim/acoustic/beam_noise.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

namespace sonarcal::sim {
namespace {

constexpr double kCutDb = -40.0;  // level at which a beam's response to noise is cut off
constexpr double kSourcesPerWidth = 4.0;
// Beams narrower than this fraction of the distance between neighbours share no noise: the power of the side
// lobes of an even aperture is 1e-5 there.
constexpr double kSharesNoise = 0.01;

double SmallestGapRad(const std::vector<double>& centres_rad) {
  double gap_rad = std::numeric_limits<double>::infinity();
  for (std::size_t beam = 1; beam < centres_rad.size(); ++beam)
    gap_rad = std::min(gap_rad, std::abs(centres_rad[beam] - centres_rad[beam - 1]));
  return gap_rad;
}

// Weights of each beam for the noise directions, numbered along a coordinate in which all beams have one
// shape. `place` converts an azimuth to that coordinate; `field` is a beam's response at whole numbers of it.
template <typename Place, typename Field>
std::vector<ResponseWindow> Windows(const std::vector<double>& centres_rad,
                                    const AzimuthResponse<double>& response, const Place& place,
                                    const Field& field) {
  std::vector<ResponseWindow> windows;
  for (const double centre_rad : centres_rad) {
    const auto [lowest_rad, highest_rad] = AzimuthReachRad(response, centre_rad, kCutDb);
    const int first = static_cast<int>(std::floor(place(lowest_rad)));
    const int last = static_cast<int>(std::ceil(place(highest_rad)));
    ResponseWindow window{.first = first, .weight = {}};
    double squares = 0.0;
    for (int source = first; source <= last; ++source) {
      window.weight.push_back(field(source, centre_rad));
      squares += window.weight.back() * window.weight.back();
    }
    for (double& weight : window.weight) weight /= std::sqrt(squares);
    windows.push_back(std::move(window));
  }
  return windows;
}

}  // namespace

BeamNoise::BeamNoise(const SonarModel& sonar, const ParameterSet& parameters)
    : sources_(sonar.axes.beam_count()) {
  if (sonar.beam_forming == BeamForming::kLens) return;
  const AzimuthShape<double> shape = AzimuthShapeOf(sonar, parameters);
  const AzimuthResponse<double> response(shape);
  const std::vector<double>& centres_rad = sonar.axes.beam_azimuth_rad;
  const double width_rad = shape.pattern == AzimuthPattern::kTable ? shape.beam_spacing_rad : shape.width_rad;
  if (width_rad < kSharesNoise * SmallestGapRad(centres_rad)) return;
  if (shape.pattern == AzimuthPattern::kAperture) {
    const double length = response.aperture_wavelengths();
    weights_ = Windows(
        centres_rad, response, [&](double azimuth_rad) { return length * std::sin(azimuth_rad); },
        [&](int source, double centre_rad) {
          return ApertureField(source - length * std::sin(centre_rad), shape.taper);
        });
  } else {
    const double step_rad = width_rad / kSourcesPerWidth;
    weights_ = Windows(
        centres_rad, response, [&](double azimuth_rad) { return azimuth_rad / step_rad; },
        [&](int source, double centre_rad) { return response.Field(source * step_rad, centre_rad); });
  }
  int first = weights_.front().first;
  for (const ResponseWindow& window : weights_) first = std::min(first, window.first);
  sources_ = 0;
  for (ResponseWindow& window : weights_) {
    window.first -= first;
    sources_ = std::max(sources_, window.first + static_cast<int>(window.weight.size()));
  }
}

void BeamNoise::Draw(const CounterRandom& random, int bin, std::span<std::complex<double>> beams) const {
  using Complex = std::complex<double>;
  const auto source = [&](int i) {
    const auto [re, im] = random.Normal2(static_cast<std::uint64_t>(bin) * sources_ + i);
    return std::numbers::sqrt2 * 0.5 * Complex(re, im);
  };
  if (weights_.empty()) {
    for (int beam = 0; beam < sources_; ++beam) beams[beam] = source(beam);
    return;
  }
  std::vector<Complex> sources(sources_);
  for (int i = 0; i < sources_; ++i) sources[i] = source(i);
  for (std::size_t beam = 0; beam < weights_.size(); ++beam) {
    const ResponseWindow& window = weights_[beam];
    beams[beam] = std::inner_product(window.weight.begin(), window.weight.end(),
                                     sources.begin() + window.first, Complex(0.0), std::plus<>(),
                                     [](double weight, const Complex& value) { return weight * value; });
  }
}

}  // namespace sonarcal::sim
