#include "calib/parameters/placement_steps.h"

#include <algorithm>
#include <cmath>

#include "calib/parameters/pose_step.h"
#include "core/types/error.h"
#include "core/types/units.h"

namespace sonarcal::calib {

double PlacementDifference(const PolarAxes& declared, const CatalogEntry& entry) {
  constexpr double kScaleOfObject = 0.005;
  if (entry.group == ParameterGroup::kPose || entry.group == ParameterGroup::kObject)
    return entry.index < kPoseSteps ? PoseDifference(declared, entry.index) : kScaleOfObject;
  // Outlines: as a shift of the sonar, because a surface moves along the range at most.
  const double along_range_m = PoseDifference(declared, 0);
  const double across_deg = PoseDifference(declared, 3);
  if (entry.unit == "m") return along_range_m;
  if (entry.unit == "deg") return across_deg;
  return entry.name.ends_with("range_scale") ? along_range_m / declared.range_max_m
                                             : across_deg / DegFromRad(declared.OuterEdgeRad());
}

bool ChangesAxes(const CatalogEntry& entry) {
  return entry.group == ParameterGroup::kGeometry && !entry.name.ends_with("tilt_deg");
}

bool TurnsBeams(const CatalogEntry& entry) {
  return entry.name.starts_with("geometry.azimuth_");
}

int OffsetOfAxis(const std::vector<CatalogEntry>& catalog, const CatalogEntry& entry) {
  const bool range = entry.name.starts_with("geometry.range_");
  const auto found = std::ranges::find(
      catalog, range ? "geometry.range_offset_m" : "geometry.azimuth_offset_deg", &CatalogEntry::name);
  SONARCAL_CHECK(found != catalog.end(), "a catalog without geometry");
  return static_cast<int>(found - catalog.begin());
}

double AxisChange(const PolarAxes& declared, const CatalogEntry& entry, int bin, int beam) {
  if (entry.name.ends_with("range_scale")) return declared.range_centre_m(bin);
  const double azimuth_deg = DegFromRad(declared.beam_azimuth_rad[beam]);
  if (entry.name.ends_with("azimuth_scale")) return azimuth_deg;
  if (!entry.name.ends_with("azimuth_cubic")) return 1.0;
  const double edge_deg = DegFromRad(
      std::max(std::abs(declared.beam_azimuth_rad.front()), std::abs(declared.beam_azimuth_rad.back())));
  return azimuth_deg * std::pow(azimuth_deg / edge_deg, 2);
}

}  // namespace sonarcal::calib
