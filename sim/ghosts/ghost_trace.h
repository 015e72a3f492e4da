// Traces multipath echoes (ghosts): echoes that reach the sonar by a mirror. Geometry only, as
// sim/rays/trace.h.
//
// A leg joins the sonar and a patch of the scene: straight, or by one mirror (two at second order). An echo
// goes out by one leg and comes back by the same or another. Echoes of each patch P that the fan sees in a
// mirror:
//
//   mirror - P - mirror    Out and back by the same leg.
//   straight - P - mirror  If P is also visible directly. Together with its reverse, mirror - P - straight,
//                          it is one entry of the list: both have one length and arrive from two directions.
//
// The legs are found by casting rays, so occlusion and the extent of a mirror are exact. A ray of the fan
// that hits a mirror continues from there, and its next intersection is P. This leg arrives from the ray's
// own azimuth and elevation. A second ray from P to the sonar finds the straight leg, which must lie on the
// same side of P's surface. Any surface may be a mirror (sim/ghosts/mirror_surface.h).
//
// Second order adds legs by two mirrors in sequence with a straight return, and echoes out by one mirror and
// back by another. One of these two must be flat; it is found by the sonar's image behind it. Not traced:
// echoes between two curved mirrors, and echoes with more reflections.
//
// Mirrors are seen through the lobes of the elevation pattern that BeamParameters::mirror_lobes names.
//
// The fan limits the transmitted azimuths: legs beyond it are not traced. It may be wider than the receiving
// fan (GhostFanOptions), because sound sent outside the field of view may come back into it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/types/parameters.h"
#include "core/types/units.h"
#include "sim/ghosts/mirror_surface.h"
#include "sim/rays/ray_caster.h"

namespace sonarcal::sim {

inline constexpr std::uint16_t kNoMirror = 0xFFFF;

struct GhostLeg {
  float length_m = 0.0F;
  float spreading_m = 0.0F;  // RayBundle::SpreadingM at the patch; `length_m` if no mirror is curved
  float azimuth_rad = 0.0F;  // at the sonar
  float elevation_rad = 0.0F;
  float incidence_rad = 0.0F;  // at the patch, between leg and normal, 0 .. pi/2
  std::array<std::uint16_t, 2> mirror = {kNoMirror, kNoMirror};  // materials, starting at the sonar

  bool straight() const { return mirror[0] == kNoMirror; }
};

struct GhostEcho {
  std::uint16_t material = 0;   // of the patch
  bool both_ways = false;       // out by either leg and back by the other: two echoes of one range
  float solid_angle_sr = 0.0F;  // of the ray that found `leg`
  // Angle between the normal and the bisector of the two legs, 0 .. pi/2: the tilt of a facet that reflects
  // one leg into the other.
  float tilt_rad = 0.0F;
  GhostLeg leg;
  GhostLeg other;  // equals `leg` unless both_ways

  float range_m() const { return 0.5F * (leg.length_m + other.length_m); }
};

struct GhostList {
  std::vector<GhostEcho> echoes;  // in the order of the rays
  std::vector<std::string> material_names;
};

struct GhostOptions {
  int order = 1;             // 1 or 2
  double range_min_m = 0.0;  // range window of the echoes to keep; range is half the path
  double range_max_m = 0.0;
  double heard_left_rad = -kPi;  // azimuths from which an echo may arrive
  double heard_right_rad = kPi;
  // If set, each ray uses a random spot of its cell instead of the middle.
  std::optional<std::uint64_t> spots_seed = {};

  void Check() const;
};

// 1 for each material of a scene that the parameters declare as a mirror, otherwise 0; input of
// MirrorSurface.
std::vector<char> ReflectingMaterials(const std::vector<std::string>& material_names,
                                      const ParameterSet& parameters);

// Rays that search for multipath echoes, derived from the fan of direct echoes. For equal angles: a quarter
// of the columns and a third of the rows. In a tank of six planes, the multipath power of a pixel then
// differs by 0.4 dB (root mean square) from that of 24 times as many rays. The fan covers the azimuths of the
// transmitter, and in elevation the lobes that `beam.mirror_lobes` names. Found echoes are shared between the
// columns of the original fan. Fewer rays suffice because multipath echoes are usually weak; each costs three
// rays, a direct echo one.
RayFanOptions GhostFanOptions(const RayFanOptions& fan, const SonarModel& sonar, const BeamParameters& beam);

// Azimuths of the outer edges of a fan's first and last column.
std::pair<double, double> AzimuthsRad(const RayFan& fan);

GhostList TraceGhosts(const RayCaster& caster, const MirrorSurface& mirrors, const RayFan& fan,
                      const Pose& world_from_sonar, const GhostOptions& options);

}  // namespace sonarcal::sim
