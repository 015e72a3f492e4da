// The choice of a model (calib/selection/model_choice.h) as a section of a report, as text and as JSON.
#pragma once

#include <string>

#include "apps/report/html/html_report.h"
#include "calib/selection/model_choice.h"

namespace sonarcal::report {

// The table of all variants, and how to read it. Within a section.
void AddModelChoice(HtmlReport& report, const calib::ModelChoice& choice);

// The same for a terminal, a line a variant.
std::string ModelChoiceText(const calib::ModelChoice& choice);

// {"frames": [...], "pixels", "blocks", "tie_sigmas", "axes": [{"axis", "variants": [{"name",
// "nats_per_pixel", "behind_best", "behind_best_sigma", "fitted_values", "given", "usable", "tied",
// "chosen"}], "notes": [...]}]}
std::string ModelChoiceJson(const calib::ModelChoice& choice);

}  // namespace sonarcal::report
