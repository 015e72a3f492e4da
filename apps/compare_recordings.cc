#include "apps/compare_recordings.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <utility>

#include "data_io/types/error.h"

namespace sonarcal {
namespace {

// Says which way out there is, where the scales differ.
void CheckScales(const ImageScale& real, const ImageScale& simulated, double tolerance_db) {
  const auto check = [&](const char* field, const std::optional<double>& a, const std::optional<double>& b) {
    if (!a || !b || std::abs(*a - *b) <= tolerance_db) return;
    throw DataError(
        "{}: the real recording shows {:g} dB there, the simulated one {:g} dB; give both the same display, "
        "or "
        "compare grey levels with --as-displayed",
        field, *a, *b);
  };
  check("db_min", real.db_min, simulated.db_min);
  check("db_max", real.db_max, simulated.db_max);
}

// Settings may change from frame to frame.
void CheckSettings(const FrameInfo& real, const FrameInfo& simulated) {
  const std::string mismatch = SettingsMismatch(real.settings, simulated.settings);
  if (mismatch.empty()) return;
  throw DataError(
      "{}: {} in the real and the simulated recording: their grey values mean different things; compare them "
      "all the same with --as-displayed",
      real.name, mismatch);
}

}  // namespace

std::vector<int> FramesToCompare(const RecordingSource& real, const RecordingSource& simulated,
                                 const std::vector<int>& asked) {
  const int real_count = real.frame_count();
  const int simulated_count = simulated.frame_count();
  if (!asked.empty()) {
    const int last = *std::max_element(asked.begin(), asked.end());
    if (last >= std::min(real_count, simulated_count)) {
      throw DataError("frame {} is to be compared, but {} has {} frames and {} has {}", last,
                      real.info().source, real_count, simulated.info().source, simulated_count);
    }
    return asked;
  }
  if (real_count != simulated_count) {
    throw DataError("{} has {} frames and {} has {}, expected as many in both; choose some with --frames A:B",
                    real.info().source, real_count, simulated.info().source, simulated_count);
  }
  std::vector<int> all(static_cast<std::size_t>(real_count));
  std::iota(all.begin(), all.end(), 0);
  return all;
}

MetricsReport CompareRecordings(const RecordingSource& real, const RecordingSource& simulated,
                                const CompareRecordingsOptions& options, const OnComparedFrame& on_frame) {
  MetricsReport report{.real = RecordingName(real.info()),
                       .simulated = RecordingName(simulated.info()),
                       .options = options.compare,
                       .scale = real.info().scale,
                       .frames = {},
                       .aggregate = {},
                       .noise_floor = {},
                       .sweep = {},
                       .notes = {}};
  const std::vector<int> frames = FramesToCompare(real, simulated, options.frames);
  if (!options.as_displayed) {
    CheckScales(real.info().scale, simulated.info().scale, options.compare.db_tolerance);
  }
  report.options.keep_masks = static_cast<bool>(on_frame);
  if (real.info().sonar.axes.Matches(simulated.info().sonar.axes)) {  // else the first frame is refused
    report.options.valid = Both(real.info().valid, simulated.info().valid);
  }
  FrameComparer comparer(report.options);
  std::set<std::string> notes;
  FrameLevels levels;
  if (options.compare.sweep.steps > 0) {
    report.sweep.emplace(SweepSettings(options.compare.sweep, options.compare.segmentation.method));
  }
  for (const int index : frames) {
    const Frame real_frame = real.ReadFrame(index);
    Frame simulated_frame = simulated.ReadFrame(index);
    if (!options.as_displayed) CheckSettings(real_frame.info, simulated_frame.info);
    if (options.as_displayed) {
      ImageScale& scale = simulated_frame.image.scale;
      scale.db_min = real_frame.image.scale.db_min;
      scale.db_max = real_frame.image.scale.db_max;
      scale.db_span = real_frame.image.scale.db_span;
    }
    FrameMetrics metrics;
    try {
      const auto region = options.regions.find(index);
      if (region == options.regions.end()) {
        metrics = comparer.Compare(real_frame.image, simulated_frame.image);
      } else {
        CompareOptions of_frame = report.options;
        of_frame.region = region->second;
        metrics = CompareFrames(real_frame.image, simulated_frame.image, of_frame);
      }
    } catch (const DataError& error) {
      throw DataError("{} against {}, frame {}: {}", real.info().source, simulated.info().source, index,
                      error.what());
    }
    metrics.index = index;
    metrics.name = real_frame.info.name;
    metrics.time_s = real_frame.info.time_s;
    if (on_frame) on_frame(real_frame.image, simulated_frame.image, metrics);
    metrics.masks.reset();
    levels += metrics.levels.value();
    metrics.levels.reset();
    if (report.sweep) report.sweep->Add(metrics.sweep);
    metrics.sweep = {};
    notes.insert(metrics.notes.begin(), metrics.notes.end());
    report.frames.push_back(std::move(metrics));
    if (options.progress) options.progress(static_cast<int>(report.frames.size()));
  }
  report.aggregate = AggregateFrames(report.frames, std::move(levels));
  if (options.noise_floor) {
    // Both frames are real here: one rule for both, and no simulated object to look near to.
    CompareOptions of_floor = report.options;
    of_floor.simulated_object = SimulatedObject::kSameRule;
    of_floor.region_margin_m.reset();
    of_floor.sweep = {};
    report.noise_floor = MeasureNoiseFloor(real, of_floor);
  }
  if (options.as_displayed) {
    notes.insert("grey levels are compared as displayed: the dB scales that the two state are not looked at");
  }
  report.notes.assign(notes.begin(), notes.end());
  return report;
}

std::string RecordingName(const RecordingInfo& info) {
  return info.synthetic ? info.source + " (synthetic)" : info.source;
}

std::vector<int> TellingFrames(const MetricsReport& report) {
  const auto error_of = [&](const FrameMetrics& frame) {
    return frame.polar.intensity.Over(report.options.intensity_domain).mean_absolute().value_or(1.0);
  };
  std::vector<const FrameMetrics*> by_error;
  for (const FrameMetrics& frame : report.frames) by_error.push_back(&frame);
  std::stable_sort(by_error.begin(), by_error.end(),
                   [&](const FrameMetrics* a, const FrameMetrics* b) { return error_of(*a) < error_of(*b); });
  if (by_error.empty()) return {};
  const std::set<int> chosen = {by_error.front()->index, by_error[by_error.size() / 2]->index,
                                by_error.back()->index};
  return {chosen.begin(), chosen.end()};
}

std::vector<int> EvenlySpread(const std::vector<int>& frames, int count) {
  const int all = static_cast<int>(frames.size());
  if (count >= all) return frames;
  std::vector<int> chosen;
  for (int i = 0; i < count; ++i) {
    const std::int64_t steps = std::max(1, count - 1);
    chosen.push_back(frames[static_cast<std::size_t>(std::int64_t{i} * (all - 1) / steps)]);
  }
  return chosen;
}

}  // namespace sonarcal
