#include "sim/ghosts/ghost_trace.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/math/random.h"
#include "core/types/error.h"
#include "sim/physics/beam_and_pulse.h"
#include "sim/physics/beam_pattern.h"
#include "sim/rays/row_math/directions.h"

namespace sonarcal::sim {
namespace {

constexpr std::uint32_t kSpotsStream = 0x4000;
// Distance of a ray's start from the surface it leaves, relative to the largest coordinate: about ten
// rounding errors.
constexpr double kClearance = 1e-5;

struct Tracing {
  const RayCaster& caster;
  const MirrorSurface& mirrors;
  const RayFan& fan;
  const GhostOptions& options;
  Eigen::Vector3d sonar_m;
  Eigen::Matrix3d world_from_sonar;
  double clearance_m = 0.0;
  double leftmost_rad = 0.0;  // azimuth limits of the fan
  double rightmost_rad = 0.0;
};

// Reflected bundle, and the ray that it started as.
struct Seen {
  RayBundle bundle;
  int triangle = 0;  // triangle of the last reflection
  int col = 0;
  float solid_angle_sr = 0.0F;
  GhostLeg leg;  // azimuth, elevation and mirrors so far
};

// Patch at the end of a leg.
struct Patch {
  Eigen::Vector3d point_m;
  Eigen::Vector3d normal;  // on the side that the leg comes from
  Eigen::Vector3d back;    // along the leg, unit length
  int col = 0;
  int triangle = 0;
  int mirror_triangle = 0;  // triangle of the leg's last reflection
  float solid_angle_sr = 0.0F;
  GhostLeg leg;
};

// Angles between directions and normals, computed together. Single precision is exact to a few rounding
// errors at every angle, because sine and cosine are given.
class AngleBatch {
 public:
  explicit AngleBatch(std::size_t max_count) {
    sine_.reserve(max_count);
    cosine_.reserve(max_count);
  }
  void Add(const Eigen::Vector3d& direction, const Eigen::Vector3d& normal) {
    sine_.push_back(static_cast<float>(direction.cross(normal).norm()));
    cosine_.push_back(static_cast<float>(std::abs(direction.dot(normal))));
  }
  // In the order of Add.
  std::vector<float> AnglesRad() const {
    std::vector<float> angle_rad(sine_.size());
    row_math::Angles(sine_.data(), cosine_.data(), static_cast<int>(sine_.size()), angle_rad.data());
    return angle_rad;
  }

