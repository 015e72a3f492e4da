#include "sim/acoustic/beam_noise.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace sonarcal::sim {
namespace {

constexpr double kCutDb = -40.0;  // level at which a beam's response to noise is cut off
constexpr double kSourcesPerWidth = 4.0;

// Weights of a beam for the noise directions from `first` on.
struct Window {
  double first = 0.0;  // a whole number, too large for an integer if beams are very narrow
  std::vector<double> weight;
};

// Weights of each beam for the noise directions, numbered along a coordinate in which all beams have one
// shape. `place` converts an azimuth to that coordinate; `field` is a beam's response at whole numbers of it.
template <typename Place, typename Field>
std::vector<Window> Windows(const std::vector<double>& centres_rad, const AzimuthResponse<double>& response,
                            const Place& place, const Field& field) {
  std::vector<Window> windows;
  for (const double centre_rad : centres_rad) {
    const auto [lowest_rad, highest_rad] = AzimuthReachRad(response, centre_rad, kCutDb);
    Window window{.first = std::floor(place(lowest_rad)), .weight = {}};
    const double last = std::ceil(place(highest_rad));
    double squares = 0.0;
    for (double source = window.first; source <= last; ++source) {
      window.weight.push_back(field(source, centre_rad));
      squares += window.weight.back() * window.weight.back();
    }
    for (double& weight : window.weight) weight /= std::sqrt(squares);
    windows.push_back(std::move(window));
  }
  return windows;
}

// Numbers the directions from 0 on, without those that no beam receives.
std::vector<ResponseWindow> Numbered(const std::vector<Window>& windows) {
  std::vector<std::size_t> order(windows.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t beam) { return windows[beam].first; });
  std::vector<ResponseWindow> numbered(windows.size());
  double end = windows[order.front()].first;  // of the directions of the beams before
  double unused = end;                        // directions before
  for (const std::size_t beam : order) {
    const auto& [first, weight] = windows[beam];
    unused += std::max(0.0, first - end);
    end = std::max(end, first + static_cast<double>(weight.size()));
    numbered[beam] = {.first = static_cast<int>(first - unused), .weight = weight};
  }
  return numbered;
}

}  // namespace

BeamNoise::BeamNoise(const SonarModel& sonar, const ParameterSet& parameters)
    : sources_(sonar.axes.beam_count()) {
  if (sonar.beam_forming == BeamForming::kLens) return;
  const AzimuthShape<double> shape = AzimuthShapeOf(sonar, parameters);
  const AzimuthResponse<double> response(shape);
  const std::vector<double>& centres_rad = sonar.axes.beam_azimuth_rad;
  if (shape.pattern == AzimuthPattern::kAperture) {
    const double length = response.aperture_wavelengths();
    weights_ = Numbered(Windows(
        centres_rad, response, [&](double azimuth_rad) { return length * std::sin(azimuth_rad); },
        [&](double source, double centre_rad) {
          return ApertureField(source - length * std::sin(centre_rad), shape.taper);
        }));
  } else {
    const double width_rad =
        shape.pattern == AzimuthPattern::kTable ? shape.beam_spacing_rad : shape.width_rad;
    const double step_rad = width_rad / kSourcesPerWidth;
    weights_ = Numbered(Windows(
        centres_rad, response, [&](double azimuth_rad) { return azimuth_rad / step_rad; },
        [&](double source, double centre_rad) { return response.Field(source * step_rad, centre_rad); }));
  }
  sources_ = 0;
  for (const ResponseWindow& window : weights_)
    sources_ = std::max(sources_, window.first + static_cast<int>(window.weight.size()));
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
