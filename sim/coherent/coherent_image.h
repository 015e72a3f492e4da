// A slow, independent check of the acoustic model: the scene as point scatterers, the sonar as a line array.
//
// Each ray of a fan that hits a surface places one scatterer on it, at a random spot of the ray's cell. The
// ray decides what is visible, the plane of the triangle decides where the spot lies. The scatterer has a
// circular complex Gaussian amplitude. Its mean power is that of its patch:
//
//   10^((SL + G - 40 log10 R - 2 alpha R) / 10) sigma_m(delta) a el(phi)
//
// The surface that a ray hits is assumed to fill the ray's cell, so an outline is accurate to half a cell.
// Beside a strong target whose response falls by 10 dB per beam, the error is up to 1.5 dB for columns of a
// third of a beam, and 0.2 dB for columns of a ninth.
//
// The echo is a Gaussian pulse, delayed by its exact range. It arrives at the elements of a line array along
// X with the phase 2 pi x sin(theta) (x in wavelengths). Every element adds its own noise. The beams are sums
// over the elements, shaded by (1 - taper) + taper cos^2; the image is their power. Consequences:
//
// - Speckle, side lobes and the correlation of noise between beams follow from the array. The receiver is
//   matched to the pulse, so the noise is correlated in range over the length of an echo (in power: the
//   pulse's own response to the distance). The mean noise power after the beamformer is the receiver's noise
//   floor.
// - The mean over speckle is the acoustic model's ExpectedPower with AzimuthPattern::kAperture, up to the
//   sampling errors of both. The two share the formulas of sim/physics for one patch. They share no code that
//   forms the image: no map, no windows, no beam pattern.
//
// Multipath echoes (sim/ghosts/ghost_trace.h) have their own scatterers, one per ray of their fan, at a
// random spot of its cell. The two echoes that travel a path with two legs in opposite directions come from
// one scatterer. They have the same range and phase and reach the array from two directions; the array
// determines how they add. Echoes of different length have independent random phases.
//
// Point targets, such as a sphere used as a standard target, have a fixed amplitude and a random phase per
// look:
//
//   10^((SL + G - 40 log10 R - 2 alpha R) / 10) sigma el(phi),   sigma the backscattering cross section
//
// Nothing hides them, and they hide nothing. Targets that are not in front of the sonar (y > 0 in its frame)
// give no echo.
//
// If the pings of a frame have their own poses, all of them receive the same scatterers, which stay where
// they are in the world. Range, direction, incidence and phase are those at the pose of the ping, so speckle
// decorrelates as geometry says. Which surfaces are visible is decided at the pose of the frame. Multipath
// echoes are drawn at the pose of each ping; their speckle moves with the sonar. Each ping has its own
// receiver noise.
//
// The length of the array gives the beam at broadside its half-power width. Its elements are at most half a
// wavelength apart. The parameter azimuth_pattern is not used.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/types/parameters.h"
#include "core/types/pings.h"
#include "sim/acoustic/acoustic_image.h"
#include "sim/ghosts/ghost_trace.h"
#include "sim/rays/ray_caster.h"

namespace sonarcal::sim {

struct PointTarget {
  Eigen::Vector3d position_m;  // in the world
  double cross_section_m2 = 0.0;
};

struct CoherentGeometry {
  const RayCaster& caster;
  const RayFan& fan;
  const SonarModel& sonar;
  double absorption_db_per_m = 0.0;
  // Reflecting surfaces and the fan that searches for multipath echoes; null: no multipath echoes.
  const MirrorSurface* mirrors = nullptr;
  const RayFan* ghost_fan = nullptr;
  int ghost_order = 1;
  std::vector<PointTarget> point_targets = {};
};

// Received power of one speckled sample: the mean over `looks` (as weights, see LooksAsWeights). range_bins x
// beams, Quantity::kPower. The same seeds give the same image on any number of threads. Throws DataError for
// fewer than one look or an unknown beam width.
PolarImage CoherentPower(const CoherentGeometry& geometry, const Pose& world_from_sonar,
                         const ParameterSet& parameters, const DrawSeeds& seeds);

// Received power of a frame whose pings have their own poses (core/types/pings.h). The fan must be wider than
// the field of view by the angle that the sonar turns.
PolarImage CoherentPower(const CoherentGeometry& geometry, const Pose& world_from_sonar,
                         const std::vector<PingPose>& pings, const ParameterSet& parameters,
                         const DrawSeeds& seeds);

}  // namespace sonarcal::sim
