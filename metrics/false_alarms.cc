#include "metrics/false_alarms.h"

#include <cmath>
#include <numeric>
#include <utility>

#include "metrics/segmentation/scored_image.h"

namespace sonarcal::metrics {
namespace {

SegmentationOptions WithoutTidying(SegmentationOptions options) {
  options.open_rows = options.open_cols = 0;
  options.close_rows = options.close_cols = 0;
  options.min_area_px = options.max_rows = options.max_cols = 0;
  options.largest_component_only = false;
  options.fill = RegionFill::kNone;
  return options;
}

double Share(std::int64_t part, std::int64_t of) {
  return of == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(of);
}

std::optional<Interval> IntervalOf(const std::vector<std::int64_t>& alarms,
                                   const std::vector<std::int64_t>& pixels) {
  const int pings = static_cast<int>(pixels.size());
  if (pings < kBootstrapMinFrames) return std::nullopt;
  std::vector<double> series;
  for (std::size_t i = 0; i < pixels.size(); ++i) series.push_back(Share(alarms[i], pixels[i]));
  FrameResampler resampler(pings, PolitisWhiteBlockLength(series));
  std::vector<double> draws;
  for (int draw = 0; draw < kBootstrapDraws; ++draw) {
    std::int64_t drawn_alarms = 0;
    std::int64_t drawn_pixels = 0;
    for (const int ping : resampler.Next()) {
      drawn_alarms += alarms[ping];
      drawn_pixels += pixels[ping];
    }
    draws.push_back(Share(drawn_alarms, drawn_pixels));
  }
  return PercentileInterval95(std::move(draws));
}

}  // namespace

double FalseAlarmRate::realised() const {
  return Share(alarms, pixels);
}

FalseAlarmCounter::FalseAlarmCounter(SegmentationOptions options, const std::vector<double>& rates)
    : options_(WithoutTidying(std::move(options))) {
  for (const auto& [word, method] : WordsOf(std::type_identity<SegmentationMethod>())) {
    if (method == SegmentationMethod::kLikelihoodRatio && !options_.background_law) continue;
    if (!StatesFalseAlarmRate(method)) {
      rows_.push_back({.method = method, .stated = {}, .alarms = {}});
      continue;
    }
    for (const double rate : rates) {
      options_.false_alarm_rate = rate;
      options_.Check();
      rows_.push_back({.method = method, .stated = rate, .alarms = {}});
    }
  }
}

void FalseAlarmCounter::Add(const PolarImage& ping, const Mask* region) {
  std::optional<ScoredImage> scored;  // the rows of one method share it
  SegmentationMethod method{};
  for (Row& row : rows_) {
    if (!scored || row.method != method) {
      method = row.method;
      options_.method = method;
      scored.emplace(ping.value, ping.scale, options_, region, nullptr);
    }
    const double setting = row.stated ? -std::log10(*row.stated) : scored->setting();
    row.alarms.push_back(scored->any_pixel() ? CountSet(scored->ObjectAbove(scored->ThresholdAt(setting)))
                                             : 0);
  }
  pixels_.push_back(region == nullptr ? static_cast<std::int64_t>(ping.value.size()) : CountSet(*region));
}

std::vector<FalseAlarmRate> FalseAlarmCounter::Rates() const {
  const std::int64_t pixels = std::accumulate(pixels_.begin(), pixels_.end(), std::int64_t{0});
  std::vector<FalseAlarmRate> rates;
  for (const Row& row : rows_) {
    rates.push_back({.method = row.method,
                     .stated = row.stated,
                     .pixels = pixels,
                     .alarms = std::accumulate(row.alarms.begin(), row.alarms.end(), std::int64_t{0}),
                     .ci = IntervalOf(row.alarms, pixels_)});
  }
  return rates;
}

}  // namespace sonarcal::metrics
