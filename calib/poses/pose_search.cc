#include "calib/poses/pose_search.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "calib/poses/damped_steps.h"
#include "core/math/smoothing.h"
#include "core/math/statistics.h"
#include "core/types/units.h"

namespace sonarcal::calib {
namespace {

// Coordinates of the solver: range (m), azimuth, elevation, yaw, pitch (rad), gain (dB). The unit of each is
// a step over which the image changes by a comparable amount.
constexpr int kElevation = 2;
constexpr int kCoordinates = 6;
using Coordinates = Eigen::Matrix<double, kCoordinates, 1>;
const Coordinates kSteps = {0.02, 0.01, 0.05, 0.05, 0.05, 1.0};
// Differences must span a few rays, otherwise they show the effect of single rays at edges.
constexpr double kDifference = 0.3;  // steps
constexpr double kFirstDamping = 1e-2;
constexpr double kMaxDamping = 1e4;
constexpr double kConverged = 1e-5;  // relative fall of the cost

Coordinates CoordinatesOf(const PoseCandidate& candidate) {
  const TargetPose& p = candidate.pose;
  const Coordinates x = {p.range_m, p.azimuth_rad, p.elevation_rad,
                         p.yaw_rad, p.pitch_rad,   candidate.gain_db};
  return x.cwiseQuotient(kSteps);
}

PoseCandidate CandidateAt(const Coordinates& in_steps) {
  const Coordinates x = in_steps.cwiseProduct(kSteps);
  return {.pose = {.range_m = x(0),
                   .azimuth_rad = x(1),
                   .elevation_rad = x(2),
                   .yaw_rad = x(3),
                   .pitch_rad = x(4)},
          .gain_db = x(5)};
}

// Mean over groups of range bins, scaled to full scale 1.
Grid<float> FewerBins(const PolarImage& image, int factor, int bins) {
  Grid<float> out(bins, image.value.cols());
  for (int row = 0; row < bins; ++row) {
    for (int col = 0; col < out.cols(); ++col) {
      double sum = 0.0;
      for (int i = 0; i < factor; ++i) sum += image.value(row * factor + i, col);
      out(row, col) = static_cast<float>(sum / factor / image.scale.full_scale);
    }
  }
  return out;
}

// Matches a recorded image with predictions at one resolution.
class Matcher {
 public:
  Matcher(const Scene& target, const SonarModel& sonar, const Water& water, const PolarImage& measured,
          const ParameterSet& parameters, const PoseSearchOptions& options, int factor)
      : options_(options), factor_(factor), parameters_(parameters) {
    SonarModel coarse = sonar;
    coarse.axes.range_bins = sonar.axes.range_bins / factor;
    coarse.axes.range_max_m =
        sonar.axes.range_min_m + coarse.axes.range_bins * factor * sonar.axes.range_bin_m();
    const double bin_m = coarse.axes.range_bin_m();
    // The pulse is at least one bin long.
    parameters_.pulse.length_m = std::max(parameters_.pulse.length_m, bin_m);
    sim::SimulationOptions simulation;
    simulation.water = water;
    simulation.fan = {
        .sampling = sim::Sampling::kBeams,
        .cols = coarse.axes.beam_count() * std::max(1, options.cols_per_beam / factor),
        .rows = static_cast<int>(std::ceil(options.elevation_span_deg / options.ray_height_deg / factor)),
        .elevation_span_deg = options.elevation_span_deg};
    simulator_ = std::make_unique<sim::Simulator>(target, coarse, simulation);
    measured_ = FewerBins(measured, factor, coarse.axes.range_bins);
    Smooth(measured_, options.smooth_bins / factor, options.smooth_beams);
  }

  const Grid<float>& measured() const { return measured_; }
  const PolarAxes& axes() const { return simulator_->sonar().axes; }
  long rays_cast() const { return simulator_->caster().rays_cast(); }

  // Mean echo power of the target, without the candidate's gain.
  Grid<double> EchoPower(const TargetPose& pose) const {
    const sim::EchoList echoes = simulator_->TraceEchoes(pose.WorldFromSonar());
    const sim::ScatterMap scatter = sim::MakeScatterMap(echoes, simulator_->fan(), geometry(), parameters_);
    return sim::EchoPowerImage(scatter, geometry(), parameters_);
  }

