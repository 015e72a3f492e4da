// State of the page of `sonarcal view`: the values of all controls. Each request contains all of it, so the
// program stores no state of the page, and the page itself implements undo.
//
//   {"parameters": {params.json, data_io/parameters/parameters_io.h},
//    "sonar": {"frequency_hz", "range_min_m", "range_max_m", "range_bins", "beams", "field_of_view_deg",
//              "azimuth_beam_width_deg", "elevation_beam_width_deg"},      absent members: as in the sonar
//    "frame": 0,
//    "poses": {"0": {"position_m": [x, y, z], "yaw_deg", "pitch_deg", "roll_deg"}},   frames with a changed pose
//    "noise": false, "seed": 1,
//    "client": "a1b2", "sequence": 17}      identify the newest request of a page
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

// Changed properties of a sonar.
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

inline constexpr int kMaxRangeBins = 4096;
inline constexpr int kMaxBeams = 1024;

// Returns the sonar with the changes. Beams keep their azimuths if neither their number nor the field of view
// changes. They are scaled with the field of view, and evenly spaced if their number changes. With any
// change, their azimuths are as after writing and reading sonar.json. Throws DataError if the result is not a
// valid sonar.
SonarModel Changed(const SonarModel& sonar, const SonarChanges& changes);

// Angle from the outer edge of the first beam to that of the last, degrees.
double FieldOfViewDeg(const PolarAxes& axes);

struct ViewState {
  ParameterSet parameters;
  SonarChanges sonar;
  int frame = 0;
  std::map<int, Pose> poses;  // world_from_sonar of frames with a changed pose
  bool noise = false;
  std::uint64_t seed = 1;
  std::string client;
  std::int64_t sequence = 0;
};

// Throws DataError with one sentence if the text does not have the format above. `frame` and the keys of
// `poses` must be below `frame_count`.
ViewState ParseViewState(std::string_view text, int frame_count);

// Returns {"position_m", "yaw_deg", "pitch_deg", "roll_deg"} for the controls of the page.
nlohmann::ordered_json AnglePoseJson(const Pose& pose);

}  // namespace sonarcal::view
