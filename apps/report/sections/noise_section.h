// A noise fit (calib/noise/noise_fit.h) and the judgement of a noise law (calib/noise/noise_judgement.h) as
// sections of a report, as text and as JSON.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

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

// Text "params.json holds ...": the pings of the law that is the result.
std::string NoiseResultText(const calib::NoiseFit& fit);

// Text "level over frames ...": trend of the level of the pings, and whether it is significant.
std::string NoiseDriftText(const calib::NoiseJudgement& judgement);

// Figures of a law on pings, two lines.
std::string NoiseAgreementText(const calib::NoiseAgreement& agreement);

// Figures, worst pings and cells, and drift.
std::string NoiseJudgementText(const calib::NoiseJudgement& judgement, bool is_synthetic);

// Adds figures, worst pings and cells, grey values, residuals and drift.
void AddNoiseJudgement(HtmlReport& report, const calib::NoiseJudgement& judgement, bool is_synthetic);

// Keys: docs/reference/fit_json.md, and docs/guide/noise.md for the judgement.
nlohmann::ordered_json NoiseAgreementJson(const calib::NoiseAgreement& agreement);
nlohmann::ordered_json NoiseDriftJson(const calib::NoiseJudgement& judgement);
nlohmann::ordered_json NoiseJudgementJson(const calib::NoiseJudgement& judgement);
// Members of judgement.json: those above and the format.
nlohmann::ordered_json NoiseJudgementFileJson(const calib::NoiseJudgement& judgement);

}  // namespace sonarcal::report