  // Expected display of echoes of that power and of the noise floor, smoothed, full scale 1. The gain belongs
  // to the target and does not change the noise.
  Grid<float> Displayed(Grid<double> power, double gain_db) const {
    const double gain = PowerFromDb(gain_db);
    for (double& value : power.values()) value *= gain;
    sim::AddNoiseFloor(geometry(), parameters_, power);
    PolarImage shown = sim::ExpectedDisplay(sim::PowerImage(axes(), power), parameters_, 1.0);
    Smooth(shown.value, options_.smooth_bins / factor_, options_.smooth_beams);
    return shown.value;
  }

  double Cost(const Grid<float>& predicted) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < predicted.size(); ++i) {
      const double difference = predicted.values()[i] - measured_.values()[i];
      sum += difference * difference;
    }
    return sum / static_cast<double>(predicted.size());
  }

  // Returns the best of several gains at a pose.
  PoseCandidate BestGain(const TargetPose& pose) const {
    const Grid<double> power = EchoPower(pose);
    PoseCandidate best{.pose = pose, .gain_db = 0.0, .cost = std::numeric_limits<double>::infinity()};
    for (double gain_db = -30.0; gain_db <= 30.0; gain_db += 5.0) {
      const double cost = Cost(Displayed(power, gain_db));
      if (cost < best.cost) best = {pose, gain_db, cost};
    }
    return best;
  }

  // Refines a start with Levenberg-Marquardt. `hold_elevation` fixes that coordinate.
  PoseCandidate Refine(const PoseCandidate& start, bool hold_elevation) const {
    const auto [lower, upper] = Bounds();
    State state = At(CoordinatesOf(start).cwiseMax(lower).cwiseMin(upper));
    double damping = kFirstDamping;
    for (int i = 0; i < options_.max_iterations; ++i) {
      QuadraticCost normal = NormalAt(state);
      if (hold_elevation) Hold(kElevation, normal);
      for (int k = 0; k < kCoordinates; ++k) {
        const bool at_bound = (state.x(k) <= lower(k) && normal.score(k) < 0.0) ||
                              (state.x(k) >= upper(k) && normal.score(k) > 0.0);
        if (at_bound) Hold(k, normal);
      }
      const auto trial_at = [&, &low = lower, &high = upper](const Eigen::VectorXd& step) {
        return At((state.x + step).cwiseMax(low).cwiseMin(high));
      };
      double fall = 0.0;
      while (fall == 0.0 && damping < kMaxDamping) fall = DampedStep(normal, trial_at, damping, state);
      if (fall <= kConverged * state.cost) break;
    }
    PoseCandidate refined = CandidateAt(state.x);
    refined.cost = state.cost;
    refined.pose.yaw_rad = std::remainder(refined.pose.yaw_rad, 2.0 * kPi);
    return refined;
  }

 private:
  struct State {
    Coordinates x;
    Grid<float> predicted;
    double cost = 0.0;
  };

  State At(const Coordinates& x) const {
    const PoseCandidate at = CandidateAt(x);
    State state{.x = x, .predicted = Displayed(EchoPower(at.pose), at.gain_db)};
    state.cost = Cost(state.predicted);
    return state;
  }

  // Lowest and highest coordinates.
  std::pair<Coordinates, Coordinates> Bounds() const {
    constexpr double kNone = std::numeric_limits<double>::infinity();
    const double elevation_rad = RadFromDeg(options_.elevation_limit_deg);
    const double pitch_rad = RadFromDeg(options_.pitch_limit_deg);
    const std::vector<double>& beams_rad = axes().beam_azimuth_rad;
    const Coordinates lower = {
        axes().range_min_m, beams_rad.front(), -elevation_rad, -kNone, -pitch_rad, -kNone};
    const Coordinates upper = {axes().range_max_m, beams_rad.back(), elevation_rad, kNone, pitch_rad, kNone};
    return {lower.cwiseQuotient(kSteps), upper.cwiseQuotient(kSteps)};
  }

