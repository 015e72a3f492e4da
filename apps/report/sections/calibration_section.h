// A calibration (apps/workflow/calibration/calibrate.h) as sections of a report and as text for the terminal.
#pragma once

#include <string>

#include "apps/report/html/html_report.h"
#include "apps/workflow/calibration/calibrate.h"

namespace sonarcal::report {

// Adds agreement, decisions, geometry and values. Opens with a frame and two sentences: how far the simulator
// is from the recording, beside the lowest error possible, and what the recording could not determine.
void AddCalibration(HtmlReport& report, const workflow::Calibration& calibration, bool is_synthetic,
                    const std::string& recording);

// Short form of these sections.
std::string CalibrationText(const workflow::Calibration& calibration);

}  // namespace sonarcal::report
