#include "sim/coherent/coherent_image.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <span>

#include "core/math/random.h"
#include "core/types/units.h"
#include "sim/ghosts/ghost_power.h"
#include "sim/physics/beam_and_pulse.h"
#include "sim/physics/echo_power_model.h"
#include "sim/physics/line_array.h"
#include "sim/physics/propagation.h"
#include "sim/physics/receiver.h"

namespace sonarcal::sim {
namespace {

using Complex = std::complex<double>;

constexpr double kPulseReachInWidths = 2.5;  // 2^-25, -75 dB
constexpr int kElementsATask = 40;

// Streams of random numbers. They differ from the streams of the acoustic model's speckle.
enum Stream : std::uint32_t {
  kAmplitudes = 0x1000,
  kSpots = 0x2000,
  kElementNoise = 0x3000,
  kGhostSpots = 0x5000,
  kGhostAmplitudes = 0x6000,
  kTargetPhases = 0x7000
};

struct Scatterer {
  double range_m;
  double sine;  // sine of its azimuth
  Complex amplitude;
};

// Draws scatterers for the surfaces that the fan hits.
class ScattererSource {
 public:
  ScattererSource(const CoherentGeometry& geometry, const Pose& world_from_sonar,
                  const ParameterSet& parameters)
      : geometry_(geometry),
        power_({geometry.sonar, geometry.absorption_db_per_m}, parameters, geometry.caster.material_names()),
        sonar_from_world_(world_from_sonar.rotation.conjugate().toRotationMatrix()),
        // Echoes from just beyond the window still reach its last bins.
        hits_(geometry.caster.Cast(geometry.fan, world_from_sonar,
                                   geometry.sonar.axes.range_max_m +
                                       kPulseReachInWidths * PulseLengthM(geometry.sonar, parameters))) {}

  // Scatterers in the order of the rays, as the sonar receives them from a pose of a ping.
  std::vector<Scatterer> Draw(const Pose& frame_from_ping, std::uint64_t seed, int look) const {
    const Pose ping_from_frame = frame_from_ping.Inverse();
    const CounterRandom amplitudes(seed, kAmplitudes + static_cast<std::uint32_t>(look));
    const CounterRandom spots(seed, kSpots + static_cast<std::uint32_t>(look));
    std::vector<std::vector<Scatterer>> by_row(geometry_.fan.rows());
    tbb::parallel_for(0, geometry_.fan.rows(), [&](int row) {
      for (int col = 0; col < geometry_.fan.cols(); ++col) {
        const std::size_t ray = static_cast<std::size_t>(row) * geometry_.fan.cols() + col;
        if (hits_.triangle[ray] < 0 || !(hits_.range_m[ray] > 0.0F)) continue;
        const auto [u, v] = spots.Uniform2(ray);
        const auto [re, im] = amplitudes.Normal2(ray);
        by_row[row].push_back(Place(row, col, u - 0.5, v - 0.5, ping_from_frame, Complex(re, im)));
      }
    });
    std::vector<Scatterer> all;
    for (const auto& row : by_row) all.insert(all.end(), row.begin(), row.end());
    return all;
  }

 private:
  // Scatterer on the plane that the ray hit, at (u, v) of the ray's cell. `unit` has a mean square of 2.
  Scatterer Place(int row, int col, double u, double v, const Pose& ping_from_frame,
                  const Complex& unit) const {
    const std::size_t ray = static_cast<std::size_t>(row) * geometry_.fan.cols() + col;
    const int triangle = hits_.triangle[ray];
    const Eigen::Vector3d normal =
        sonar_from_world_ * geometry_.caster.TriangleNormal(triangle).cast<double>();
    const Eigen::Vector3d centre = geometry_.fan.Direction(row, col).cast<double>();
    Eigen::Vector3d direction = geometry_.fan.DirectionWithin(row, col, u, v);
    // If the plane is nearly edge-on, the spot could lie anywhere. The ray's own hit is used instead.
    double stretch = centre.dot(normal) / direction.dot(normal);
    if (!(stretch > 0.5 && stretch < 2.0)) {
      stretch = 1.0;
      direction = centre;
    }
    const double range_m = hits_.range_m[ray] * stretch;
    const double incidence_rad = std::atan2(direction.cross(normal).norm(), std::abs(direction.dot(normal)));
    const double elevation_rad = std::asin(std::clamp(direction.z(), -1.0, 1.0));
    EchoPath path = power_.StraightBack(range_m, incidence_rad, geometry_.fan.SolidAngleSr(row, col),
                                        power_.elevation().Power(elevation_rad));
    const int material = geometry_.caster.TriangleMaterial(triangle);
    if (IsIdentity(ping_from_frame)) {
      const double power = power_.Power(path, power_.Backscatter(material, incidence_rad));
      return {range_m, direction.x() / std::hypot(direction.x(), direction.y()),
              std::sqrt(0.5 * power) * unit};
    }
    // The patch keeps its area and its random phase; the path adds its own phase.
    const Eigen::Vector3d at_m = ping_from_frame * (range_m * direction);
    const double path_m = at_m.norm();
    const Eigen::Vector3d towards = at_m / path_m;
    const Eigen::Vector3d turned = ping_from_frame.rotation * normal;
    const double angle_rad = std::atan2(towards.cross(turned).norm(), std::abs(towards.dot(turned)));
    path.loss_db = 2.0 * TransmissionLossDb(path_m, geometry_.absorption_db_per_m);
    path.elevation_power = power_.elevation().Power(std::asin(std::clamp(towards.z(), -1.0, 1.0)));
    const double power = power_.Power(path, power_.Backscatter(material, angle_rad));
    const double phase_rad = 2.0 * Wavenumber(geometry_.sonar) * (range_m - path_m);
    return {path_m, towards.x() / std::hypot(towards.x(), towards.y()),
            std::sqrt(0.5 * power) * unit * std::polar(1.0, phase_rad)};
  }

