#include "apps/workflow/fit_doubts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>

namespace sonarcal::workflow {

namespace {

constexpr double kWorseShare = 0.01;  // fraction of the figure before; figures are printed to this accuracy

}  // namespace

std::vector<std::string> WorseFigures(const RecordingFit& fit) {
  std::vector<std::string> sentences;
  const auto add = [&](const char* figure, const char* image, const metrics::Statistic& before,
                       const metrics::Statistic& after, double better) {
    if (!before.value || !after.value) return;
    if (better * (*after.value - *before.value) >= -kWorseShare * *before.value) return;
    sentences.push_back(
        fmt::format("the fit makes the simulation worse on the {}: {} of the {} {:.3f} before, "
                    "{:.3f} after",
                    fit.judged_on_held_out ? "held-out frames" : "frames it used", figure, image,
                    *before.value, *after.value));
  };
  const metrics::IntensityDomain domain = fit.after.options.intensity_domain;
  const metrics::ViewSummary& before = fit.before.aggregate.macro.polar;
  const metrics::ViewSummary& after = fit.after.aggregate.macro.polar;
  // Occupancy is that of a sample: no detector finds an object of speckle in an image without speckle.
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
    add("intensity error", "whole expected image",
        before.Over(metrics::IntensityDomain::kWhole).mean_absolute,
        after.Over(metrics::IntensityDomain::kWhole).mean_absolute, -1.0);
  }
  return sentences;
}

namespace {

// Below this IoU between two samples, segmentation is too uncertain to test a pose.
constexpr double kMinOwnIou = 0.2;

// Summary of `report` over the frames that `of` contains too.
metrics::ViewSummary OverFramesOf(const metrics::MetricsReport& report, const metrics::MetricsReport& of) {
  std::vector<metrics::FrameMetrics> frames;
  for (const metrics::FrameMetrics& frame : report.frames) {
    if (std::any_of(of.frames.begin(), of.frames.end(),
                    [&](const metrics::FrameMetrics& other) { return other.index == frame.index; }))
      frames.push_back(frame);
  }
  return metrics::AggregateFrames(frames).macro.polar;
}

void DoubtObjectInView(const RecordingFit& fit, std::vector<std::string>& doubts) {
  const auto without =
      std::count_if(fit.after.frames.begin(), fit.after.frames.end(), [](const metrics::FrameMetrics& frame) {
        return frame.object_box.has_value() && frame.object_box->empty();
      });
  if (without == 0) return;
  doubts.push_back(
      fmt::format("the scene shows no pixel of the object in {} of the {} frames of the evaluation: its "
                  "poses, the scene or the name of the object may be wrong",
                  without, fit.after.frames.size()));
}

void DoubtAgreement(const RecordingFit& fit, std::vector<std::string>& doubts) {
  if (!fit.sample_after || !fit.sample_pair) return;
  const metrics::ViewSummary recorded = OverFramesOf(*fit.sample_after, *fit.sample_pair);
  const metrics::ViewSummary& own = fit.sample_pair->aggregate.macro.polar;
  const std::optional<double> own_iou = own.At("iou").value;
  const double iou = recorded.At("iou").value.value_or(0.0);
  if (own_iou && *own_iou >= kMinOwnIou && iou < kMinShareOfOwnIou * *own_iou) {
    doubts.push_back(
        fmt::format("the fit has not found the recorded object: IoU {:.2f} between the recording and a "
                    "speckled sample of the "
                    "fitted model, {:.2f} between two samples, so the standard errors do not hold",
                    iou, *own_iou));
  }
  // If neither image has an object, the whole image is compared.
  const bool has_object = recorded.Over(fit.after.options.intensity_domain).mean_absolute.value.has_value();
  const metrics::IntensityDomain domain =
      has_object ? fit.after.options.intensity_domain : metrics::IntensityDomain::kWhole;
  const std::optional<double> own_error = own.Over(domain).mean_absolute.value;
  const std::optional<double> error = recorded.Over(domain).mean_absolute.value;
  if (own_error && error && *error > kMaxTimesOwnError * *own_error) {
    doubts.push_back(
        fmt::format("the fitted model does not explain the recorded intensities: a speckled sample of it "
                    "differs from the "
                    "recording by {:.3f} of full scale, two samples differ by {:.3f}",
                    *error, *own_error));
  }
}

void DoubtResiduals(const RecordingFit& fit, std::vector<std::string>& doubts) {
  const double spread = fit.fit.report.whitened.spread;
  if (fit.fit.parameters.model != EchoModel::kAcoustic || !(spread > kMaxSpread)) return;
  doubts.push_back(fmt::format(
      "the residuals of the frames used spread {:.1f} times as far as speckle and noise allow", spread));
}

void DoubtPoses(const calib::FitReport& report, const calib::FitConfig& config,
                std::vector<std::string>& doubts) {
  for (const calib::FittedParameter& parameter : report.parameters) {
    if (!parameter.name.starts_with("pose.") || parameter.status == calib::ParameterStatus::kFixed) continue;
    const bool is_angle = parameter.unit == "deg";
    double about = parameter.initial;
    double sigma = is_angle ? config.pose_prior.angle_deg : config.pose_prior.position_m;
    if (const auto given = config.priors.find(parameter.name); given != config.priors.end()) {
      if (!given->second) continue;
      std::tie(about, sigma) = *given->second;
    }
    const double moved = is_angle ? std::remainder(parameter.value - about, 360.0) : parameter.value - about;
    if (!(std::abs(moved) > kMaxPriorSigmas * sigma)) continue;
    doubts.push_back(fmt::format("{} ended {:.3g} {} from its prior, {:.1f} standard deviations",
                                 parameter.name, std::abs(moved), parameter.unit, std::abs(moved) / sigma));
  }
}

}  // namespace

std::vector<std::string> DoubtsAbout(const RecordingFit& fit, const calib::FitConfig& config) {
  std::vector<std::string> doubts;
  DoubtObjectInView(fit, doubts);
  DoubtAgreement(fit, doubts);
  DoubtResiduals(fit, doubts);
  DoubtPoses(fit.fit.report, config, doubts);
  return doubts;
}

}  // namespace sonarcal::workflow
