#include "calib/degenerate_fit.h"

#include <fmt/format.h>

#include <algorithm>

namespace sonarcal::calib {
namespace {

// One value at a bound may be a curve without that term. Two or more mean that the model needs values beyond
// the bounds.
constexpr std::size_t kBoundsTolerated = 1;
// Limit for the share of pixels with echoes that are clipped in the model, minus the share in the recording.
constexpr double kClippedTolerated = 0.1;
// The paper's model needs 1 to 3 dB, because it divides a pixel by all rays of its beam. Includes the
// rounding of a bound.
constexpr double kNarrowSpanDb = 1.001;
// Two optima are equally good below this relative difference of cost.
constexpr double kEqualCost = 0.01;

}  // namespace

std::vector<std::string> DegenerateFitWarnings(const FitReport& report, const PaperClipping& clipping,
                                               const std::vector<OtherOptimum>& others) {
  std::vector<std::string> warnings;
  std::vector<std::string> at_bounds;
  std::size_t fitted = 0;
  for (const FittedParameter& parameter : report.parameters) {
    if (parameter.status == ParameterStatus::kFixed) continue;
    ++fitted;
    if (parameter.status == ParameterStatus::kAtBound) at_bounds.push_back(parameter.name);
  }
  if (at_bounds.size() > kBoundsTolerated) {
    warnings.push_back(
        fmt::format("the fit is degenerate: {} of {} free values ended at a bound ({}), so the model asks "
                    "for values that "
                    "no surface or display has",
                    at_bounds.size(), fitted, fmt::join(at_bounds, ", ")));
  }
  if (clipping.modelled > clipping.recorded + kClippedTolerated) {
    warnings.push_back(
        fmt::format("the fit is degenerate: {:.0f} % of the pixels in which the model shows an echo are at "
                    "full scale there, "
                    "{:.0f} % of the same pixels in the recording, so the model makes outlines, not levels",
                    100.0 * clipping.modelled, 100.0 * clipping.recorded));
  }
  const FittedParameter* high = report.Find("display.db_max");
  const FittedParameter* low = report.Find("display.db_min");
  const bool span_is_fitted =
      high != nullptr && low != nullptr &&
      (high->status != ParameterStatus::kFixed || low->status != ParameterStatus::kFixed);
  if (span_is_fitted && high->value - low->value <= kNarrowSpanDb) {
    warnings.push_back(fmt::format(
        "the fit is degenerate: the fitted display spans {:.2g} dB, and with 1 dB or less the model makes "
        "outlines, not levels",
        high->value - low->value));
  }
  for (const OtherOptimum& other : others) {
    if (other.difference < kOtherImage || other.cost > (1.0 + kEqualCost) * report.cost_final) continue;
    warnings.push_back(fmt::format(
        "the fit has several optima: another start ended at a cost of {:.6g} beside {:.6g}, with images that "
        "differ by {:.3f} of full scale (RMS)",
        other.cost, report.cost_final, other.difference));
    break;
  }
  return warnings;
}

}  // namespace sonarcal::calib
