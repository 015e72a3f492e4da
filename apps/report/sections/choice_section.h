// Selection of the model (calib/selection/model_choice.h) as a section of a report, as text and as JSON.
#pragma once

#include <string>

#include "apps/report/html/html_report.h"
#include "calib/selection/model_choice.h"

namespace sonarcal::report {

// Adds the table of all variants with an explanation. Must be within a section.
void AddModelChoice(HtmlReport& report, const calib::ModelChoice& choice);

// Returns text for a terminal, one line per variant.
std::string ModelChoiceText(const calib::ModelChoice& choice);

// {"frames": [...], "pixels", "blocks", "tie_sigmas", "axes": [{"axis", "variants": [{"name",
// "nats_per_pixel", "behind_best", "behind_best_sigma", "fitted_values", "given", "usable", "tied",
// "chosen"}], "notes": [...]}]}
std::string ModelChoiceJson(const calib::ModelChoice& choice);

}  // namespace sonarcal::report