 private:
  std::vector<float> sine_;
  std::vector<float> cosine_;
};

// Adds the bundles of a fan's row that hit a mirror, after the reflection.
void AddFirstReflections(const Tracing& tracing, const FanHits& hits, int row, std::vector<Seen>& seen) {
  const RayFan& fan = tracing.fan;
  std::array<std::vector<float>, 3> directions;
  for (std::vector<float>& component : directions) component.resize(fan.cols());
  fan.RowDirections(row, Eigen::Matrix3f::Identity(), directions[0].data(), directions[1].data(),
                    directions[2].data());
  for (int col = 0; col < fan.cols(); ++col) {
    const std::size_t ray = static_cast<std::size_t>(row) * fan.cols() + col;
    const int triangle = hits.triangle[ray];
    if (triangle < 0 || !(hits.range_m[ray] > 0.0F) || !tracing.mirrors.Reflects(triangle)) continue;
    const Eigen::Vector3d direction(directions[0][col], directions[1][col], directions[2][col]);
    const double range_m = hits.range_m[ray];
    Seen begun{RayBundle(tracing.sonar_m, tracing.world_from_sonar * direction, tracing.mirrors.bends()),
               triangle,
               col,
               static_cast<float>(fan.SolidAngleSr(row, col)),
               {}};
    begun.leg.azimuth_rad = static_cast<float>(fan.AzimuthRad(row, col));
    begun.leg.elevation_rad = static_cast<float>(fan.ElevationRad(row, col));
    begun.leg.mirror[0] = tracing.caster.TriangleMaterial(triangle);
    begun.bundle = tracing.mirrors.Reflected(begun.bundle, triangle, range_m);
    seen.push_back(begun);
  }
}

// As AddFirstReflections, for rays at random spots of the row's cells.
void AddFirstReflectionsAtSpots(const Tracing& tracing, int row, std::vector<Seen>& seen) {
  const RayFan& fan = tracing.fan;
  const CounterRandom spots(*tracing.options.spots_seed, kSpotsStream);
  std::vector<Eigen::Vector3d> directions;
  FreeRays rays;
  for (int col = 0; col < fan.cols(); ++col) {
    const auto [u, v] = spots.Uniform2(static_cast<std::uint64_t>(row) * fan.cols() + col);
    directions.push_back(fan.DirectionWithin(row, col, u - 0.5, v - 0.5));
    rays.Add(tracing.sonar_m, tracing.world_from_sonar * directions.back(),
             2.0 * tracing.options.range_max_m);
  }
  const FanHits hits = tracing.caster.FirstIntersections(rays);
  for (int col = 0; col < fan.cols(); ++col) {
    const int triangle = hits.triangle[col];
    if (triangle < 0 || !(hits.range_m[col] > 0.0F) || !tracing.mirrors.Reflects(triangle)) continue;
    const Eigen::Vector3d& direction = directions[col];
    Seen begun{RayBundle(tracing.sonar_m, tracing.world_from_sonar * direction, tracing.mirrors.bends()),
               triangle,
               col,
               static_cast<float>(fan.SolidAngleSr(row, col)),
               {}};
    begun.leg.azimuth_rad = static_cast<float>(std::atan2(direction.x(), direction.y()));
    begun.leg.elevation_rad = static_cast<float>(std::asin(std::clamp(direction.z(), -1.0, 1.0)));
    begun.leg.mirror[0] = tracing.caster.TriangleMaterial(triangle);
    begun.bundle = tracing.mirrors.Reflected(begun.bundle, triangle, hits.range_m[col]);
    seen.push_back(begun);
  }
}

// Traces the bundles to their next intersection. Returns the patches; bundles that hit another mirror are
// reflected there and replace `seen`.
std::vector<Patch> PatchesSeen(const Tracing& tracing, int level, std::vector<Seen>& seen) {
  FreeRays rays;
  rays.Reserve(seen.size());
  for (const Seen& one : seen) {
    const RayBundle& bundle = one.bundle;
    // The other leg also uses part of the path, but its length is not known yet.
    const double left_m = 2.0 * tracing.options.range_max_m - bundle.length_m;
    const Eigen::Vector3d normal = tracing.caster.TriangleNormal(one.triangle).cast<double>();
    const double aside_m = std::copysign(tracing.clearance_m, normal.dot(bundle.direction));
    rays.Add(bundle.point_m + aside_m * normal, bundle.direction, std::max(left_m, 0.0));
  }
  const FanHits hits = tracing.caster.FirstIntersections(rays);
  std::vector<Patch> patches;
  patches.reserve(seen.size());
  AngleBatch incidence(seen.size());
  std::vector<Seen> further;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const int triangle = hits.triangle[i];
    const double range_m = hits.range_m[i];
    if (triangle < 0 || !(range_m > 0.0)) continue;
    const Seen& one = seen[i];
    Patch patch{.point_m = one.bundle.At(range_m),
                .normal = tracing.caster.TriangleNormal(triangle).cast<double>(),
                .back = -one.bundle.direction,
                .col = one.col,
                .triangle = triangle,
                .mirror_triangle = one.triangle,
                .solid_angle_sr = one.solid_angle_sr,
                .leg = one.leg};
    if (patch.normal.dot(one.bundle.direction) > 0.0) patch.normal = -patch.normal;
    patch.leg.length_m = static_cast<float>(one.bundle.length_m + range_m);
    patch.leg.spreading_m = static_cast<float>(one.bundle.SpreadingM(range_m));
    incidence.Add(one.bundle.direction, patch.normal);
    patches.push_back(patch);
    if (level < tracing.options.order && tracing.mirrors.Reflects(triangle)) {
      Seen next{tracing.mirrors.Reflected(one.bundle, triangle, range_m), triangle, one.col,
                one.solid_angle_sr, one.leg};
      next.leg.mirror[level] = tracing.caster.TriangleMaterial(triangle);
      further.push_back(next);
    }
  }
  seen = std::move(further);
  const std::vector<float> incidence_rad = incidence.AnglesRad();
  for (std::size_t i = 0; i < patches.size(); ++i) patches[i].leg.incidence_rad = incidence_rad[i];
  return patches;
}

bool IsKept(const GhostOptions& options, float range_m) {
  return range_m > 0.0F && range_m >= options.range_min_m && range_m < options.range_max_m;
}

bool IsHeard(const GhostOptions& options, const GhostLeg& leg) {
  return leg.azimuth_rad >= options.heard_left_rad && leg.azimuth_rad <= options.heard_right_rad;
}

// True if the list includes the echo out by `leg` (within the transmitted azimuths) and back by `other`, or
// the reverse.
bool IsWanted(const Tracing& tracing, const GhostLeg& leg, const GhostLeg& other) {
  return leg.azimuth_rad >= tracing.leftmost_rad && leg.azimuth_rad <= tracing.rightmost_rad &&
         (IsHeard(tracing.options, leg) || IsHeard(tracing.options, other)) &&
         IsKept(tracing.options, 0.5F * (leg.length_m + other.length_m));
}

// Legs that leave the sonar in given directions, possibly by flat mirrors. Their angles are computed
// together.
class LegBatch {
 public:
  LegBatch(const Tracing& tracing, std::size_t max_count)
      : sonar_from_world_(tracing.world_from_sonar.transpose()) {
    length_m_.reserve(max_count);
    for (std::vector<float>& component : direction_) component.reserve(max_count);
  }
  void Add(double length_m, const Eigen::Vector3d& from_sonar) {
    const Eigen::Vector3d in_sonar = sonar_from_world_ * from_sonar;
    length_m_.push_back(static_cast<float>(length_m));
    for (int i = 0; i < 3; ++i) direction_[i].push_back(static_cast<float>(in_sonar[i]));
  }
  // In the order of Add. Incidence and mirrors are not set.
  std::vector<GhostLeg> Legs() const {
    const std::size_t count = length_m_.size();
    std::vector<float> azimuth_rad(count);
    std::vector<float> elevation_rad(count);
    row_math::Bearings(direction_[0].data(), direction_[1].data(), direction_[2].data(),
                       static_cast<int>(count), azimuth_rad.data(), elevation_rad.data());
    std::vector<GhostLeg> legs(count);
    for (std::size_t i = 0; i < count; ++i) {
      legs[i].length_m = length_m_[i];
      legs[i].spreading_m = length_m_[i];
      legs[i].azimuth_rad = azimuth_rad[i];
      legs[i].elevation_rad = elevation_rad[i];
    }
    return legs;
  }

