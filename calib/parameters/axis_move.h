// Moves an image as a change of the sonar's geometry does, without tracing. Range and azimuth only say where an
// echo is recorded, so the image at other axes is the present one, read elsewhere.
#pragma once

#include "calib/parameters/parameter_catalog.h"
#include "core/sonars/sonar_geometry.h"
#include "core/types/image.h"

namespace sonarcal::calib {

// Returns true for an entry of the geometry that moves the axes: all but the tilt, which turns the sonar.
bool ChangesAxes(const CatalogEntry& entry);

// Half the step of differences of images along a placement: about half a range bin or a beam's spacing. For a
// scale of the axes at the far end of the window or the outermost beam.
double PlacementDifference(const PolarAxes& declared, const CatalogEntry& entry);

// Returns the image (range_bins x beams, power at the geometry `from`) at the geometry `to`, by linear
// interpolation. Values beyond the axes are those at their ends.
template <typename T>
Grid<T> WithAxesMoved(const Grid<T>& image, const PolarAxes& declared, const SonarGeometry& from,
                      const SonarGeometry& to);

}  // namespace sonarcal::calib
