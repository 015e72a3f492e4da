// Traces of a saturated receiver (calib/models/frame_saturation.h) in a report: what a fit left out, with
// pictures.
#pragma once

#include <map>

#include "apps/report/html/html_report.h"
#include "calib/fit_report.h"

namespace sonarcal::report {

// Adds nothing if no trace was found. `streaked`: recorded frames to show, by index.
void AddSaturation(HtmlReport& report, const calib::FitReport& fit, const PolarAxes& axes,
                   const std::map<int, PolarImage>& streaked = {}, bool is_synthetic = false);

}  // namespace sonarcal::report
