// State of the page of `sonarcal view`: the values of all controls. Each request contains all of it, so the
// program stores no state of the page, and the page itself implements undo.
//
//   {"parameters": {params.json, data_io/parameters/parameters_io.h},
//    "sonar": {"frequency_hz": 9e5, "range_bins": 512, ...},      see SonarChanges; absent: as the sonar is
//    "frame": 0,
//    "poses": {"0": {"position_m": [x, y, z], "yaw_deg", "pitch_deg", "roll_deg"}},   frames moved by hand
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

#include "core/types/parameter_info.h"
#include "core/types/parameters.h"
#include "core/types/pose.h"
#include "core/types/sonar_model.h"

namespace sonarcal::view {

// Values of a sonar that the page changes; absent: as the sonar is.
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

// Returns the values of a sonar that the page can change, all present.
SonarChanges SonarAsShown(const SonarModel& sonar);

// Whether a recording holds this value of its sonar: its range window and its beams.
bool IsRecorded(std::string_view key);

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

namespace sonarcal {

template <>
struct ParameterTable<view::SonarChanges> {
  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor&& visit) {
    using enum ParameterScale;
    const auto number = [&](ParameterInfo info, ParameterScale scale, ControlRange control, auto& member) {
      info.meaning = info.label;
      info.scale = scale;
      info.control = control;
      visit(info, member);
    };
    const auto width = [&](std::string_view key, std::string_view label, ControlRange control,
                           ModelUse models, auto& member) {
      number({.key = key,

              .unit = "deg",
              .label = label,
              .models = models,
              .min = 0.0,
              .max = 170.0,
              .above_min = true},
             kLogarithmic, control, member);
    };
    number({.key = "frequency_hz", .unit = "Hz", .label = "Frequency", .min = 1e3, .max = 1e8}, kLogarithmic,
           {1e3, 1e8, 0.5}, self.frequency_hz);
    // The step is a fraction of the max range.
    number({.key = "range_min_m", .unit = "m", .label = "Min range", .min = 0.0, .max = 1000.0}, kLinear,
           {0.0, 1000.0, 0.3}, self.range_min_m);
    number({.key = "range_max_m", .unit = "m", .label = "Max range", .min = 0.0, .max = 1000.0}, kLogarithmic,
           {0.01, 1000.0, 0.4}, self.range_max_m);
    number({.key = "range_bins", .unit = "1", .label = "Range bins", .min = 2, .max = 4096}, kLogarithmic,
           {2.0, 4096.0, 0.4}, self.range_bins);
    number({.key = "beams", .unit = "1", .label = "Beams", .min = 2, .max = 1024}, kLogarithmic,
           {2.0, 1024.0, 0.4}, self.beams);
    width("field_of_view_deg", "Field of view, azimuth", {1.0, 170.0, 0.4}, kAllModels,
          self.field_of_view_deg);
    width("elevation_beam_width_deg", "Field of view, elevation", {0.1, 170.0, 0.4}, kAllModels,
          self.elevation_beam_width_deg);
    width("azimuth_beam_width_deg", "Width of a beam", {0.01, 170.0, 0.6}, kAcousticModel,
          self.azimuth_beam_width_deg);
  }
};

}  // namespace sonarcal