  const CoherentGeometry& geometry_;
  EchoPowerModel power_;
  Eigen::Matrix3d sonar_from_world_;
  FanHits hits_;
};

// Scatterers of multipath echoes: one or two per echo.
std::vector<Scatterer> DrawGhosts(const CoherentGeometry& geometry, const Pose& world_from_sonar,
                                  const ParameterSet& parameters, std::uint64_t seed, int look) {
  std::vector<Scatterer> all;
  if (geometry.mirrors == nullptr) return all;
  // Each look has its own spots.
  const CounterRandom of_look(seed, kGhostSpots + static_cast<std::uint32_t>(look));
  const auto spots_seed = static_cast<std::uint64_t>(of_look.Uniform2(0).first * 0x1p53);
  const PolarAxes& axes = geometry.sonar.axes;
  const GhostList ghosts = TraceGhosts(
      geometry.caster, *geometry.mirrors, *geometry.ghost_fan, world_from_sonar,
      {.order = geometry.ghost_order,
       .range_min_m = 0.0,
       .range_max_m = axes.range_max_m + kPulseReachInWidths * PulseLengthM(geometry.sonar, parameters),
       .spots_seed = spots_seed});
  const GhostPower power(ghosts.material_names, {geometry.sonar, geometry.absorption_db_per_m}, parameters);
  const TransmitPattern transmit(parameters.beam);
  const CounterRandom amplitudes(seed, kGhostAmplitudes + static_cast<std::uint32_t>(look));
  for (std::size_t i = 0; i < ghosts.echoes.size(); ++i) {
    const GhostEcho& echo = ghosts.echoes[i];
    const auto [re, im] = amplitudes.Normal2(i);
    const Complex unit = std::sqrt(0.5 * power.OneWay(echo)) * Complex(re, im);
    const auto add = [&](const GhostLeg& sent_by, const GhostLeg& heard_by) {
      all.push_back({echo.range_m(), std::sin(double{heard_by.azimuth_rad}),
                     std::sqrt(transmit.Power(sent_by.azimuth_rad)) * unit});
    };
    add(echo.other, echo.leg);
    if (echo.both_ways) add(echo.leg, echo.other);
  }
  return all;
}

std::vector<Scatterer> PointTargetEchoes(const CoherentGeometry& geometry, const Pose& world_from_sonar,
                                         const ParameterSet& parameters, std::uint64_t seed, int look) {
  const CounterRandom phases(seed, kTargetPhases + static_cast<std::uint32_t>(look));
  const ElevationResponse elevation = ElevationResponseOf(geometry.sonar, parameters.beam);
  std::vector<Scatterer> all;
  for (std::size_t i = 0; i < geometry.point_targets.size(); ++i) {
    const PointTarget& target = geometry.point_targets[i];
    const Eigen::Vector3d at = world_from_sonar.Inverse() * target.position_m;
    if (!(at.y() > 0.0)) continue;  // its sine of azimuth is that of a place in front
    const double range_m = at.norm();
    const double level_db = parameters.source_level_db + parameters.receiver.gain_db -
                            2.0 * TransmissionLossDb(range_m, geometry.absorption_db_per_m);
    const double power =
        PowerFromDb(level_db) * target.cross_section_m2 * elevation.Power(std::asin(at.z() / range_m));
    all.push_back({range_m, at.x() / std::hypot(at.x(), at.y()),
                   std::polar(std::sqrt(power), kTwoPi * phases.Uniform2(i).first)});
  }
  return all;
}

// Adds the echo of every scatterer to `count` elements. The field is range_bins x count. Real and imaginary
// parts are stored separately so that the innermost loop is plain arithmetic on rows of numbers.
void Receive(const std::vector<Scatterer>& scatterers, const PolarAxes& axes, double pulse_m,
             const double* position, int count, Grid<double>& real, Grid<double>& imaginary) {
  const double pitch = count > 1 ? position[1] - position[0] : 0.0;
  const double reach_m = kPulseReachInWidths * pulse_m;
  std::array<double, kElementsATask> re{};
  std::array<double, kElementsATask> im{};
  for (const Scatterer& scatterer : scatterers) {
    const double bin_of_range = (scatterer.range_m - axes.range_min_m) / axes.range_bin_m() - 0.5;
    const double reach = reach_m / axes.range_bin_m();
    const int first = static_cast<int>(std::ceil(std::max(bin_of_range - reach, 0.0)));
    const int last = static_cast<int>(std::floor(std::min(bin_of_range + reach, axes.range_bins - 1.0)));
    if (first > last) continue;
    Complex field = scatterer.amplitude * std::polar(1.0, kTwoPi * position[0] * scatterer.sine);
    const Complex step = std::polar(1.0, kTwoPi * pitch * scatterer.sine);
    for (int element = 0; element < count; ++element) {
      re[element] = field.real();
      im[element] = field.imag();
      field = {field.real() * step.real() - field.imag() * step.imag(),
               field.real() * step.imag() + field.imag() * step.real()};
    }
    for (int bin = first; bin <= last; ++bin) {
      // Square root of the power response.
      const double envelope =
          GaussianResponse(axes.range_centre_m(bin) - scatterer.range_m, pulse_m * std::numbers::sqrt2);
      double* real_row = real.row(bin).data();
      double* imaginary_row = imaginary.row(bin).data();
      for (int element = 0; element < count; ++element) {
        real_row[element] += envelope * re[element];
        imaginary_row[element] += envelope * im[element];
      }
    }
  }
}

// Field at every element, range_bins x elements. Each task owns some elements and adds all scatterers in
// their order, so the sums do not depend on the number of threads.
Grid<Complex> ElementFields(const std::vector<Scatterer>& scatterers, const PolarAxes& axes, double pulse_m,
                            const LineArray& array) {
  const int elements = static_cast<int>(array.shading.size());
  Grid<Complex> fields(axes.range_bins, elements);
  const int tasks = (elements + kElementsATask - 1) / kElementsATask;
  tbb::parallel_for(0, tasks, [&](int task) {
    const int first = task * kElementsATask;
    const int count = std::min(kElementsATask, elements - first);
    Grid<double> real(axes.range_bins, count);
    Grid<double> imaginary(axes.range_bins, count);
    Receive(scatterers, axes, pulse_m, &array.position_wavelengths[first], count, real, imaginary);
    for (int bin = 0; bin < axes.range_bins; ++bin) {
      for (int i = 0; i < count; ++i) fields(bin, first + i) = {real(bin, i), imaginary(bin, i)};
    }
  });
  return fields;
}

// Noise of unit power in each element, filtered by a receiver that is matched to the pulse. White noise in
// steps finer than pulse and bin is filtered with the transmitted envelope q(x) = 2^-(2 x / length)^2. The
// autocorrelation of this envelope is the field of an echo.
class ElementNoise {
 public:
  ElementNoise(const PolarAxes& axes, double pulse_m, int elements, const CounterRandom& random)
      : elements_(elements),
        steps_a_bin_(std::clamp(static_cast<int>(std::ceil(4.0 * axes.range_bin_m() / pulse_m)), 1, 64)),
        random_(random) {
    const double step_m = axes.range_bin_m() / steps_a_bin_;
    const int reach = static_cast<int>(kEnvelopeReachInWidths * pulse_m / step_m);
    double squares = 0.0;
    for (int i = -reach; i <= reach; ++i) {
      filter_.push_back(GaussianResponse(i * step_m, pulse_m));
      squares += filter_.back() * filter_.back();
    }
    for (double& weight : filter_) weight /= std::sqrt(squares);
  }

