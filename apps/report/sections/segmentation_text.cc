#include "apps/report/sections/segmentation_text.h"

#include <fmt/format.h>

#include "apps/report/html/html_text.h"

namespace sonarcal::report {
namespace {

std::string RingText(const metrics::SegmentationOptions& s) {
  return fmt::format("up to {} range bins and {} beams around it, the nearest {} and {} left out",
                     s.guard_rows + s.training_rows, s.guard_cols + s.training_cols, s.guard_rows,
                     s.guard_cols);
}

// Continues the sentence "A pixel is object where it".
std::string MethodText(const metrics::SegmentationOptions& s) {
  const auto rate = [&](std::string_view against) {
    return fmt::format("is higher than {} by more than chance allows at a false-alarm rate of {:g}", against,
                       s.false_alarm_rate);
  };
  switch (s.method) {
    case metrics::SegmentationMethod::kOtsu:
      return "is above Otsu's threshold of its own image";
    case metrics::SegmentationMethod::kTriangle:
      return "is above the triangle threshold (Zack 1977) of its own image";
    case metrics::SegmentationMethod::kFixedThreshold:
      return fmt::format("is above {:g} of full scale", s.threshold_fraction);
    case metrics::SegmentationMethod::kLocalContrast:
      return (s.contrast_db ? fmt::format("is more than {:g} dB", *s.contrast_db)
                            : fmt::format("is more than {:g} of full scale", s.contrast)) +
             " above the mean of the pixels " + RingText(s);
    case metrics::SegmentationMethod::kCaCfar:
      return rate("the mean of the cells " + RingText(s));
    case metrics::SegmentationMethod::kOsCfar:
      return rate(fmt::format("the {:g} quantile of the cells ", s.os_quantile) + RingText(s));
    case metrics::SegmentationMethod::kLikelihoodRatio:
      return rate("the fitted law of the background");
    case metrics::SegmentationMethod::kBackgroundSigma:
      break;
  }
  return fmt::format(
      "is more than {:g} standard deviations above the background's median ({})", s.sigma_count,
      s.background == metrics::BackgroundSample::kRobust ? "both estimated robustly from the image itself"
                                                         : "both taken outside the region of interest");
}

std::string SmoothingText(const metrics::SegmentationOptions& s) {
  if (metrics::StatesFalseAlarmRate(s.method)) {
    return s.cell_rows * s.cell_cols == 1
               ? std::string()
               : fmt::format("Cells are means of {} range bins x {} beams. ", s.cell_rows, s.cell_cols);
  }
  std::string text;
  if (s.median_px > 0) text += fmt::format("A median of {0} x {0} pixels is taken. ", s.median_px);
  if (s.blur_rows > 0.0 || s.blur_cols > 0.0) {
    text += fmt::format("The image is smoothed by a Gaussian ({:g} range bins, {:g} beams). ", s.blur_rows,
                        s.blur_cols);
  }
  return text;
}

std::string TidyingText(const metrics::SegmentationOptions& s) {
  std::string text;
  if (s.open_rows > 1 || s.open_cols > 1) {
    text += fmt::format("Specks smaller than {} x {} pixels are removed by an opening. ", s.open_rows,
                        s.open_cols);
  }
  if (s.close_rows > 1 || s.close_cols > 1) {
    text +=
        fmt::format("Gaps smaller than {} x {} pixels are filled by a closing. ", s.close_rows, s.close_cols);
  }
  if (s.min_area_px > 0) text += fmt::format("Components below {} pixels are dropped. ", s.min_area_px);
  if (s.max_rows > 0)
    text += fmt::format("Components over more than {} range bins are dropped. ", s.max_rows);
  if (s.max_cols > 0) text += fmt::format("Components over more than {} beams are dropped. ", s.max_cols);
  if (s.largest_component_only) text += "The largest connected component is kept. ";
  if (s.fill == metrics::RegionFill::kHoles) text += "Holes are filled. ";
  if (s.fill == metrics::RegionFill::kHull) text += "Each component becomes its convex hull. ";
  return text;
}

}  // namespace

std::string DetectorText(const metrics::CompareOptions& options, bool real_is_synthetic) {
  const std::string real = RealWord(real_is_synthetic);
  const metrics::SegmentationOptions& s = options.segmentation;
  const bool echoes = options.simulated_object == metrics::SimulatedObject::kEchoes;
  std::string text = echoes ? "A detector looks for the object in the " + real + " image. "
                            : "One detector looks for the object in both images, with the same settings. ";
  text += SmoothingText(s) + "A pixel is object where it " + MethodText(s) + ". " + TidyingText(s);
  if (echoes) {
    text += fmt::format("The simulated object is where the simulation shows more than {:g} of full scale. ",
                        options.echo_fraction);
  }
  if (options.region_margin_m) {
    text += fmt::format("The {} object is looked for within {:g} m of the simulated one. ", real,
                        *options.region_margin_m);
  }
  if (const std::optional<metrics::ObjectSearch>& object = options.object) {
    text += fmt::format(
        "The object is searched in a box only, {} range bins and {} beams wider on each side than what the "
        "scene's model shows of '{}'. The box comes from the model, not from the {} image. It flatters "
        "every ratio, because nothing outside it can be taken for the object. ",
        object->margin.bins, object->margin.beams, object->material, real);
    if (options.region) text += "The box is cut to a given region of interest. ";
  } else {
    text += options.region ? "Only a given region of interest is searched. "
                           : "The whole image is searched: no region of interest was given. ";
  }
  return text + "Occupancy depends on these settings.";
}

}  // namespace sonarcal::report