  // By central differences of traced images.
  QuadraticCost NormalAt(const State& state) const {
    const auto pixels = static_cast<Eigen::Index>(measured_.size());
    const auto image = [pixels](const Grid<float>& grid) {
      return Eigen::Map<const Eigen::VectorXf>(grid.values().data(), pixels).cast<double>();
    };
    Eigen::MatrixXd slopes(pixels, kCoordinates);
    for (int k = 0; k < kCoordinates; ++k) {
      const Coordinates move = kDifference * Coordinates::Unit(k);
      slopes.col(k) =
          (image(At(state.x + move).predicted) - image(At(state.x - move).predicted)) / (2.0 * kDifference);
    }
    return {slopes.transpose() * slopes, slopes.transpose() * (image(measured_) - image(state.predicted))};
  }

  static void Hold(int coordinate, QuadraticCost& normal) {
    normal.information.row(coordinate).setZero();
    normal.information.col(coordinate).setZero();
    normal.information(coordinate, coordinate) = 1.0;
    normal.score(coordinate) = 0.0;
  }

  sim::AcousticGeometry geometry() const { return {simulator_->sonar(), simulator_->absorption_db_per_m()}; }

  const PoseSearchOptions& options_;
  int factor_;
  ParameterSet parameters_;
  std::unique_ptr<sim::Simulator> simulator_;
  Grid<float> measured_;
};

// Pose of the bright region: mean range and azimuth of the pixels more than four standard deviations above
// the median, weighted by their excess.
TargetPose PoseOfBrightRegion(const Grid<float>& image, const PolarAxes& axes) {
  std::vector<float> values(image.values().begin(), image.values().end());
  const float median = UpperMedian(values);
  for (float& value : values) value = std::abs(value - median);
  const double threshold = median + 4.0 * kSigmaPerMad * UpperMedian(std::move(values));
  double weight = 0.0;
  double range_m = 0.0;
  double azimuth_rad = 0.0;
  for (int row = 0; row < image.rows(); ++row) {
    for (int col = 0; col < image.cols(); ++col) {
      const double excess = image(row, col) - threshold;
      if (excess <= 0.0) continue;
      weight += excess;
      range_m += excess * axes.range_centre_m(row);
      azimuth_rad += excess * axes.beam_azimuth_rad[col];
    }
  }
  if (!(weight > 0.0)) {
    throw DataError("pose search: no pixel of the image is four standard deviations above its background");
  }
  return {.range_m = range_m / weight, .azimuth_rad = azimuth_rad / weight};
}

double LargestExtentM(const Scene& target) {
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& vertex : target.vertices_m) box.extend(vertex);
  return box.sizes().maxCoeff();
}

std::string Describe(const PoseCandidate& c) {
  return fmt::format(
      "range {:.3f} m, azimuth {:.2f}, elevation {:.2f}, yaw {:.1f}, pitch {:.1f} deg, rms difference {:.4f}",
      c.pose.range_m, DegFromRad(c.pose.azimuth_rad), DegFromRad(c.pose.elevation_rad),
      DegFromRad(c.pose.yaw_rad), DegFromRad(c.pose.pitch_rad), std::sqrt(c.cost));
}

bool ByCost(const PoseCandidate& a, const PoseCandidate& b) {
  return a.cost < b.cost;
}

// Describes other poses that fit the image equally well.
std::vector<std::string> OpenQuestions(const Matcher& fine, const PoseSearchResult& result,
                                       const PoseSearchOptions& options) {
  std::vector<std::string> open;
  const double mirror_cost =
      fine.Cost(fine.Displayed(fine.EchoPower(result.best.pose.Mirrored()), result.best.gain_db));
  open.push_back(
      fmt::format("the sign of elevation and pitch together: the pose mirrored in the plane of the beams "
                  "differs from the image by "
                  "{:.4f} rms, the one reported by {:.4f}",
                  std::sqrt(mirror_cost), std::sqrt(result.best.cost)));
  if (!result.ridge.empty()) {
    const double lowest = std::min_element(result.ridge.begin(), result.ridge.end(), ByCost)->cost;
    std::string costs;
    for (std::size_t i = 0; i < result.ridge.size(); ++i) {
      costs += fmt::format("{}{:+.0f} deg {:+.1f} %", i == 0 ? "" : ", ", options.ridge_elevations_deg[i],
                           100.0 * (std::sqrt(result.ridge[i].cost / lowest) - 1.0));
    }
    open.push_back("elevation (height): with it fixed and the rest refitted, the rms difference grows by " +
                   costs);
  }
  open.emplace_back("roll about the length of a body of revolution");
  return open;
}

}  // namespace

