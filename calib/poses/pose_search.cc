#include "calib/poses/pose_search.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <mutex>
#include <utility>

#include "calib/poses/pose_matcher.h"
#include "core/math/smoothing.h"
#include "core/math/statistics.h"
#include "core/types/units.h"

namespace sonarcal::calib {
namespace {

constexpr double kGainReachDb = 30.0;     // about the given parameters
constexpr double kSameTurnDeg = 12.0;     // refined poses that differ by less are one
constexpr double kSameStartShare = 0.75;  // of the spacing: starts that differ by less lead to one pose
constexpr int kRidgeIterations = 8;
// With a floor: angles by which the sonar looks down.
constexpr std::array kTiltsDeg = {10.0, 25.0, 40.0, 60.0};

// Brightest spot of about the size of the target, in the smoothed image.
struct BrightSpot {
  double range_m = 0.0;
  double azimuth_rad = 0.0;
};

std::string RegionText(const PoseSearchOptions& options) {
  std::string text;
  if (options.range_m)
    text += fmt::format("range {:g} to {:g} m", options.range_m->low, options.range_m->high);
  if (options.azimuth_deg) {
    text += fmt::format("{}azimuth {:g} to {:g} deg", text.empty() ? "" : ", ", options.azimuth_deg->low,
                        options.azimuth_deg->high);
  }
  return text;
}

BrightSpot FindBrightSpot(const PolarImage& measured, double extent_m, const PoseSearchOptions& options) {
  Grid<float> image = measured.value;
  Smooth(image, options.smooth_bins, options.smooth_beams);
  std::vector<float> values(image.values().begin(), image.values().end());
  const float median = UpperMedian(values);
  for (float& value : values) value = std::abs(value - median);
  const double threshold = median + 4.0 * kSigmaPerMad * UpperMedian(std::move(values));

  struct Bright {
    double range_m, azimuth_rad, excess;
  };
  const PolarAxes& axes = measured.axes;
  std::vector<Bright> bright;
  for (int row = 0; row < image.rows(); ++row) {
    const double range_m = axes.range_centre_m(row);
    if (options.range_m && !options.range_m->Contains(range_m)) continue;
    for (int col = 0; col < image.cols(); ++col) {
      const double azimuth_rad = axes.beam_azimuth_rad[col];
      if (options.azimuth_deg && !options.azimuth_deg->Contains(DegFromRad(azimuth_rad))) continue;
      if (!options.pixels.empty() && options.pixels(row, col) == 0) continue;
      if (const double excess = image(row, col) - threshold; excess > 0.0)
        bright.push_back({range_m, azimuth_rad, excess});
    }
  }
  if (bright.empty()) {
    const std::string region = RegionText(options);
    throw DataError("pose search: no pixel of the {} is four standard deviations above the background",
                    region.empty() ? "image" : "region of interest (" + region + ")");
  }
  // A thinned list of centres: the sums change little from one pixel to the next.
  const std::size_t step = std::max<std::size_t>(1, bright.size() / 500);
  double largest = 0.0;
  BrightSpot spot;
  for (std::size_t i = 0; i < bright.size(); i += step) {
    double sum = 0.0;
    double range_m = 0.0;
    double azimuth_rad = 0.0;
    for (const Bright& b : bright) {
      if (std::abs(b.range_m - bright[i].range_m) > 0.5 * extent_m) continue;
      if (std::abs(b.azimuth_rad - bright[i].azimuth_rad) * b.range_m > 0.5 * extent_m) continue;
      sum += b.excess;
      range_m += b.excess * b.range_m;
      azimuth_rad += b.excess * b.azimuth_rad;
    }
    if (sum > largest) {
      largest = sum;
      spot = {range_m / sum, azimuth_rad / sum};
    }
  }
  return spot;
}

PlaceBounds BoundsAround(const BrightSpot& spot, const PolarAxes& axes, double extent_m,
                         const PoseSearchOptions& options) {
  const double reach_m = 0.6 * extent_m;
  const double reach_rad = std::atan2(reach_m, spot.range_m);
  const double elevation_rad = RadFromDeg(options.elevation_limit_deg);
  PlaceBounds bounds{.range_m = {std::max(axes.range_min_m, spot.range_m - reach_m),
                                 std::min(axes.range_max_m, spot.range_m + reach_m)},
                     .azimuth_rad = {std::max(axes.beam_azimuth_rad.front(), spot.azimuth_rad - reach_rad),
                                     std::min(axes.beam_azimuth_rad.back(), spot.azimuth_rad + reach_rad)},
                     .elevation_rad = {-elevation_rad, elevation_rad}};
  if (options.range_m) bounds.range_m = *options.range_m;
  if (options.azimuth_deg)
    bounds.azimuth_rad = {RadFromDeg(options.azimuth_deg->low), RadFromDeg(options.azimuth_deg->high)};
  return bounds;
}

// The part of the image that a target within the bounds can reach.
ImageBox BoxOf(const PlaceBounds& bounds, const PolarAxes& axes, double radius_m) {
  const double margin_rad = std::atan2(radius_m, bounds.range_m.low) + axes.beam_spacing_rad();
  const auto bin = [&](double range_m) { return std::clamp(axes.BinAt(range_m), 0, axes.range_bins - 1); };
  const auto beam = [&](double azimuth_rad) {
    return std::clamp(axes.BeamAt(azimuth_rad), 0, axes.beam_count() - 1);
  };
  ImageBox box{.first_bin = bin(bounds.range_m.low - radius_m),
               .last_bin = bin(bounds.range_m.high + radius_m) + 1,
               .first_beam = beam(bounds.azimuth_rad.low - margin_rad),
               .last_beam = beam(bounds.azimuth_rad.high + margin_rad) + 1};
  // Beams need a neighbour.
  if (box.last_beam - box.first_beam < 2) box.first_beam = std::max(0, box.last_beam - 2);
  if (box.last_beam - box.first_beam < 2) box.last_beam = std::min(axes.beam_count(), box.first_beam + 2);
  return box;
}

Eigen::Quaterniond HalfTurn(int axis) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(kPi, Eigen::Vector3d::Unit(axis)));
}

