#include "core/sonars/sonar_geometry.h"

#include <algorithm>
#include <cmath>

#include "core/types/units.h"

namespace sonarcal {

PolarAxes Corrected(const PolarAxes& declared, const SonarGeometry& geometry) {
  PolarAxes axes = declared;
  axes.range_min_m = geometry.range_offset_m + geometry.range_scale * declared.range_min_m;
  axes.range_max_m = geometry.range_offset_m + geometry.range_scale * declared.range_max_m;
  double edge_rad = 0.0;
  for (const double azimuth_rad : declared.beam_azimuth_rad)
    edge_rad = std::max(edge_rad, std::abs(azimuth_rad));
  for (double& azimuth_rad : axes.beam_azimuth_rad) {
    const double of_edge = edge_rad > 0.0 ? azimuth_rad / edge_rad : 0.0;
    azimuth_rad = RadFromDeg(geometry.azimuth_offset_deg) +
                  (geometry.azimuth_scale + geometry.azimuth_cubic * of_edge * of_edge) * azimuth_rad;
  }
  axes.Validate("the corrected axes of the sonar");
  return axes;
}

Pose Tilted(const Pose& world_from_mount, const SonarGeometry& geometry) {
  if (geometry.tilt_deg == 0.0) return world_from_mount;
  return {
      world_from_mount.rotation * Eigen::AngleAxisd(RadFromDeg(geometry.tilt_deg), Eigen::Vector3d::UnitX()),
      world_from_mount.position_m};
}

}  // namespace sonarcal