void PoseSearchOptions::Check() const {
  const auto at_least = [](const char* name, double value, double limit) {
    if (!(value >= limit)) throw DataError("pose search: {} {}, expected at least {}", name, value, limit);
  };
  at_least("smooth_bins", smooth_bins, 0.0);
  at_least("smooth_beams", smooth_beams, 0.0);
  at_least("yaw_steps", yaw_steps, 1);
  at_least("pitches", static_cast<double>(pitches_deg.size()), 1);
  at_least("refined_starts", refined_starts, 1);
  at_least("coarse_factor", coarse_factor, 1);
  at_least("cols_per_beam", cols_per_beam, 1);
  at_least("ray_height_deg", ray_height_deg, 1e-3);
  at_least("elevation_span_deg", elevation_span_deg, ray_height_deg);
  at_least("max_iterations", max_iterations, 1);
}

PoseSearchResult SearchPose(const Scene& target, const SonarModel& sonar, const Water& water,
                            const PolarImage& measured, const ParameterSet& parameters,
                            const PoseSearchOptions& options) {
  options.Check();
  if (measured.scale.quantity != Quantity::kGrey) {
    throw DataError("pose search: the image holds {}, expected grey levels",
                    ToString(measured.scale.quantity));
  }
  const auto say = [&](const std::string& line) {
    if (options.progress) options.progress(line);
  };
  const Matcher coarse(target, sonar, water, measured, parameters, options, options.coarse_factor);
  const Matcher fine(target, sonar, water, measured, parameters, options, 1);
  const TargetPose seen = PoseOfBrightRegion(coarse.measured(), coarse.axes());

  // Start value: the bright side is nearer than the centre by up to half the thickness of the target, about a
  // tenth of its length.
  std::vector<PoseCandidate> sweep;
  const double depth_m = 0.1 * LargestExtentM(target);
  for (const double pitch_deg : options.pitches_deg) {
    say(fmt::format("sweeping headings at pitch {:.0f} deg", pitch_deg));
    for (int step = 0; step < options.yaw_steps; ++step) {
      TargetPose pose = seen;
      pose.range_m += depth_m;
      pose.pitch_rad = RadFromDeg(pitch_deg);
      pose.yaw_rad = 2.0 * kPi * step / options.yaw_steps;
      sweep.push_back(coarse.BestGain(pose));
    }
  }
  std::sort(sweep.begin(), sweep.end(), ByCost);

  PoseSearchResult result;
  const auto count = std::min<std::size_t>(sweep.size(), options.refined_starts);
  for (std::size_t i = 0; i < count; ++i) {
    result.starts.push_back(coarse.Refine(sweep[i], false));
    say(fmt::format("start {} of {}: {}", i + 1, count, Describe(result.starts.back())));
  }
  std::sort(result.starts.begin(), result.starts.end(), ByCost);
  for (const double elevation_deg : options.ridge_elevations_deg) {
    PoseCandidate held = result.starts.front();
    held.pose.elevation_rad = RadFromDeg(elevation_deg);
    result.ridge.push_back(coarse.Refine(held, true));
  }
  // A neighbour on the ridge may be in a better valley than the starts.
  const PoseCandidate ridge_best = result.ridge.empty()
                                       ? result.starts.front()
                                       : *std::min_element(result.ridge.begin(), result.ridge.end(), ByCost);
  result.best = fine.Refine(std::min(result.starts.front(), ridge_best, ByCost), false);
  say("refined on the full image: " + Describe(result.best));
  result.open = OpenQuestions(fine, result, options);
  result.rays_cast = coarse.rays_cast() + fine.rays_cast();
  return result;
}

}  // namespace sonarcal::calib