bool IsMirrorSymmetric(const MeshSymmetry& symmetry) {
  return symmetry.reflection[0] || symmetry.reflection[1] || symmetry.reflection[2];
}

// Angle between two turns of one body, over its own symmetries.
double AngleBetween(const MeshSymmetry& symmetry, const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  if (symmetry.revolution == Revolution::kSphere) return 0.0;
  if (symmetry.revolution == Revolution::kAxis) {
    double cosine = (a * Eigen::Vector3d::UnitX()).dot(b * Eigen::Vector3d::UnitX());
    if (symmetry.half_turn[1]) cosine = std::abs(cosine);
    return std::acos(std::clamp(cosine, -1.0, 1.0));
  }
  double angle_rad = a.angularDistance(b);
  for (int axis = 0; axis < 3; ++axis) {
    if (symmetry.half_turn[axis]) angle_rad = std::min(angle_rad, a.angularDistance(b * HalfTurn(axis)));
  }
  return angle_rad;
}

// Turn of the body that has the mirror image of `rotation` in the plane of the beams. Exact if the body is
// symmetric in a plane across one of its axes.
Eigen::Quaterniond MirroredTurn(const MeshSymmetry& symmetry, const Eigen::Quaterniond& rotation) {
  int across = 2;
  for (int axis = 0; axis < 3; ++axis) {
    if (symmetry.reflection[axis] && !symmetry.reflection[across]) across = axis;
  }
  const auto reflection = [](int axis) {
    Eigen::Matrix3d matrix = Eigen::Matrix3d::Identity();
    matrix(axis, axis) = -1.0;
    return matrix;
  };
  return Eigen::Quaterniond(
      Eigen::Matrix3d(reflection(2) * rotation.toRotationMatrix() * reflection(across)));
}

