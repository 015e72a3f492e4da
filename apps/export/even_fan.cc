#include "apps/export/even_fan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/types/error.h"
#include "core/types/units.h"

namespace sonarcal::exporting {
namespace {

constexpr double kSlackInBeams = 1e-3;

}  // namespace

bool EvenFan::IsEven() const {
  return worst_deg <= kSlackInBeams * spacing_deg();
}

bool EvenFan::IsCentred() const {
  return std::abs(centre_deg) <= kSlackInBeams * spacing_deg();
}

EvenFan EvenFanOf(const ExportSource& source) {
  const PolarAxes& axes = source.sonar.axes;
  EvenFan fan;
  fan.beams = axes.beam_count();
  fan.first_deg = DegFromRad(axes.beam_azimuth_rad.front());
  fan.last_deg = DegFromRad(axes.beam_azimuth_rad.back());
  fan.field_deg = DegFromRad(axes.field_of_view_rad());
  fan.centre_deg = DegFromRad(0.5 * (axes.BeamEdgeRad(fan.beams) + axes.BeamEdgeRad(0)));
  const double own_deg = source.parameters.beam.elevation_width_deg;
  fan.elevation_deg = own_deg > 0.0 && source.parameters.model != EchoModel::kPaper
                          ? own_deg
                          : source.sonar.elevation_beam_width_deg;
  for (int beam = 0; beam < fan.beams; ++beam) {
    const double even_deg = fan.centre_deg - 0.5 * fan.field_deg + (beam + 0.5) * fan.spacing_deg();
    fan.worst_deg = std::max(fan.worst_deg, std::abs(even_deg - DegFromRad(axes.beam_azimuth_rad[beam])));
  }
  if (!(fan.elevation_deg > 0.0 && fan.elevation_deg < 180.0)) {
    throw DataError("the sonar's elevation_beam_width_deg is {}, expected more than 0 and less than 180",
                    fan.elevation_deg);
  }
  if (!(fan.field_deg > 0.0 && fan.field_deg < 180.0)) {
    throw DataError("the sonar's field of view is {:g} degrees, expected more than 0 and less than 180",
                    fan.field_deg);
  }
  return fan;
}

void AccountForBeams(const EvenFan& fan, const std::string& target, ExportAccount& account,
                     const std::string& also) {
  std::string how;
  if (!fan.IsEven())
    how += fmt::format("beams are spaced evenly, up to {:.3g} degrees off ours; ", fan.worst_deg);
  if (!fan.IsCentred())
    how += fmt::format("the field of view is centred: turn the sensor by {:.4g} degrees to the right; ",
                       fan.centre_deg);
  how += also;
  if (how.empty()) return account.Exported("sonar.beam_azimuth_deg", target);
  if (how.ends_with("; ")) how.resize(how.size() - 2);
  account.Approximated("sonar.beam_azimuth_deg", target, how);
}

}  // namespace sonarcal::exporting
