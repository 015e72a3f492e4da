// Converts ray hits into echoes. Echoes hold geometry only, so a scene is traced once and shaded many times.
#pragma once

#include <cstdint>
#include <type_traits>
#include <vector>

#include "core/types/words.h"
#include "sim/rays/ray_caster.h"

namespace sonarcal::sim {

// Source of the surface normal at a hit.
//
//   geometric  Normal of the mesh.
//   depth      Normal of the point cloud (Park 2024 Eq. 8): the cross product of differences to the rays
//              `step` columns right and rows down. If one of those missed, or lies across a jump in range of
//              more than `jump_ratio`, the ray on the other side is used. If that fails too, the normal
//              of the mesh is used.
enum class NormalSource { kGeometric, kDepth };
constexpr auto WordsOf(std::type_identity<NormalSource>) {
  return Words<NormalSource, 2>{{{"geometric", NormalSource::kGeometric}, {"depth", NormalSource::kDepth}}};
}

struct TraceOptions {
  NormalSource normals = NormalSource::kGeometric;
  int step = 2;              // k of Eq. 8: 2 or 3 in the paper; 1..16
  double jump_ratio = 0.05;  // fraction of the range

  void Check() const;
};

// Echoes of one frame: one per ray that hits a surface within the sonar's range window. Structure of arrays,
// all of one length, in the order of the rays.
struct EchoList {
  std::vector<std::uint32_t> ray;  // index in the fan
  std::vector<std::uint16_t> material;
  std::vector<float> range_m;
  std::vector<float> azimuth_rad;
  std::vector<float> elevation_rad;
  std::vector<float> incidence_rad;   // angle between ray and normal, 0 .. pi/2
  std::vector<float> solid_angle_sr;  // solid angle that the ray represents

  // Properties of the traced fan: number of grid columns, beam of each column, number of rays per beam.
  int cols = 0;
  std::vector<int> beam_of_column;
  std::vector<int> rays_per_beam;
  std::vector<float> weight;  // RayFan::RowWeights of each echo; empty: all 1
  std::vector<std::string> material_names;

  std::size_t size() const { return range_m.size(); }
  double Weight(std::size_t echo) const { return weight.empty() ? 1.0 : double{weight[echo]}; }
  int Beam(std::size_t echo) const { return beam_of_column[ray[echo] % cols]; }
};

// List without echoes, with the properties of a fan and the materials of a scene.
EchoList EmptyEchoList(const RayFan& fan, const std::vector<std::string>& material_names);

// True if a hit at this range gives an echo. A ray that starts on a surface hits it at range 0, where the
// transmission loss is undefined.
inline bool IsEcho(float range_m, const PolarAxes& axes) {
  return range_m > 0.0F && range_m >= axes.range_min_m && range_m < axes.range_max_m;
}

// Casts the fan and keeps the hits within the range window of `axes`. A hit nearer than the window gives no
// echo, but it hides surfaces behind it.
EchoList Trace(const RayCaster& caster, const RayFan& fan, const Pose& world_from_sonar,
               const PolarAxes& axes, const TraceOptions& options = {});

}  // namespace sonarcal::sim