// Turns of the sweep. Of two turns whose images are equal only one is listed.
std::vector<Eigen::Quaterniond> SweepTurns(const MeshSymmetry& symmetry, const PoseSearchOptions& options) {
  std::vector<Eigen::Quaterniond> turns;
  const double spacing_rad = RadFromDeg(options.start_spacing_deg);
  if (!options.floor_material.empty()) {
    const int headings = static_cast<int>(std::ceil(2.0 * kPi / spacing_rad));
    for (const double tilt_deg : kTiltsDeg) {
      for (int i = 0; i < headings; ++i) {
        turns.push_back(Eigen::AngleAxisd(RadFromDeg(tilt_deg), Eigen::Vector3d::UnitX()) *
                        Eigen::AngleAxisd(2.0 * kPi * i / headings, Eigen::Vector3d::UnitZ()) *
                        symmetry.mesh_from_body.rotation);
      }
    }
    return turns;
  }
  if (symmetry.revolution == Revolution::kSphere) return {Eigen::Quaterniond::Identity()};
  const bool upper_half = IsMirrorSymmetric(symmetry);
  const bool reversible = symmetry.revolution == Revolution::kAxis && symmetry.half_turn[1];
  const int directions = static_cast<int>(std::ceil(4.0 * kPi / (spacing_rad * spacing_rad)));
  const double golden_rad = kPi * (3.0 - std::sqrt(5.0));
  int rolls = 1;
  if (symmetry.revolution == Revolution::kNone) {
    const double all_rad = symmetry.half_turn[0] ? kPi : 2.0 * kPi;
    rolls = static_cast<int>(std::ceil(all_rad / (1.5 * spacing_rad)));
  }
  for (int i = 0; i < directions; ++i) {
    const double pitch_rad = std::asin(1.0 - 2.0 * (i + 0.5) / directions);
    const double yaw_rad = std::remainder(golden_rad * i, 2.0 * kPi);
    if (upper_half && pitch_rad < 0.0) continue;
    if (reversible && (upper_half ? yaw_rad < 0.0 : pitch_rad < 0.0)) continue;
    for (int roll = 0; roll < rolls; ++roll) {
      const double all_rad = symmetry.half_turn[0] ? kPi : 2.0 * kPi;
      turns.push_back(
          TargetPose{.yaw_rad = yaw_rad, .pitch_rad = pitch_rad, .roll_rad = all_rad * roll / rolls}
              .SonarFromTarget()
              .rotation);
    }
  }
  return turns;
}

bool ByCost(const MatchState& a, const MatchState& b) {
  return a.cost < b.cost;
}

// A state without its image, to keep many.
MatchState WithoutImage(MatchState state) {
  state.predicted = {};
  return state;
}

std::string Describe(const MatchState& state, const MeshSymmetry& symmetry) {
  const TargetPose pose = state.AsTargetPose();
  return fmt::format(
      "range {:.3f} m, azimuth {:.2f}, elevation {:.2f}, yaw {:.1f}, pitch {:.1f}{} deg, rms difference "
      "{:.4f}",
      pose.range_m, DegFromRad(pose.azimuth_rad), DegFromRad(pose.elevation_rad), DegFromRad(pose.yaw_rad),
      DegFromRad(pose.pitch_rad),
      symmetry.revolution == Revolution::kNone ? fmt::format(", roll {:.1f}", DegFromRad(pose.roll_rad)) : "",
      std::sqrt(state.cost));
}

class Search {
 public:
  Search(const Scene& target, const SonarModel& sonar, const Water& water, const PolarImage& measured,
         const ParameterSet& parameters, const PoseSearchOptions& options)
      : options_(options) {
    result_.symmetry = FindSymmetry(WithoutFloor(target));
    BrightSpot spot;
    if (options.start) {
      start_ = StateAt(*options.start * result_.symmetry.mesh_from_body);
      spot = {start_->place(0), start_->place(1)};
    } else {
      spot = FindBrightSpot(measured, result_.symmetry.extent_m, options);
    }
    const PlaceBounds bounds = BoundsAround(spot, sonar.axes, result_.symmetry.extent_m, options);
    const ImageBox box = BoxOf(bounds, sonar.axes, result_.symmetry.radius_m);
    spot_ = Eigen::Vector3d(spot.range_m, spot.azimuth_rad, 0.0);
    caster_ = std::make_shared<const sim::RayCaster>(target);
    const auto matcher = [&](int factor) {
      return std::make_unique<PoseMatcher>(caster_, sonar, water, measured, parameters, result_.symmetry,
                                           options, box, bounds, factor);
    };
    coarse_ = matcher(options.coarse_factor);
    fine_ = matcher(1);
  }

  PoseSearchResult Run() {
    std::vector<MatchState> starts = start_ ? std::vector<MatchState>{*start_} : BestOfSweep();
    RefineStarts(starts);
    AddRidge(starts);
    RefineCandidates(starts);
    StateOpenQuestions();
    result_.rays_cast = caster_->rays_cast();
    return std::move(result_);
  }

 private:
  void Say(const std::string& line) const {
    if (!options_.progress) return;
    const std::scoped_lock lock(say_);
    options_.progress(line);
  }

