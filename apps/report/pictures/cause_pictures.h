// Maps of the causes of a frame's bright pixels as pictures: one colour per cause, with a legend.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "apps/report/html/html_report.h"
#include "apps/workflow/explain.h"
#include "core/types/rgb_image.h"

namespace sonarcal::report {

// Returns the colour "#rrggbb" of each name. Pixels that are not bright are nearly black, unexplained ones
// red. The others have nine colours that colour-blind readers can distinguish, then repeat from the first.
std::vector<std::string> CauseColours(std::size_t names);

// Returns the map, stretched to a readable shape, with the nearest range at the top.
RgbImage CausePicture(const Grid<std::uint8_t>& cause);

// Adds the names of the causes below the map, for a separate file. Leaves out names that are not in the map.
RgbImage WithLegend(const RgbImage& picture, const Grid<std::uint8_t>& cause,
                    const std::vector<std::string>& names);

// Returns a legend of the names that occur in any of the maps.
std::vector<LegendEntry> CauseLegend(const std::vector<workflow::CauseMap>& maps,
                                     const std::vector<std::string>& names);

}  // namespace sonarcal::report
