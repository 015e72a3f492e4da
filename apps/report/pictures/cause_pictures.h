// Maps of what the bright cells of a frame come from, as pictures: one colour a cause, with a legend.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "apps/report/html/html_report.h"
#include "apps/workflow/explain.h"
#include "core/types/rgb_image.h"

namespace sonarcal::report {

// "#rrggbb" of each name: cells that are not bright near black, those not explained red, others told apart by
// colour-blind readers as far as there are colours (nine, then again from the first).
std::vector<std::string> CauseColours(std::size_t names);

// The map, stretched to a readable shape: nearest range at the top.
RgbImage CausePicture(const Grid<std::uint8_t>& cause);

// The same with the names of the causes below it, for a file that stands alone. Names that are not in the map
// are left out.
RgbImage WithLegend(const RgbImage& picture, const Grid<std::uint8_t>& cause,
                    const std::vector<std::string>& names);

// Of the names that occur in any of the maps.
std::vector<LegendEntry> CauseLegend(const std::vector<workflow::CauseMap>& maps,
                                     const std::vector<std::string>& names);

}  // namespace sonarcal::report
