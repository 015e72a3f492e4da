// The slow second opinion on the acoustic model: the scene as point scatterers, the sonar as an array.
//
// Each ray of a fan that meets a surface places one scatterer on it, at a random spot of the ray's cell (the
// ray decides what is visible, the plane of the triangle where the spot lies), with a circular complex
// Gaussian amplitude whose mean power is that of its patch:
//
//   10^((SL + G - 40 log10 R - 2 alpha R) / 10) sigma_m(delta) a el(phi)
//
// What the ray sees is taken to fill its cell, so an outline is sharp to half a cell: beside a strong target
// whose flank falls by 10 dB a beam, columns of a third of a beam show as up to 1.5 dB, of a ninth as 0.2 dB.
//
// Its echo, a Gaussian pulse delayed by its exact range, arrives at the elements of a line array along X with
// the phase 2 pi x sin(theta) (x in wavelengths). Every element adds noise of its own; the beams are formed
// from the sums, shaded by (1 - taper) + taper cos^2, and the image is their power. Hence:
//
//   - speckle, side lobes and the correlation of noise between beams are what the array makes them. The
//     receiver is matched to the pulse: noise is as correlated in range as an echo is long (in power, by the
//     pulse's own response to the distance), and its mean power after the beamformer is the receiver's floor;
//   - the mean over draws is the acoustic model's ExpectedPower with AzimuthPattern::kAperture, to the
//     accuracy of the sampling of either. This code shares with that one the formulas of sim/physics for one
//     patch, and nothing of how an image is made of them: no map, no windows, no beam pattern.
//
// Ghosts (sim/ghosts/ghost_trace.h) have scatterers of their own, one for each ray of their fan at a random
// spot of its cell. The two echoes that go both ways between two legs come from one scatterer, of the same
// range and phase, and reach the array from two directions: how they add is for the array to say. Echoes of
// different length have random phases to each other.
//
// The array is as long as gives the beam at bore-sight its half-power width, its elements at most half a
// wavelength apart. The parameters' azimuth_pattern has no part in it.
#pragma once

#include "core/types/parameters.h"
#include "sim/acoustic/acoustic_image.h"
#include "sim/ghosts/ghost_trace.h"
#include "sim/rays/ray_caster.h"

namespace sonarcal::sim {

struct CoherentGeometry {
  const RayCaster& caster;
  const RayFan& fan;
  const SonarModel& sonar;
  double absorption_db_per_m = 0.0;
  // What reflects, and the fan that looks for ghosts there; null: nothing does.
  const MirrorSurface* mirrors = nullptr;
  const RayFan* ghost_fan = nullptr;
  int ghost_order = 1;
};

// Received power of one draw, the mean of `looks` of them (as weights, see LooksAsWeights): range_bins x
// beams, Quantity::kPower. The same seeds give the same image on any number of threads. Throws DataError for
// fewer than one look or an unknown beam width.
PolarImage CoherentPower(const CoherentGeometry& geometry, const Pose& world_from_sonar,
                         const ParameterSet& parameters, const DrawSeeds& seeds);

}  // namespace sonarcal::sim
