// A sonar image as inline SVG with axes, range rings and a colour bar. The browser colours and superimposes
// the grey data of the page by SVG filters, without a script, so that one copy of the data serves every
// picture. A fan is clipped to its sector; the page shows around it.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/types/image.h"

namespace sonarcal::report {

enum class SonarView { kPolar, kFan };  // polar: nearest range at the top; fan: ahead is up

enum class SonarColours {
  kInferno,     // one grey picture
  kOverlay,     // two grey pictures: the real one in blue, the simulated one in orange
  kDifference,  // colour picture by data_io::Diverging
  kRegions,  // one picture of the values 1 (object in the real image), 2 (in the simulated one) and 3 (both)
  kCategories,  // colour picture with a legend of its own
};

// Encoded picture in the page.
struct StoredPicture {
  std::string id;
  int rows = 0;
  int cols = 0;
  bool is_grey = false;
};

struct SonarPlot {
  PolarAxes axes;
  SonarView view = SonarView::kPolar;
  SonarColours colours = SonarColours::kInferno;
  std::vector<std::uint8_t> simulated = {};  // PNG, kOverlay only
  // Colour bar: text at the left end, in the middle and at the right end. No bar if all are empty.
  std::array<std::string, 3> bar = {};
};

// `pictures`: one, or two for kOverlay. `number` distinguishes the plots of one page.
std::string SonarPlotSvg(const SonarPlot& plot, const std::vector<StoredPicture>& pictures, int number,
                         std::string_view alt);

// Returns axes and rings alone, to lay over an image of at most `max_width` x `max_height` pixels.
std::string SonarAxesSvg(const PolarAxes& axes, SonarView view, double max_width, double max_height,
                         std::string_view attributes);

// Returns a colour bar alone. `gradient`: inferno, grey, overlay or difference.
std::string ColourBarSvg(std::string_view gradient, const std::array<std::string, 3>& texts,
                         std::string_view attributes);

// Filters and gradients that the other functions refer to; once per page.
std::string SonarDefinitionsSvg();

}  // namespace sonarcal::report