 private:
  Eigen::Matrix3d sonar_from_world_;
  std::vector<float> length_m_;
  std::array<std::vector<float>, 3> direction_;
};

// Straight legs of patches, in their order. Nothing for a patch that is occluded or whose echo lies outside
// the range window.
std::vector<std::optional<GhostLeg>> StraightLegs(const Tracing& tracing, const std::vector<Patch>& patches) {
  struct Candidate {
    std::size_t patch;
    Eigen::Vector3d start_m;
    Eigen::Vector3d back;
    double length_m;
  };
  std::vector<Candidate> candidates;
  candidates.reserve(patches.size());
  LegBatch batch(tracing, patches.size());
  for (std::size_t i = 0; i < patches.size(); ++i) {
    const Patch& patch = patches[i];
    const Eigen::Vector3d start_m = patch.point_m + tracing.clearance_m * patch.normal;
    const Eigen::Vector3d to_sonar_m = tracing.sonar_m - start_m;
    if (!(to_sonar_m.dot(patch.normal) > 0.0)) continue;
    const double length_m = to_sonar_m.norm();
    const Eigen::Vector3d back = to_sonar_m / length_m;
    batch.Add(length_m, -back);
    candidates.push_back({i, start_m, back, length_m});
  }
  const std::vector<GhostLeg> straight = batch.Legs();
  std::vector<std::optional<GhostLeg>> legs(patches.size());
  std::vector<std::size_t> of_ray;
  of_ray.reserve(candidates.size());
  FreeRays rays;
  rays.Reserve(candidates.size());
  AngleBatch incidence(candidates.size());
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const auto& [idx, start_m, back, length_m] = candidates[i];
    if (!IsWanted(tracing, straight[i], patches[idx].leg)) continue;
    legs[idx] = straight[i];
    of_ray.push_back(idx);
    incidence.Add(back, patches[idx].normal);
    rays.Add(start_m, back, length_m - tracing.clearance_m);
  }
  const std::vector<float> incidence_rad = incidence.AnglesRad();
  const std::vector<char> occluded = tracing.caster.IsOccluded(rays);
  for (std::size_t ray = 0; ray < of_ray.size(); ++ray) {
    std::optional<GhostLeg>& leg = legs[of_ray[ray]];
    leg->incidence_rad = incidence_rad[ray];
    if (occluded[ray] != 0) leg.reset();
  }
  return legs;
}

