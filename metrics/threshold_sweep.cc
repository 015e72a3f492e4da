#include "metrics/threshold_sweep.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "core/types/error.h"

namespace sonarcal::metrics {

const std::array<SweepRatio, kSweepRatios> kSweptRatios = {{
    {"ns_over_nr", &Occupancy::ns_over_nr},
    {"na_over_ns", &Occupancy::na_over_ns},
    {"na_over_nr", &Occupancy::na_over_nr},
    {"iou", &Occupancy::iou},
    {"dice", &Occupancy::dice},
}};

SweepRange DefaultSweepRange(SegmentationMethod method) {
  switch (method) {
    case SegmentationMethod::kBackgroundSigma:
      return {0.5, 10.0};
    case SegmentationMethod::kLocalContrast:
      return {0.0, 0.5};
    case SegmentationMethod::kCaCfar:
    case SegmentationMethod::kOsCfar:
    case SegmentationMethod::kLikelihoodRatio:
      return {0.5, 8.0};
    case SegmentationMethod::kOtsu:
    case SegmentationMethod::kFixedThreshold:
    case SegmentationMethod::kTriangle:
      break;
  }
  return {0.0, 1.0};
}

void SweepOptions::Check(SegmentationMethod method) const {
  if (steps != 0 && (steps < 2 || steps > 1000)) {
    throw DataError("sweep steps is {}, expected 0 or 2 to 1000", steps);
  }
  const SweepRange range = DefaultSweepRange(method);
  const double from = low.value_or(range.low);
  const double to = high.value_or(range.high);
  if (!std::isfinite(from) || !std::isfinite(to) || !(from < to) || from < 0.0) {
    throw DataError("sweep range is {:g} to {:g}, expected 0 or more, the lower one first", from, to);
  }
}

std::vector<double> SweepSettings(const SweepOptions& options, SegmentationMethod method) {
  options.Check(method);
  const SweepRange range = DefaultSweepRange(method);
  const double low = options.low.value_or(range.low);
  const double high = options.high.value_or(range.high);
  std::vector<double> settings;
  for (int i = 0; i < options.steps; ++i) settings.push_back(low + (high - low) * i / (options.steps - 1));
  return settings;
}

ThresholdSweep::ThresholdSweep(std::vector<double> settings)
    : settings_(std::move(settings)), points_(settings_.size()) {}

void ThresholdSweep::Add(const std::vector<Occupancy>& by_setting) {
  SONARCAL_CHECK(by_setting.size() == points_.size(), "{} counts for {} settings", by_setting.size(),
                 points_.size());
  ++frames_;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    points_[i].pooled += by_setting[i];
    for (int ratio = 0; ratio < kSweepRatios; ++ratio) {
      const std::optional<double> value = (by_setting[i].*kSweptRatios[ratio].of)();
      if (!value) continue;
      points_[i].sum[ratio] += *value;
      ++points_[i].defined[ratio];
    }
  }
}

std::vector<std::optional<double>> ThresholdSweep::MicroCurve(int ratio) const {
  std::vector<std::optional<double>> curve;
  for (const Point& point : points_) curve.push_back((point.pooled.*kSweptRatios[ratio].of)());
  return curve;
}

std::vector<std::optional<double>> ThresholdSweep::MacroCurve(int ratio) const {
  std::vector<std::optional<double>> curve;
  for (const Point& point : points_) {
    curve.push_back(point.defined[ratio] > 0 ? std::optional(point.sum[ratio] / point.defined[ratio])
                                             : std::nullopt);
  }
  return curve;
}

std::optional<SweepArea> ThresholdSweep::AreaUnder(const std::vector<std::optional<double>>& curve) const {
  SONARCAL_CHECK(curve.size() == settings_.size(), "a curve of {} points, {} settings", curve.size(),
                 settings_.size());
  double integral = 0.0;
  double length = 0.0;
  for (std::size_t i = 1; i < curve.size(); ++i) {
    if (!curve[i - 1] || !curve[i]) continue;
    const double step = settings_[i] - settings_[i - 1];
    integral += 0.5 * step * (*curve[i - 1] + *curve[i]);
    length += step;
  }
  if (!(length > 0.0)) return std::nullopt;
  return SweepArea{integral / length, length / (settings_.back() - settings_.front())};
}

std::string ThresholdSweep::Csv() const {
  std::string csv = "setting,ns,nr,na";
  for (const char* way : {"micro", "macro"}) {
    for (const SweepRatio& ratio : kSweptRatios) csv += fmt::format(",{}_{}", way, ratio.name);
  }
  csv += '\n';
  std::vector<std::vector<std::optional<double>>> curves;
  for (int ratio = 0; ratio < kSweepRatios; ++ratio) curves.push_back(MicroCurve(ratio));
  for (int ratio = 0; ratio < kSweepRatios; ++ratio) curves.push_back(MacroCurve(ratio));
  for (std::size_t i = 0; i < settings_.size(); ++i) {
    const Occupancy& pooled = points_[i].pooled;
    csv += fmt::format("{},{},{},{}", settings_[i], pooled.ns, pooled.nr, pooled.na);
    for (const auto& curve : curves) csv += curve[i] ? fmt::format(",{}", *curve[i]) : ",";
    csv += '\n';
  }
  return csv;
}

}  // namespace sonarcal::metrics
