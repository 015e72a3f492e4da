// What the page of `sonarcal view` asks to see: everything its controls hold, sent whole with each request,
// so that the program keeps no state of the page's and undo is the page's own matter.
//
//   {"parameters": {params.json, data_io/parameters/parameters_io.h},
//    "sonar": {"frequency_hz", "range_min_m", "range_max_m", "range_bins", "beams", "field_of_view_deg",
//              "azimuth_beam_width_deg", "elevation_beam_width_deg"},      each absent: as the sonar is
//    "frame": 0,
//    "poses": {"0": {"position_m": [x, y, z], "yaw_deg", "pitch_deg", "roll_deg"}},   frames that were moved
//    "noise": false, "seed": 1,
//    "client": "a1b2", "sequence": 17}      which of a page's requests is the newest
//
// Only `parameters` is required.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "core/types/parameters.h"
#include "core/types/pose.h"
#include "core/types/sonar_model.h"

namespace sonarcal::view {

// What was changed of a sonar.
struct SonarChanges {
  std::optional<double> frequency_hz;
  std::optional<double> range_min_m;
  std::optional<double> range_max_m;
  std::optional<int> range_bins;
  std::optional<int> beams;
  std::optional<double> field_of_view_deg;  // outer edge to outer edge
  std::optional<double> azimuth_beam_width_deg;
  std::optional<double> elevation_beam_width_deg;

  bool operator==(const SonarChanges&) const = default;
};

inline constexpr int kMostRangeBins = 4096;
inline constexpr int kMostBeams = 1024;

// The sonar with the changes made. Beams keep their places where neither their number nor the field of view
// is changed, are spread wider or narrower with the field of view, and stand evenly where there are more or
// fewer; with any change they stand where sonar.json, written and read again, has them. Throws DataError
// where no sonar comes of it.
SonarModel Changed(const SonarModel& sonar, const SonarChanges& changes);

// Outer edge of the first beam to that of the last, degrees.
double FieldOfViewDeg(const PolarAxes& axes);

struct ViewState {
  ParameterSet parameters;
  SonarChanges sonar;
  int frame = 0;
  std::map<int, Pose> poses;  // world_from_sonar of frames that were moved
  bool noise = false;
  std::uint64_t seed = 1;
  std::string client;
  std::int64_t sequence = 0;
};

// Throws DataError with one sentence for anything that is not as above. `frame` and the keys of `poses` are
// below `frame_count`.
ViewState ParseViewState(std::string_view text, int frame_count);

// {"position_m", "yaw_deg", "pitch_deg", "roll_deg"}, for the page's controls.
nlohmann::ordered_json AnglePoseJson(const Pose& pose);

}  // namespace sonarcal::view