  int elements() const { return elements_; }

  // Adds `amplitude` x the noise of a bin to the field of each element.
  void AddTo(int bin, double amplitude, std::vector<Complex>& field) const {
    for (std::size_t i = 0; i < filter_.size(); ++i) {
      const std::uint64_t step = static_cast<std::uint64_t>(bin) * steps_a_bin_ + i;
      const double weight = std::sqrt(0.5) * amplitude * filter_[i];
      for (int element = 0; element < elements_; ++element) {
        const auto [re, im] = random_.Normal2(step * elements_ + element);
        field[element] += weight * Complex(re, im);
      }
    }
  }

 private:
  static constexpr double kEnvelopeReachInWidths = 1.8;  // 2^-13 of its peak

  int elements_;
  int steps_a_bin_;
  CounterRandom random_;
  std::vector<double> filter_;
};

// Receiver factors on power.
struct ReceiverPower {
  std::vector<double> gain;         // per bin
  std::vector<double> sensitivity;  // per beam; applies to echoes only
  Grid<double> floor;
  BeamForming beam_forming;
};

// Adds weight x |beams of (echoes + noise)|^2 to these beams of `power`. Echoes and noise of unit power pass
// the linear beamformer separately, so the noise floor may differ between beams. If a lens forms the beams,
// `noise` has one element per beam and passes no beamformer.
void AddPower(const Grid<Complex>& fields, const Beamformer& beamformer, const ElementNoise& noise,
              const ReceiverPower& receiver, double weight, const std::vector<int>& beams,
              Grid<double>& power) {
  tbb::parallel_for(0, power.rows(), [&](int bin) {
    const bool lens = receiver.beam_forming == BeamForming::kLens;
    std::vector<Complex> unit_noise(noise.elements());
    noise.AddTo(bin, lens ? 1.0 : beamformer.noise_scale(), unit_noise);
    for (const int beam : beams) {
      const Complex of_noise = lens ? unit_noise[beam] : beamformer.Beam(beam, unit_noise);
      const double echo_power = receiver.gain[bin] * receiver.sensitivity[beam];
      const Complex received = std::sqrt(echo_power) * beamformer.Beam(beam, fields.row(bin)) +
                               std::sqrt(receiver.floor(bin, beam)) * of_noise;
      power(bin, beam) += weight * std::norm(received);
    }
  });
}

double AzimuthWidthRad(const SonarModel& sonar, const ParameterSet& parameters) {
  ParameterSet aperture = parameters;
  aperture.beam.azimuth_pattern = AzimuthPattern::kAperture;
  return AzimuthShapeOf(sonar, aperture).width_rad;
}

}  // namespace

PolarImage CoherentPower(const CoherentGeometry& geometry, const Pose& world_from_sonar,
                         const ParameterSet& parameters, const DrawSeeds& seeds) {
  return CoherentPower(geometry, world_from_sonar, {PingOfAllBeams(geometry.sonar.axes.beam_count())},
                       parameters, seeds);
}

PolarImage CoherentPower(const CoherentGeometry& geometry, const Pose& world_from_sonar,
                         const std::vector<PingPose>& pings, const ParameterSet& parameters,
                         const DrawSeeds& seeds) {
  CheckLooksToDraw(parameters.receiver.looks);
  const PolarAxes& axes = geometry.sonar.axes;
  const LineArray array =
      MakeLineArray(AzimuthWidthRad(geometry.sonar, parameters), parameters.beam.azimuth_taper);
  const Beamformer beamformer(array, axes);
  const ScattererSource source(geometry, world_from_sonar, parameters);
  const AcousticGeometry acoustic{geometry.sonar, geometry.absorption_db_per_m};
  const ReceiverPower receiver{.gain = GainByBin(acoustic, parameters),
                               .sensitivity = BeamSensitivity(geometry.sonar, parameters.beam),
                               .floor = NoiseFloorPower(acoustic, parameters),
                               .beam_forming = geometry.sonar.beam_forming};
  const bool lens = geometry.sonar.beam_forming == BeamForming::kLens;

  const auto [whole_looks, last_weight] = LooksAsWeights(parameters.receiver.looks);
  const int looks = whole_looks + (last_weight > 0.0 ? 1 : 0);
  Grid<double> power(axes.range_bins, axes.beam_count());
  const double pulse_m = PulseLengthM(geometry.sonar, parameters);
  for (int look = 0; look < looks; ++look) {
    const double weight = (look < whole_looks ? 1.0 : last_weight) / (whole_looks + last_weight);
    for (std::size_t ping = 0; ping < pings.size(); ++ping) {
      const Pose pose = world_from_sonar * pings[ping].frame_from_ping;
      std::vector<Scatterer> scatterers = source.Draw(pings[ping].frame_from_ping, seeds.scatterers, look);
      const std::vector<Scatterer> ghosts = DrawGhosts(geometry, pose, parameters, seeds.scatterers, look);
      scatterers.insert(scatterers.end(), ghosts.begin(), ghosts.end());
      const std::vector<Scatterer> targets =
          PointTargetEchoes(geometry, pose, parameters, seeds.scatterers, look);
      scatterers.insert(scatterers.end(), targets.begin(), targets.end());
      const Grid<Complex> fields = ElementFields(scatterers, axes, pulse_m, array);
      const ElementNoise noise(
          axes, pulse_m, lens ? axes.beam_count() : beamformer.elements(),
          CounterRandom(SeedsOfPing(seeds, ping).receiver, kElementNoise + static_cast<std::uint32_t>(look)));
      AddPower(fields, beamformer, noise, receiver, weight, pings[ping].beams, power);
    }
  }
  return PowerImage(axes, power);
}

}  // namespace sonarcal::sim
