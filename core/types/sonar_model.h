// Known properties of a sonar before a fit: its image geometry and its beams.
#pragma once

#include <string>
#include <type_traits>

#include "core/types/image.h"
#include "core/types/pings.h"
#include "core/types/words.h"

namespace sonarcal {

// Method by which a sonar forms its beams. It determines whether neighbouring beams share receiver noise.
enum class BeamForming {
  kUnknown,  // treated as kArray
  kArray,    // sums over the elements of an array: the noise of one element enters many beams
  kLens,     // acoustic lens, one element per beam: each beam has independent noise
};
constexpr auto WordsOf(std::type_identity<BeamForming>) {
  return Words<BeamForming, 2>{{{"array", BeamForming::kArray}, {"lens", BeamForming::kLens}}};
}

struct SonarModel {
  std::string name;
  double frequency_hz = 0.0;
  PolarAxes axes;
  double azimuth_beam_width_deg = 0.0;    // two-way half-power width of one beam; 0 = unknown
  double elevation_beam_width_deg = 0.0;  // two-way half-power width; 0 = unknown
  double sound_speed_m_per_s = 0.0;
  BeamForming beam_forming = BeamForming::kUnknown;
  PingPattern pings = {};
};

// Temperature, salinity, acidity and depth, for the absorption of sound.
struct Water {
  double temperature_c = 15.0;
  double salinity_ppt = 0.0;
  double ph = 7.0;
  double depth_m = 1.0;

  bool operator==(const Water&) const = default;
};

}  // namespace sonarcal