GhostEcho EchoOf(const Tracing& tracing, const Patch& patch) {
  return {.material = tracing.caster.TriangleMaterial(patch.triangle),
          .both_ways = false,
          .solid_angle_sr = patch.solid_angle_sr,
          .tilt_rad = patch.leg.incidence_rad,
          .leg = patch.leg,
          .other = patch.leg};
}

void AddEchoes(const Tracing& tracing, const std::vector<Patch>& patches, std::vector<GhostEcho>& echoes) {
  echoes.reserve(echoes.size() + 2 * patches.size());
  const std::vector<std::optional<GhostLeg>> straight = StraightLegs(tracing, patches);
  AngleBatch tilt(patches.size());
  std::vector<std::size_t> both_ways;
  both_ways.reserve(patches.size());
  for (std::size_t i = 0; i < patches.size(); ++i) {
    const Patch& patch = patches[i];
    GhostEcho echo = EchoOf(tracing, patch);
    // An echo by two mirrors on both legs is of third order or higher.
    if (patch.leg.mirror[1] == kNoMirror && IsKept(tracing.options, echo.range_m()) &&
        IsHeard(tracing.options, echo.leg)) {
      echoes.push_back(echo);
    }
    if (!straight[i]) continue;
    echo.both_ways = true;
    echo.other = *straight[i];
    const Eigen::Vector3d straight_back = (tracing.sonar_m - patch.point_m).normalized();
    tilt.Add(patch.back + straight_back, patch.normal);
    both_ways.push_back(echoes.size());
    echoes.push_back(echo);
  }
  const std::vector<float> tilt_rad = tilt.AnglesRad();
  for (std::size_t i = 0; i < both_ways.size(); ++i) echoes[both_ways[i]].tilt_rad = tilt_rad[i];
}

