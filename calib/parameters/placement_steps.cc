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

bool IsRigidMove(const CatalogEntry& entry) {
  return entry.group == ParameterGroup::kObject && entry.index < kPoseSteps;
}

bool ChangesAxes(const CatalogEntry& entry) {
  return entry.group == ParameterGroup::kGeometry && !entry.name.ends_with("tilt_deg");
}

bool TurnsBeams(const CatalogEntry& entry) {
  return entry.name.starts_with("geometry.azimuth_");
}

int RangeOffsetOf(const std::vector<CatalogEntry>& catalog) {
  const auto found = std::ranges::find(catalog, "geometry.range_offset_m", &CatalogEntry::name);
  SONARCAL_CHECK(found != catalog.end(), "a catalog without geometry");
  return static_cast<int>(found - catalog.begin());
}

void ScaleToEntry(const PolarAxes& declared, const CatalogEntry& entry, std::span<float> slope) {
  const int beams = declared.beam_count();
  const double edge_deg = DegFromRad(
      std::max(std::abs(declared.beam_azimuth_rad.front()), std::abs(declared.beam_azimuth_rad.back())));
  for (std::size_t pixel = 0; pixel < slope.size(); ++pixel) {
    const double azimuth_deg = DegFromRad(declared.beam_azimuth_rad[pixel % beams]);
    double change = 1.0;
    if (entry.name.ends_with("range_scale"))
      change = declared.range_centre_m(static_cast<int>(pixel / beams));
    if (entry.name.ends_with("azimuth_scale")) change = azimuth_deg;
    if (entry.name.ends_with("azimuth_cubic")) change = azimuth_deg * std::pow(azimuth_deg / edge_deg, 2);
    slope[pixel] *= static_cast<float>(change);
  }
}

}  // namespace sonarcal::calib
