// A noise fit (calib/noise/noise_fit.h) as sections of a report.
#pragma once

#include <string>

#include "apps/report/html/html_report.h"
#include "calib/noise/noise_fit.h"

namespace sonarcal::report {

// Agreement, the choice of model, values, grey values recorded against predicted, noise by range and by beam,
// and the map of what is left.
void AddNoiseSections(HtmlReport& report, const calib::NoiseFit& fit, bool is_synthetic);

// "window ...": where it was found, and how.
std::string NoiseWindowText(const calib::NoiseFit& fit);

// "judged on ...": the pings that the agreement reported is on, and whether they were seen before.
std::string NoiseJudgedText(const calib::NoiseFit& fit);

}  // namespace sonarcal::report