// Adds echoes that go out by the mirror that showed a patch and back by one flat mirror, and the reverse. The
// second leg goes by the sonar's image behind that mirror. If both mirrors are flat, only the one with the
// lower plane index may show the patch, so no pair occurs twice.
void AddEchoesByPlane(const Tracing& tracing, const std::vector<Patch>& patches, std::int32_t plane_idx,
                      std::vector<GhostEcho>& echoes) {
  struct Candidate {
    const Patch* patch;
    Eigen::Vector3d start_m;
    Eigen::Vector3d back;      // from the patch to the image
    Eigen::Vector3d mirror_m;  // intersection of the path with the mirror's plane
    double to_mirror_m;
    GhostLeg leg = {};
  };
  const MirrorSurface::Plane& plane = tracing.mirrors.planes()[plane_idx];
  const Eigen::Vector3d image_m = plane.ImageOf(tracing.sonar_m);
  std::vector<Candidate> candidates;
  LegBatch batch(tracing, patches.size());
  for (const Patch& patch : patches) {
    if (tracing.mirrors.PlaneOf(patch.mirror_triangle) >= plane_idx) continue;
    const Eigen::Vector3d start_m = patch.point_m + tracing.clearance_m * patch.normal;
    const Eigen::Vector3d to_image_m = image_m - start_m;
    const double length_m = to_image_m.norm();
    const Eigen::Vector3d back = to_image_m / length_m;
    const double share = (plane.offset_m - plane.normal.dot(start_m)) / plane.normal.dot(to_image_m);
    if (!(back.dot(patch.normal) > 0.0) || !(share > 0.0 && share < 1.0)) continue;
    const Eigen::Vector3d mirror_m = start_m + share * to_image_m;
    batch.Add(length_m, (mirror_m - tracing.sonar_m).normalized());
    candidates.push_back({&patch, start_m, back, mirror_m, share * length_m});
  }
  const std::vector<GhostLeg> legs = batch.Legs();
  for (std::size_t i = 0; i < candidates.size(); ++i) candidates[i].leg = legs[i];
  std::erase_if(candidates, [&](const Candidate& candidate) {
    return !IsWanted(tracing, candidate.leg, candidate.patch->leg);
  });
  AngleBatch incidence(candidates.size());
  FreeRays to_mirror;
  to_mirror.Reserve(candidates.size());
  for (const Candidate& candidate : candidates) {
    incidence.Add(candidate.back, candidate.patch->normal);
    to_mirror.Add(candidate.start_m, candidate.back, candidate.to_mirror_m + 10.0 * tracing.clearance_m);
  }
  // The first intersection must be on the mirror, and the rest of the path must be free.
  const FanHits hits = tracing.caster.FirstIntersections(to_mirror);
  const std::vector<float> incidence_rad = incidence.AnglesRad();
  std::vector<std::size_t> met;
  FreeRays to_sonar;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (hits.triangle[i] < 0 || tracing.mirrors.PlaneOf(hits.triangle[i]) != plane_idx) continue;
    const Candidate& candidate = candidates[i];
    const Eigen::Vector3d rest_m = tracing.sonar_m - candidate.mirror_m;
    const double aside_m = std::copysign(tracing.clearance_m, plane.normal.dot(rest_m));
    candidates[i].leg.incidence_rad = incidence_rad[i];
    candidates[i].leg.mirror[0] = tracing.caster.TriangleMaterial(hits.triangle[i]);
    met.push_back(i);
    to_sonar.Add(candidate.mirror_m + aside_m * plane.normal, rest_m.normalized(),
                 rest_m.norm() - 2.0 * tracing.clearance_m);
  }
  const std::vector<char> occluded = tracing.caster.IsOccluded(to_sonar);
  const std::size_t first = echoes.size();
  AngleBatch tilt(met.size());
  for (std::size_t ray = 0; ray < met.size(); ++ray) {
    if (occluded[ray] != 0) continue;
    const Candidate& candidate = candidates[met[ray]];
    GhostEcho echo = EchoOf(tracing, *candidate.patch);
    echo.both_ways = true;
    echo.other = candidate.leg;
    tilt.Add(candidate.patch->back + candidate.back, candidate.patch->normal);
    echoes.push_back(echo);
  }
  const std::vector<float> tilt_rad = tilt.AnglesRad();
  for (std::size_t i = 0; i < tilt_rad.size(); ++i) echoes[first + i].tilt_rad = tilt_rad[i];
}

std::vector<GhostEcho> EchoesOfRows(const Tracing& tracing, const FanHits& hits, int begin, int end) {
  std::vector<GhostEcho> echoes;
  std::vector<Seen> seen;
  seen.reserve(static_cast<std::size_t>(end - begin) * tracing.fan.cols());
  for (int row = begin; row < end; ++row) {
    if (tracing.options.spots_seed) {
      AddFirstReflectionsAtSpots(tracing, row, seen);
    } else {
      AddFirstReflections(tracing, hits, row, seen);
    }
  }
  for (int level = 1; level <= tracing.options.order && !seen.empty(); ++level) {
    const std::vector<Patch> patches = PatchesSeen(tracing, level, seen);
    AddEchoes(tracing, patches, echoes);
    if (level > 1 || tracing.options.order < 2) continue;
    for (std::size_t plane = 0; plane < tracing.mirrors.planes().size(); ++plane) {
      AddEchoesByPlane(tracing, patches, static_cast<std::int32_t>(plane), echoes);
    }
  }
  return echoes;
}

}  // namespace

