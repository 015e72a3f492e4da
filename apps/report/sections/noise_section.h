// A noise fit (calib/noise/noise_fit.h) as sections of a report.
#pragma once

#include <string>

#include "apps/report/html/html_report.h"
#include "calib/noise/noise_fit.h"

namespace sonarcal::report {

// Adds agreement, the selection of the model, values, recorded and predicted grey values, noise by range and
// by beam, and the map of residuals.
void AddNoiseSections(HtmlReport& report, const calib::NoiseFit& fit, bool is_synthetic);

// Text "window ...": the window and how it was found.
std::string NoiseWindowText(const calib::NoiseFit& fit);

// Text "judged on ...": the pings of the reported agreement, and whether the selection used them.
std::string NoiseJudgedText(const calib::NoiseFit& fit);

}  // namespace sonarcal::report
