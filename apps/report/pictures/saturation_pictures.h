// Traces of a saturated receiver (calib/models/frame_saturation.h) in a report: what a fit left out, with
// pictures.
#pragma once

#include <map>
#include <vector>

#include "apps/report/html/html_report.h"
#include "calib/models/frame_saturation.h"

namespace sonarcal::report {

// Adds nothing if there is no trace. `images`: recorded frames to show, by index.
void AddSaturation(HtmlReport& report, const std::vector<calib::FrameSaturation>& saturation,
                   const PolarAxes& axes, const std::map<int, PolarImage>& images = {},
                   bool is_synthetic = false);

}  // namespace sonarcal::report
