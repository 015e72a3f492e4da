// Sonar images as pictures of a page: grey data that the browser colours and superimposes, with axes.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "apps/report/html/html_report.h"
#include "core/types/image.h"
#include "metrics/compare.h"

namespace sonarcal::report {

// Returns an 8-bit grey PNG: 0 for `low` and below, 255 for `high` and above.
std::vector<std::uint8_t> GreyPng(const Grid<float>& value, double low, double high);

// Returns 1 for an object in the real image, 2 in the simulated one, 3 in both. `metrics.masks` must be set.
Grid<std::uint8_t> ObjectRegions(const metrics::FrameMetrics& metrics);

struct ColourLimits {
  double low = 0.0;
  double high = 1.0;
};

// Colours run over `limits`. Without them: from 0 to full scale, for other quantities than grey levels from
// the lowest to the highest value.
Picture SonarPicture(const PolarImage& image, SonarView view, std::string caption, std::string alt,
                     const std::optional<ColourLimits>& limits = {});

// Real image in blue plus simulated image in orange. `real`: what the real side is called.
Picture OverlayPicture(const PolarImage& real_image, const PolarImage& simulated, SonarView view,
                       const std::string& real, std::string alt);

// Regions as in ObjectRegions().
Picture RegionsPicture(const PolarAxes& axes, const Grid<std::uint8_t>& regions, SonarView view,
                       std::string alt);

}  // namespace sonarcal::report
