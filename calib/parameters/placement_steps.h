// Steps of the differences of images along placements, and how entries of the sonar's geometry share them. Range and
// azimuth only say where an echo is recorded. So the slope of an image along a scale is that along the offset, times
// the range or azimuth.
#pragma once

#include "calib/parameters/parameter_catalog.h"
#include "core/types/image.h"

namespace sonarcal::calib {

// Half the step of differences of images along a placement: about half a range bin or a beam's spacing. For a
// scale of the axes at the far end of the window or the outermost beam.
double PlacementDifference(const PolarAxes& declared, const CatalogEntry& entry);

// Returns true for an entry of the geometry that moves the axes: all but the tilt, which turns the sonar.
bool ChangesAxes(const CatalogEntry& entry);

// Returns true for an entry that changes azimuths: a turn of the beams, which looks like a turn of the sonar to the
// other side.
bool TurnsBeams(const CatalogEntry& entry);

// Index of the offset of the axis that an entry changes, range or azimuth.
int OffsetOfAxis(const std::vector<CatalogEntry>& catalog, const CatalogEntry& entry);

// Change of a pixel's range, m, or azimuth, degrees, per unit of an entry that changes axes.
double AxisChange(const PolarAxes& declared, const CatalogEntry& entry, int bin, int beam);

}  // namespace sonarcal::calib
