#include "calib/geometry_ambiguity.h"

#include <fmt/format.h>

#include <cmath>

namespace sonarcal::calib {

std::vector<std::string> GeometryAmbiguities(const FitReport& report, int distinct_poses) {
  std::vector<std::string> sentences;
  // Calls `other` with the value, for a free parameter, and puts the value before its words.
  const auto add = [&](const char* name, const char* words, int digits, const auto& other) {
    const FittedParameter* of = report.Find(name);
    if (of == nullptr || !of->sigma || of->status == ParameterStatus::kFixed) return;
    const std::string unit = of->unit == "1" ? "" : " " + of->unit;
    sentences.push_back(fmt::format("{} {:.{}f} +- {:.{}f}{}: {} would explain the frames as well", words,
                                    of->value, digits, *of->sigma, digits, unit, other(of->value)));
  };
  add("geometry.range_scale", "range scale", 4, [](double scale) {
    const double percent = 100.0 * (1.0 / scale - 1.0);
    return fmt::format("a scene, and positions in it, that are {:.2f} % {}", std::abs(percent),
                       percent < 0.0 ? "smaller" : "larger");
  });
  add("geometry.azimuth_offset_deg", "azimuth offset", 2, [](double offset_deg) {
    return fmt::format("a mount turned {:.2f} deg to the {}", std::abs(offset_deg),
                       offset_deg < 0.0 ? "left" : "right");
  });
  add("geometry.tilt_deg", "tilt", 2, [](double tilt_deg) {
    return fmt::format("a mount pitched {:.2f} deg {}", std::abs(tilt_deg), tilt_deg < 0.0 ? "down" : "up");
  });
  if (distinct_poses == 1) {
    add("geometry.range_offset_m", "range offset", 3, [](double offset_m) {
      return fmt::format("a sonar {:.3f} m farther {} along its axis", std::abs(offset_m),
                         offset_m < 0.0 ? "back" : "ahead");
    });
  }
  return sentences;
}

}  // namespace sonarcal::calib
