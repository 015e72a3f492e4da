// Recording of a standard target: a sphere in open water, made by the coherent simulator. SYNTHETIC.
#pragma once

#include <cstdint>
#include <vector>

#include "core/types/parameters.h"
#include "core/types/pose.h"
#include "core/types/recording.h"

namespace sonarcal::testing {

// Place of the sphere in the frame of the sonar.
struct SpherePlace {
  double range_m = 3.0;
  double azimuth_rad = 0.0;
  double elevation_rad = 0.0;
  double roll_rad = 0.0;  // of the sonar
};

struct SphereRecordingOptions {
  SonarModel sonar;
  ParameterSet truth;
  double cross_section_m2 = 0.0;
  double absorption_db_per_m = 0.0;
  std::vector<SpherePlace> places;           // one a frame
  std::vector<double> level_change_db = {};  // of each frame; empty: 0
  bool with_poses = false;                   // the sphere then stands still in the world
  std::uint64_t seed = 1;
};

MemoryRecording SphereRecording(const SphereRecordingOptions& options);

}  // namespace sonarcal::testing
