// Values of the paper (Park 2024 Tables 4 and 5), and one rule for the values that the paper does not give:
// dB_min, dB_max and the sizes of the range and azimuth errors. Every command takes its start values for the
// paper's model from here.
//
// Display. The paper divides a pixel's sum by the number of rays per beam, but only few rays of a beam fall
// into one pixel. If dB_min .. dB_max covered the whole range of levels, images would be nearly black.
// Therefore
//
//   dB_min = SL - 50 dB: a target of 0 dB (GSAB = 1) is black beyond the range R where 2 TL = 50 dB, which
//            is 12.7 m at 900 kHz in fresh water, beyond the paper's window of 9 m;
//   dB_max = dB_min + 3 dB: a pixel that holds 1 % of its beam's rays, x dB above dB_min, has x / 3 % of
//            full scale.
//
// With the paper's source level of 200 dB, the display covers 150 to 153 dB.
//
// Errors. Half a range bin and half a beam, at the sonar's own frequency.
#pragma once

#include <string>
#include <vector>

#include "core/types/parameters.h"

namespace sonarcal::sim {

inline constexpr double kPaperSourceLevelDb = 200.0;
inline constexpr double kPaperBlackBelowSourceDb = 50.0;
inline constexpr double kPaperDisplaySpanDb = 3.0;

inline DisplayParameters<double> PaperDisplay(double source_level_db = kPaperSourceLevelDb) {
  const double db_min = source_level_db - kPaperBlackBelowSourceDb;
  return {.db_min = db_min, .db_max = db_min + kPaperDisplaySpanDb};
}

// Text of the rule for reports.
inline constexpr const char* kPaperDisplayRule =
    "The paper does not give dB_min, dB_max and the sizes of the range and azimuth errors. The rule here is "
    "the same everywhere: dB_min is 50 dB below the source level, dB_max is 3 dB above dB_min, and the "
    "errors are half a range bin and half a beam. The display is so narrow because the paper divides a pixel "
    "by all rays of its beam, of which few fall into one pixel.";

// Values of the paper with this rule, for the sonar's range bin and beam width. Each material has the GSAB
// values of Table 4 under its own name.
ParameterSet PaperValues(const SonarModel& sonar, const std::vector<std::string>& material_names);

}  // namespace sonarcal::sim
