// From hits to echoes: geometry only, nothing acoustic, so that a scene is traced once and shaded many times.
#pragma once

#include <cstdint>
#include <type_traits>
#include <vector>

#include "core/types/words.h"
#include "sim/rays/ray_caster.h"

namespace sonarcal::sim {

// How the surface normal at a hit is found.
//   geometric  from the mesh.
//   depth      from the point cloud (Park 2024 Eq. 8): the cross product of differences to the rays `step`
//              columns right and rows down. Where one of those missed, or lies across a jump in range of more
//              than `jump_ratio`, the ray on the other side is used; where that fails too, the mesh's normal.
enum class NormalSource { kGeometric, kDepth };
constexpr auto WordsOf(std::type_identity<NormalSource>) {
  return Words<NormalSource, 2>{{{"geometric", NormalSource::kGeometric}, {"depth", NormalSource::kDepth}}};
}

struct TraceOptions {
  NormalSource normals = NormalSource::kGeometric;
  int step = 2;              // k of Eq. 8: 2 or 3
  double jump_ratio = 0.05;  // of range

  void Check() const;
};

// The echoes of one frame, one for each ray that met something within the sonar's range window; structure of
// arrays, all of the same length, in the order of the rays.
struct EchoList {
  std::vector<std::uint32_t> ray;  // index in the fan
  std::vector<std::uint16_t> material;
  std::vector<float> range_m;
  std::vector<float> azimuth_rad;
  std::vector<float> elevation_rad;
  std::vector<float> incidence_rad;   // between ray and normal, 0 .. pi/2
  std::vector<float> solid_angle_sr;  // that the ray stands for

  // Of the fan that was traced: grid column of a ray, beam of a column, rays a beam has in all.
  int cols = 0;
  std::vector<int> beam_of_column;
  std::vector<int> rays_per_beam;
  std::vector<float> weight;  // RayFan::RowWeights of each echo; empty: all 1
  std::vector<std::string> material_names;

  std::size_t size() const { return range_m.size(); }
  double Weight(std::size_t echo) const { return weight.empty() ? 1.0 : double{weight[echo]}; }
  int Beam(std::size_t echo) const { return beam_of_column[ray[echo] % cols]; }
};

// Casts the fan and keeps what lies within the range window of `axes`. A hit nearer than the window shadows
// what is behind it and gives no echo.
EchoList Trace(const RayCaster& caster, const RayFan& fan, const Pose& world_from_sonar,
               const PolarAxes& axes, const TraceOptions& options = {});

}  // namespace sonarcal::sim