  Scene WithoutFloor(const Scene& scene) const {
    if (options_.floor_material.empty()) return scene;
    Scene body = scene;
    body.triangles.clear();
    body.triangle_material.clear();
    std::vector<int> index(scene.vertices_m.size(), -1);
    body.vertices_m.clear();
    for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
      if (scene.material_names.at(scene.triangle_material[i]) == options_.floor_material) continue;
      Eigen::Vector3i triangle = scene.triangles[i];
      for (int k = 0; k < 3; ++k) {
        int& at = index[triangle(k)];
        if (at < 0) {
          at = static_cast<int>(body.vertices_m.size());
          body.vertices_m.push_back(scene.vertices_m[triangle(k)]);
        }
        triangle(k) = at;
      }
      body.triangles.push_back(triangle);
      body.triangle_material.push_back(scene.triangle_material[i]);
    }
    return body;
  }

  // The best starts of the sweep that differ from each other, best first.
  std::vector<MatchState> BestOfSweep() {
    const std::vector<Eigen::Quaterniond> turns = SweepTurns(result_.symmetry, options_);
    std::vector<MatchState> sweep(turns.size());
    std::atomic<std::size_t> done = 0;
    const std::size_t part = std::max<std::size_t>(1, turns.size() / 5);
    // The bright side is nearer than the middle by up to half the thickness of the target, about a tenth of
    // its length.
    const Eigen::Vector3d place = spot_ + Eigen::Vector3d(0.1 * result_.symmetry.extent_m, 0.0, 0.0);
    Say(fmt::format("trying {} directions of the target", turns.size()));
    tbb::parallel_for(std::size_t{0}, turns.size(), [&](std::size_t i) {
      MatchState state{.place = place, .rotation = turns[i]};
      coarse_->TakeBestGain(state, kGainReachDb);
      coarse_->TakeBestPlace(state);
      coarse_->TakeBestGain(state, 10.0);
      sweep[i] = WithoutImage(std::move(state));
      if (const std::size_t count = ++done; count % part == 0 && count < turns.size())
        Say(fmt::format("tried {} of {} directions", count, turns.size()));
    });
    std::stable_sort(sweep.begin(), sweep.end(), ByCost);
    std::vector<MatchState> best;
    const double same_rad = kSameStartShare * RadFromDeg(options_.start_spacing_deg);
    for (MatchState& state : sweep) {
      if (static_cast<int>(best.size()) == options_.refined_starts) break;
      if (!IsKnown(best, state, same_rad)) best.push_back(std::move(state));
    }
    return best;
  }

  bool IsKnown(const std::vector<MatchState>& states, const MatchState& state, double same_rad) const {
    return std::any_of(states.begin(), states.end(), [&](const MatchState& other) {
      return AngleBetween(result_.symmetry, other.rotation, state.rotation) < same_rad;
    });
  }

  void RefineStarts(std::vector<MatchState>& starts) {
    for (std::size_t i = 0; i < starts.size(); ++i) {
      if (start_) coarse_->TakeBestGain(starts[i], kGainReachDb);
      coarse_->Refine(starts[i], options_.max_iterations);
      Say(fmt::format("start {} of {}: {}", i + 1, starts.size(), Describe(starts[i], result_.symmetry)));
      starts[i] = WithoutImage(std::move(starts[i]));
    }
    std::stable_sort(starts.begin(), starts.end(), ByCost);
    for (const MatchState& start : starts)
      result_.starts.push_back(CandidateOf(start, CandidateKind::kStart));
  }

  // Refines the best start at fixed elevations. A neighbour on the ridge may be in a better valley than the
  // starts.
  void AddRidge(std::vector<MatchState>& starts) {
    const MatchState from = starts.front();
    for (const double elevation_deg : options_.ridge_elevations_deg) {
      if (std::abs(elevation_deg) > options_.elevation_limit_deg) continue;
      MatchState held = from;
      held.place(2) = RadFromDeg(elevation_deg);
      coarse_->Refine(held, kRidgeIterations, /*hold_elevation=*/true);
      held = WithoutImage(std::move(held));
      result_.ridge.push_back(CandidateOf(held, CandidateKind::kStart));
      if (held.cost < starts.front().cost) starts.insert(starts.begin(), std::move(held));
    }
    std::stable_sort(starts.begin(), starts.end(), ByCost);
  }

  void RefineCandidates(const std::vector<MatchState>& starts) {
    std::vector<std::pair<CandidateKind, MatchState>> refined;
    const auto add = [&](CandidateKind kind, MatchState state) {
      fine_->Refine(state, options_.max_iterations);
      Say(fmt::format("{}: {}", NameOf(kind), Describe(state, result_.symmetry)));
      for (const auto& known : refined) {
        if (IsKnown({known.second}, state, RadFromDeg(kSameTurnDeg))) return;
      }
      refined.emplace_back(kind, std::move(state));
    };
    std::vector<MatchState> different;
    for (const MatchState& start : starts) {
      if (static_cast<int>(different.size()) == options_.max_candidates) break;
      // A start that fits far worse cannot become the best.
      if (start.cost > 1.5 * starts.front().cost) break;
      if (!IsKnown(different, start, RadFromDeg(kSameTurnDeg))) different.push_back(start);
    }
    for (const MatchState& start : different) add(CandidateKind::kStart, start);
    const auto by_cost = [](const auto& a, const auto& b) { return a.second.cost < b.second.cost; };
    std::stable_sort(refined.begin(), refined.end(), by_cost);
    const MatchState best = refined.front().second;
    const std::vector<Eigen::Quaterniond> reversals =
        options_.relatives ? Reversals() : std::vector<Eigen::Quaterniond>();
    for (const Eigen::Quaterniond& reversal : reversals) {
      MatchState reversed = WithoutImage(best);
      reversed.rotation = best.rotation * reversal;
      coarse_->Refine(reversed, options_.max_iterations);
      add(CandidateKind::kReversed, std::move(reversed));
    }
    std::stable_sort(refined.begin(), refined.end(), by_cost);
    // With a floor, the mirror image would be a sonar below it.
    if (options_.relatives && options_.floor_material.empty()) AddMirrored(refined, add);
    std::stable_sort(refined.begin(), refined.end(), by_cost);
    for (const auto& [kind, state] : refined) {
      PoseCandidate candidate = CandidateOf(state, kind);
      const PoseMatcher::Comparison comparison = fine_->Compare(refined.front().second, state);
      candidate.worse_by_nats = comparison.nats;
      candidate.worse_by_sigmas = comparison.sigmas;
      candidate.at_bounds = fine_->AtBounds(state);
      result_.candidates.push_back(std::move(candidate));
    }
    NameKinds();
  }

  // Turns of the body that reverse its length. On a floor, half a turn about the vertical.
  std::vector<Eigen::Quaterniond> Reversals() const {
    const MeshSymmetry& symmetry = result_.symmetry;
    if (!options_.floor_material.empty()) {
      const Eigen::Quaterniond& mesh_from_body = symmetry.mesh_from_body.rotation;
      return {mesh_from_body.conjugate() * HalfTurn(2) * mesh_from_body};
    }
    if (symmetry.revolution == Revolution::kSphere || symmetry.half_turn[1] || symmetry.half_turn[2])
      return {};
    if (symmetry.revolution == Revolution::kAxis) return {HalfTurn(1)};
    return {HalfTurn(1), HalfTurn(2)};
  }

  template <typename Add>
  void AddMirrored(std::vector<std::pair<CandidateKind, MatchState>>& refined, const Add& add) {
    MatchState mirrored = WithoutImage(refined.front().second);
    mirrored.place(2) = -mirrored.place(2);
    mirrored.rotation = MirroredTurn(result_.symmetry, mirrored.rotation);
    if (!IsMirrorSymmetric(result_.symmetry)) {
      add(CandidateKind::kMirrored, std::move(mirrored));
      return;
    }
    // It may be the best pose itself, or one that a start led to.
    const bool known = std::any_of(refined.begin(), refined.end(), [&](const auto& other) {
      const bool is_best = &other == &refined.front();
      return AngleBetween(result_.symmetry, other.second.rotation, mirrored.rotation) <
                 RadFromDeg(is_best ? 2.0 : kSameTurnDeg) &&
             (!is_best || std::abs(mirrored.place(2)) < RadFromDeg(1.0));
    });
    if (known) return;
    fine_->Evaluate(mirrored);
    refined.emplace_back(CandidateKind::kMirrored, std::move(mirrored));
  }

  // Names candidates after their relation to the best one, whatever they were started from.
  void NameKinds() {
    const PoseCandidate& best = result_.candidates.front();
    const Eigen::Quaterniond body = result_.symmetry.mesh_from_body.rotation;
    const Eigen::Quaterniond of_best = best.sonar_from_target.rotation * body;
    const auto is_near = [&](const PoseCandidate& candidate, const Eigen::Quaterniond& turn) {
      constexpr double kNearDeg = 25.0;
      return AngleBetween(result_.symmetry, candidate.sonar_from_target.rotation * body, turn) <
             RadFromDeg(kNearDeg);
    };
    for (PoseCandidate& candidate : result_.candidates) {
      candidate.kind = CandidateKind::kStart;
      if (&candidate == &best) continue;
      if (is_near(candidate, of_best * HalfTurn(1)) || is_near(candidate, of_best * HalfTurn(2))) {
        candidate.kind = CandidateKind::kReversed;
      } else if (options_.floor_material.empty() &&
                 is_near(candidate, MirroredTurn(result_.symmetry, of_best))) {
        candidate.kind = CandidateKind::kMirrored;
      }
    }
  }

  PoseCandidate CandidateOf(const MatchState& state, CandidateKind kind) const {
    return {.kind = kind,
            .sonar_from_target = state.SonarFromBody() * result_.symmetry.mesh_from_body.Inverse(),
            .pose = state.AsTargetPose(),
            .gain_db = state.gain_db,
            .floor_gain_db = state.floor_gain_db,
            .cost = state.cost};
  }

  void StateOpenQuestions() {
    std::vector<std::string>& open = result_.open;
    const PoseCandidate& best = result_.best();
    for (std::size_t i = 1; i < result_.candidates.size(); ++i) {
      const PoseCandidate& other = result_.candidates[i];
      if (!other.ExplainsAsWell()) continue;
      open.push_back(
          fmt::format("{} (candidate {}) explains the picture as well: rms difference {:.5f} against {:.5f}, "
                      "log-likelihood lower by {:.1f} nats, {:.1f} standard deviations",
                      NameOf(other.kind), i + 1, std::sqrt(other.cost), std::sqrt(best.cost),
                      other.worse_by_nats, other.worse_by_sigmas));
    }
    if (result_.ridge.size() > 1) {
      double lowest = result_.ridge.front().cost;
      for (const PoseCandidate& held : result_.ridge) lowest = std::min(lowest, held.cost);
      std::string costs;
      for (const PoseCandidate& held : result_.ridge) {
        costs +=
            fmt::format("{}{:+.0f} deg {:+.1f} %", costs.empty() ? "" : ", ",
                        DegFromRad(held.pose.elevation_rad), 100.0 * (std::sqrt(held.cost / lowest) - 1.0));
      }
      open.push_back("elevation (height): with it fixed and the rest refitted, the rms difference grows by " +
                     costs);
    }
    const MeshSymmetry& symmetry = result_.symmetry;
    if (!options_.floor_material.empty()) return;
    if (symmetry.revolution == Revolution::kAxis)
      open.emplace_back("roll: the target is a body of revolution, its roll is not visible");
    if (symmetry.revolution == Revolution::kSphere)
      open.emplace_back("orientation: the target is a sphere, its turn is not visible");
    if (symmetry.revolution != Revolution::kNone) return;
    for (int axis = 0; axis < 3; ++axis) {
      if (symmetry.half_turn[axis]) {
        open.push_back(fmt::format("half a turn about the target's {} axis: the mesh is the same after it",
                                   axis == 0   ? "longest"
                                   : axis == 1 ? "second longest"
                                               : "shortest"));
      }
    }
  }

  const PoseSearchOptions& options_;
  mutable std::mutex say_;
  std::optional<MatchState> start_;
  Eigen::Vector3d spot_;
  std::shared_ptr<const sim::RayCaster> caster_;
  std::unique_ptr<PoseMatcher> coarse_;
  std::unique_ptr<PoseMatcher> fine_;
  PoseSearchResult result_;
};

}  // namespace

std::string_view NameOf(CandidateKind kind) {
  switch (kind) {
    case CandidateKind::kMirrored:
      return "the mirror image in the plane of the beams";
    case CandidateKind::kReversed:
      return "the reversed target";
    default:
      return "another pose";
  }
}

void PoseSearchOptions::Check() const {
  const auto at_least = [](const char* name, double value, double limit) {
    if (!(value >= limit)) throw DataError("pose search: {} {}, expected at least {}", name, value, limit);
  };
  at_least("smooth_bins", smooth_bins, 0.0);
  at_least("smooth_beams", smooth_beams, 0.0);
  at_least("start_spacing_deg", start_spacing_deg, 2.0);
  at_least("refined_starts", refined_starts, 1);
  at_least("max_candidates", max_candidates, 1);
  at_least("coarse_factor", coarse_factor, 1);
  at_least("cols_per_beam", cols_per_beam, 1);
  at_least("ray_height_deg", ray_height_deg, 1e-3);
  at_least("elevation_span_deg", elevation_span_deg, ray_height_deg);
  at_least("elevation_limit_deg", elevation_limit_deg, 0.0);
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
  return Search(target, sonar, water, measured, parameters, options).Run();
}

}  // namespace sonarcal::calib
