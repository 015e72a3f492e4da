// Ghosts: echoes that reach the sonar by way of a mirror. Geometry only, nothing acoustic, as
// sim/rays/trace.h is.
//
// A leg joins the sonar and a patch of the scene: straight, or by one mirror (two at second order). An echo
// goes out by one leg and comes back by the same or another. Of each patch P that the fan sees in a mirror:
//
//   mirror - P - mirror   there and back by the same leg;
//   straight - P - mirror and mirror - P - straight, where P is seen straight too: one entry of the list, as
//                         the two are each other's reverse, of one length, heard from two directions.
//
// Found by casting rays, so each leg is blocked where the scene is in its way, and a mirror ends where its
// surface does. A ray of the fan that meets a mirror goes on from there, and what it meets is P: its leg
// arrives from the ray's own azimuth and elevation. A second ray from P to the sonar finds the straight leg,
// which must lie on the same side of P's surface. Any surface may be the mirror
// (sim/ghosts/mirror_surface.h).
//
// Second order adds legs by two mirrors, one after the other, straight the other way; and ways out by one
// mirror and back by another, of which one is flat (found by the sonar's image behind it). Not followed:
// between two curved mirrors, and whatever has more reflections.
//
// Mirrors are seen through the lobes of the elevation pattern that BeamParameters::mirror_lobes names.
//
// What is sent reaches as far in azimuth as the fan: legs beyond are not followed. That fan may be wider than
// the one that listens (GhostFanOptions), as what is sent past the field of view may come back into it.
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
  float spreading_m = 0.0F;  // RayBundle::SpreadingM at the patch; `length_m` where no mirror is curved
  float azimuth_rad = 0.0F;  // at the sonar
  float elevation_rad = 0.0F;
  float incidence_rad = 0.0F;  // at the patch, between leg and normal, 0 .. pi/2
  std::array<std::uint16_t, 2> mirror = {kNoMirror, kNoMirror};  // materials, from the sonar on

  bool straight() const { return mirror[0] == kNoMirror; }
};

struct GhostEcho {
  std::uint16_t material = 0;   // of the patch
  bool both_ways = false;       // goes out by either leg and back by the other: two echoes of one range
  float solid_angle_sr = 0.0F;  // of the ray that found `leg`
  // Between the normal and the direction midway between the two legs, 0 .. pi/2: what a facet that reflects
  // one leg into the other is tilted by.
  float tilt_rad = 0.0F;
  GhostLeg leg;
  GhostLeg other;  // the same as `leg` unless both_ways

  float range_m() const { return 0.5F * (leg.length_m + other.length_m); }
};

struct GhostList {
  std::vector<GhostEcho> echoes;  // in the order of the rays
  std::vector<std::string> material_names;
};

struct GhostOptions {
  int order = 1;             // 1 or 2
  double range_min_m = 0.0;  // of the echoes that are kept: half the way there and back
  double range_max_m = 0.0;
  double heard_left_rad = -kPi;  // azimuths that an echo may come back from
  double heard_right_rad = kPi;
  // Each ray at a random spot of its cell in place of the middle.
  std::optional<std::uint64_t> spots_seed = {};

  void Check() const;
};

// Which materials of a scene the parameters call mirrors, 1 or 0 each: what MirrorSurface takes.
std::vector<char> ReflectingMaterials(const std::vector<std::string>& material_names,
                                      const ParameterSet& parameters);

// Rays that look for ghosts beside a fan of these: a quarter of the columns and half of the rows for equal
// angles, but as far aside as the transmitter sends, and in elevation through the lobes that
// `beam.mirror_lobes` names. What they find is shared between the columns of the fan itself. A ghost costs
// three rays where an echo costs one, and is seldom as strong.
RayFanOptions GhostFanOptions(const RayFanOptions& fan, const SonarModel& sonar, const BeamParameters& beam);

// Azimuths from the outer edge of a fan's first column to that of its last.
std::pair<double, double> AzimuthsRad(const RayFan& fan);

GhostList TraceGhosts(const RayCaster& caster, const MirrorSurface& mirrors, const RayFan& fan,
                      const Pose& world_from_sonar, const GhostOptions& options);

}  // namespace sonarcal::sim
