#include "apps/fit_worse.h"

#include <fmt/format.h>

namespace sonarcal {
namespace {

constexpr double kWorseShare = 0.01;  // of the figure before: the last digit that figures are quoted to

}  // namespace

std::vector<std::string> WorseFigures(const RecordingFit& fit) {
  std::vector<std::string> sentences;
  const auto add = [&](const char* figure, const char* image, const Statistic& before, const Statistic& after,
                       double better) {
    if (!before.value || !after.value) return;
    if (better * (*after.value - *before.value) >= -kWorseShare * *before.value) return;
    sentences.push_back(
        fmt::format("the fit makes the simulation worse on the {}: {} of the {} {:.3f} before, "
                    "{:.3f} after",
                    fit.judged_on_held_out ? "held-out frames" : "frames it used", figure, image,
                    *before.value, *after.value));
  };
  const IntensityDomain domain = fit.after.options.intensity_domain;
  const ViewSummary& before = fit.before.aggregate.macro.polar;
  const ViewSummary& after = fit.after.aggregate.macro.polar;
  // No detector finds an object of speckle in an image without any: occupancy is that of a sample.
  if (fit.sample_before && fit.sample_after) {
    add("IoU", "speckled sample", fit.sample_before->aggregate.macro.polar.At("iou"),
        fit.sample_after->aggregate.macro.polar.At("iou"), 1.0);
  } else {
    add("IoU", "expected image", before.At("iou"), after.At("iou"), 1.0);
  }
  if (before.Over(domain).mean_absolute.value && after.Over(domain).mean_absolute.value) {
    add("intensity error", "expected image", before.Over(domain).mean_absolute,
        after.Over(domain).mean_absolute, -1.0);
  } else {
    add("intensity error", "whole expected image", before.Over(IntensityDomain::kWhole).mean_absolute,
        after.Over(IntensityDomain::kWhole).mean_absolute, -1.0);
  }
  return sentences;
}

}  // namespace sonarcal
