// Steps of the differences of images along placements, and how entries of the sonar's geometry share them.
// Range and azimuth only say where an echo is recorded. So the slope of an image along a scale is that along
// the offset, times the range or azimuth.
#pragma once

#include <span>
#include <vector>

#include "calib/parameters/parameter_catalog.h"
#include "core/types/image.h"

namespace sonarcal::calib {

// Half the step of differences of images along a placement: about half a range bin or a beam's spacing. For a
// scale of the axes at the far end of the window or the outermost beam.
double PlacementDifference(const PolarAxes& declared, const CatalogEntry& entry);

// Returns true for an entry that moves an object without changing its shape.
bool IsRigidMove(const CatalogEntry& entry);

// Returns true for an entry of the geometry that moves the axes: all but the tilt, which turns the sonar.
bool ChangesAxes(const CatalogEntry& entry);

// Returns true for an entry that changes azimuths: a turn of the beams to the right, which looks like a turn
// of the sonar to the left. So the slope along the azimuth offset is that along a turn of the sonar, with the
// opposite sign. A slope of its own would differ from it by errors of rays at edges, and seem to tell the two
// apart.
bool TurnsBeams(const CatalogEntry& entry);

// Index of the range offset.
int RangeOffsetOf(const std::vector<CatalogEntry>& catalog);

// Turns the slope of an image along the offset of range or azimuth into that along another entry of the same
// axis: multiplies each pixel by the change of its range, m, or azimuth, degrees, per unit of the entry.
// `slope` has one value per pixel, bin by bin.
void ScaleToEntry(const PolarAxes& declared, const CatalogEntry& entry, std::span<float> slope);

}  // namespace sonarcal::calib