void GhostOptions::Check() const {
  if (order != 1 && order != 2) throw DataError("ghosts: order {}, expected 1 or 2", order);
}

std::vector<char> ReflectingMaterials(const std::vector<std::string>& material_names,
                                      const ParameterSet& parameters) {
  std::vector<char> reflects;
  for (const std::string& name : material_names) {
    reflects.push_back(parameters.mirrors.contains(name) ? 1 : 0);
  }
  return reflects;
}

RayFanOptions GhostFanOptions(const RayFanOptions& fan, const SonarModel& sonar, const BeamParameters& beam) {
  constexpr double kWidestMarginDeg = 60.0;  // limit of RayFanOptions
  RayFanOptions options = fan;
  if (fan.sampling == Sampling::kBeams) {
    options.cols = std::max(fan.cols / 4, 1);
    options.rows = std::max(fan.rows / 3, 1);
  }
  if (beam.mirror_lobes == MirrorLobes::kMain) {
    const double main_lobe_deg = 2.0 * DegFromRad(MainLobeEndRad(ElevationResponseOf(sonar, beam)));
    options.elevation_span_deg = std::min(options.elevation_span_deg, main_lobe_deg);
  }
  const PolarAxes& axes = sonar.axes;
  const double edge_deg = DegFromRad(std::min(-axes.BeamEdgeRad(0), axes.BeamEdgeRad(axes.beam_count())));
  options.azimuth_margin_deg =
      std::clamp(beam.transmit_end_deg - edge_deg, fan.azimuth_margin_deg, kWidestMarginDeg);
  return options;
}

std::pair<double, double> AzimuthsRad(const RayFan& fan) {
  const int last = fan.cols() - 1;
  const auto half_width = [&](int col, int beside) {
    return 0.5 * std::abs(fan.AzimuthRad(col) - fan.AzimuthRad(beside));
  };
  return {fan.AzimuthRad(0) - half_width(0, std::min(1, last)),
          fan.AzimuthRad(last) + half_width(last, std::max(last - 1, 0))};
}

GhostList TraceGhosts(const RayCaster& caster, const MirrorSurface& mirrors, const RayFan& fan,
                      const Pose& world_from_sonar, const GhostOptions& options) {
  options.Check();
  Tracing tracing{.caster = caster,
                  .mirrors = mirrors,
                  .fan = fan,
                  .options = options,
                  .sonar_m = world_from_sonar.position_m,
                  .world_from_sonar = world_from_sonar.rotation.toRotationMatrix()};
  tracing.clearance_m =
      kClearance * std::max(mirrors.largest_coordinate_m(), tracing.sonar_m.cwiseAbs().maxCoeff());
  std::tie(tracing.leftmost_rad, tracing.rightmost_rad) = AzimuthsRad(fan);

  FanHits hits;
  if (!options.spots_seed) hits = caster.Cast(fan, world_from_sonar, 2.0 * options.range_max_m);
  // All threads allocate from one pool. A few rows together need fewer allocations and still fit the cache.
  constexpr int kRowsTogether = 4;
  std::vector<std::vector<GhostEcho>> parts((fan.rows() + kRowsTogether - 1) / kRowsTogether);
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t part) {
    const int begin = static_cast<int>(part) * kRowsTogether;
    parts[part] = EchoesOfRows(tracing, hits, begin, std::min(begin + kRowsTogether, fan.rows()));
  });
  GhostList list;
  list.material_names = caster.material_names();
  std::size_t count = 0;
  for (const auto& part : parts) count += part.size();
  list.echoes.reserve(count);
  for (const auto& part : parts) list.echoes.insert(list.echoes.end(), part.begin(), part.end());
  return list;
}

}  // namespace sonarcal::sim
