#include "apps/workflow/compare.h"

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <span>
#include <utility>

#include "apps/workflow/drawn_floor.h"
#include "apps/workflow/scene_geometry.h"
#include "core/types/error.h"
#include "core/types/pose.h"
#include "core/types/units.h"
#include "metrics/json/against.h"

namespace sonarcal::workflow {

namespace {

// States in which way the scales differ.
void CheckScales(const ImageScale& real, const ImageScale& simulated, double tolerance_db) {
  const auto check = [&](const char* field, const std::optional<double>& a, const std::optional<double>& b) {
    if (!a || !b || std::abs(*a - *b) <= tolerance_db) return;
    throw DataError(
        "{}: the real recording shows {:g} dB there, the simulated one {:g} dB; give both the same display, "
        "or compare grey levels with --as-displayed",
        field, *a, *b);
  };
  check("db_min", real.db_min, simulated.db_min);
  check("db_max", real.db_max, simulated.db_max);
}

// Settings may change from frame to frame.
void CheckSameSettings(const FrameInfo& real, const FrameInfo& simulated) {
  const std::string mismatch = SettingsMismatch(real.settings, simulated.settings);
  if (mismatch.empty()) return;
  throw DataError(
      "{}: {} in the real and the simulated recording: their grey values mean different things; compare them "
      "anyway with --as-displayed",
      real.name, mismatch);
}

struct Pair {
  Frame real;
  Frame simulated;
  metrics::FrameMetrics metrics;
  std::string error;  // reason why the pair cannot be compared; empty: none
};

// Pairs of frames. Reads one after the other, because recordings ask for that. Compares in parallel.
class PairComparer {
 public:
  PairComparer(const RecordingSource& real, const RecordingSource& simulated,
               const CompareRecordingsOptions& options, const metrics::CompareOptions& compare)
      : real_(real), simulated_(simulated), options_(options), compare_(compare), comparers_([this] {
          return metrics::FrameComparer(compare_);
        }) {}

  // Returns pairs in the order of `frames`. Throws DataError for the first pair that cannot be compared.
  std::vector<Pair> Compare(std::span<const int> frames) {
    std::vector<Pair> pairs;
    for (const int frame : frames) pairs.push_back(Read(frame));
    tbb::parallel_for(std::size_t{0}, pairs.size(), [&](std::size_t i) { Compare(frames[i], pairs[i]); });
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      if (pairs[i].error.empty()) continue;
      throw DataError("{} against {}, frame {}: {}", real_.info().source, simulated_.info().source, frames[i],
                      pairs[i].error);
    }
    return pairs;
  }

 private:
  Pair Read(int frame) const {
    Pair pair{
        .real = real_.ReadFrame(frame), .simulated = simulated_.ReadFrame(frame), .metrics = {}, .error = {}};
    if (!options_.as_displayed) {
      CheckSameSettings(pair.real.info, pair.simulated.info);
      return pair;
    }
    ImageScale& scale = pair.simulated.image.scale;
    scale.db_min = pair.real.image.scale.db_min;
    scale.db_max = pair.real.image.scale.db_max;
    scale.db_span = pair.real.image.scale.db_span;
    return pair;
  }

  // Null without an object.
  const metrics::PixelBox* BoxFor(int frame, const Pair& pair) const {
    if (!compare_.object) return nullptr;
    const auto box = options_.boxes.find(frame);
    SONARCAL_CHECK(box != options_.boxes.end(), "no box for the object in frame {}", frame);
    std::string why;
    if (!real_.info().sonar.axes.Matches(pair.real.image.axes, &why)) {
      throw DataError("the frame and the recording have {}; expected the same, to search the object '{}'",
                      why, compare_.object->material);
    }
    return &box->second;
  }

  void Compare(int frame, Pair& pair) {
    try {
      pair.metrics = comparers_.local().Compare(pair.real.image, pair.simulated.image, BoxFor(frame, pair));
    } catch (const DataError& error) {
      pair.error = error.what();
    }
    pair.metrics.index = frame;
    pair.metrics.name = pair.real.info.name;
    pair.metrics.time_s = pair.real.info.time_s;
  }

  const RecordingSource& real_;
  const RecordingSource& simulated_;
  const CompareRecordingsOptions& options_;
  const metrics::CompareOptions& compare_;
  tbb::enumerable_thread_specific<metrics::FrameComparer> comparers_;
};

// True if the recording states that the sonar moves between a frame and the next one.
bool MovesAfter(const RecordingSource& recording, int frame) {
  const std::optional<Pose> pose = recording.frame_info(frame).world_from_sonar;
  const std::optional<Pose> next = recording.frame_info(frame + 1).world_from_sonar;
  return pose && next && !IsSamePose(*pose, *next);
}

// The recording with the poses of a simulation that moves, where it has none: frames that follow each other
// show different things then.
class WithPosesOf final : public RecordingSource {
 public:
  WithPosesOf(const RecordingSource& real, const RecordingSource& simulated)
      : real_(real), simulated_(simulated) {
    if (simulated.frame_count() != real.frame_count()) return;
    for (int i = 0; i + 1 < simulated.frame_count() && !moves_; ++i) moves_ = MovesAfter(simulated, i);
  }

  const RecordingInfo& info() const override { return real_.info(); }
  int frame_count() const override { return real_.frame_count(); }
  FrameInfo frame_info(int index) const override { return Posed(real_.frame_info(index), index); }
  Frame ReadFrame(int index) const override {
    Frame frame = real_.ReadFrame(index);
    frame.info = Posed(std::move(frame.info), index);
    return frame;
  }

 private:
  FrameInfo Posed(FrameInfo info, int index) const {
    if (!info.world_from_sonar && moves_)
      info.world_from_sonar = simulated_.frame_info(index).world_from_sonar;
    return info;
  }

  const RecordingSource& real_;
  const RecordingSource& simulated_;
  bool moves_ = false;
};

}  // namespace

std::set<int> FramesWithBoxes(const RecordingSource& real, const std::vector<int>& compared) {
  constexpr int kFloorPairs = 100;  // metrics::MeasureNoiseFloor
  std::set<int> frames(compared.begin(), compared.end());
  int pairs = 0;
  for (int i = 0; i + 1 < real.frame_count() && pairs < kFloorPairs; ++i) {
    if (MovesAfter(real, i)) continue;
    frames.insert(i);
    ++pairs;
  }
  return frames;
}

std::vector<int> FramesToCompare(const RecordingSource& real, const RecordingSource& simulated,
                                 const std::vector<int>& asked) {
  const int real_count = real.frame_count();
  const int simulated_count = simulated.frame_count();
  if (!asked.empty()) {
    const int last = *std::max_element(asked.begin(), asked.end());
    const int first = *std::min_element(asked.begin(), asked.end());
    if (first < 0 || last >= std::min(real_count, simulated_count)) {
      throw DataError("frame {} is to be compared, but {} has {} frames and {} has {}",
                      first < 0 ? first : last, real.info().source, real_count, simulated.info().source,
                      simulated_count);
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

std::optional<Mask> ValidInBoth(const RecordingInfo& real, const RecordingInfo& simulated) {
  if (!real.sonar.axes.Matches(simulated.sonar.axes)) return std::nullopt;
  return Both(real.valid, simulated.valid);
}

metrics::MetricsReport CompareRecordings(const RecordingSource& real, const RecordingSource& simulated,
                                         const CompareRecordingsOptions& options,
                                         const OnComparedFrame& on_frame) {
  metrics::MetricsReport report{.real = RecordingName(real.info()),
                                .simulated = RecordingName(simulated.info()),
                                .real_is_synthetic = real.info().synthetic,
                                .options = options.compare,
                                .scale = real.info().scale,
                                .frames = {},
                                .aggregate = {},
                                .noise_floor = {},
                                .sweep = {},
                                .notes = {}};
  std::vector<int> frames;  // whose images are compared
  if (options.measured == nullptr) frames = FramesToCompare(real, simulated, options.frames);
  if (!options.as_displayed) {
    CheckScales(real.info().scale, simulated.info().scale, options.compare.db_tolerance);
  }
  report.options.keep_masks = static_cast<bool>(on_frame);
  report.options.valid = ValidInBoth(real.info(), simulated.info());
  std::set<std::string> notes;
  metrics::FrameLevels levels;
  if (options.compare.sweep.steps > 0) {
    report.sweep.emplace(metrics::SweepSettings(options.compare.sweep, options.compare.segmentation.method));
  }
  const auto take = [&](metrics::FrameMetrics& metrics) {
    metrics.masks.reset();
    if (metrics.levels) levels += *metrics.levels;
    metrics.levels.reset();
    if (report.sweep) report.sweep->Add(metrics.sweep);
    metrics.sweep = {};
    notes.insert(metrics.notes.begin(), metrics.notes.end());
    report.frames.push_back(std::move(metrics));
    if (options.progress) options.progress(static_cast<int>(report.frames.size()));
  };
  PairComparer comparer(real, simulated, options, report.options);
  const std::size_t at_once = 2 * static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
  for (std::size_t first = 0; first < frames.size(); first += at_once) {
    const std::size_t count = std::min(at_once, frames.size() - first);
    for (Pair& pair : comparer.Compare({frames.data() + first, count})) {
      if (on_frame) on_frame(pair.real.image, pair.simulated.image, pair.metrics);
      take(pair.metrics);
    }
  }
  if (options.measured != nullptr) {
    levels = options.measured->levels;
    notes.insert(options.measured->notes.begin(), options.measured->notes.end());
    for (metrics::FrameMetrics frame : options.measured->frames) take(frame);
  }
  report.aggregate = metrics::AggregateFrames(report.frames, std::move(levels));
  if (options.noise_floor) {
    // Both frames are real here. They are segmented by one rule, and there is no simulated object to search
    // around.
    metrics::CompareOptions of_floor = report.options;
    of_floor.simulated_object = metrics::SimulatedObject::kSameRule;
    of_floor.region_margin_m.reset();
    of_floor.sweep = {};
    const WithPosesOf posed(real, simulated);
    report.noise_floor = metrics::MeasureNoiseFloor(posed, of_floor, options.boxes);
    if (report.noise_floor.source() == metrics::FloorSource::kRealAgainstReal) {
      const std::vector<std::string>& assumptions = report.noise_floor.real_against_real.notes;
      notes.insert(assumptions.begin(), assumptions.end());
    }
  }
  if (options.as_displayed) {
    notes.insert("grey levels are compared as displayed; the dB scales of the recordings are ignored");
  }
  for (const auto& [name, value] : simulated.info().details) {
    if (simulated.info().synthetic && name == "noise")
      notes.insert(fmt::format("noise in the simulated images: {}", value));
  }
  report.notes.assign(notes.begin(), notes.end());
  return report;
}

void CompareAgain(const RecordingSource& real, const RecordingSource& simulated,
                  const CompareRecordingsOptions& options, const std::vector<int>& frames,
                  const OnComparedFrame& on_frame) {
  CompareRecordingsOptions again = options;
  again.frames = frames;
  again.noise_floor = false;
  again.measured = nullptr;
  again.compare.sweep = {};
  again.progress = {};
  CompareRecordings(real, simulated, again, on_frame);
}

std::vector<ComparedFrame> ComparedFrames(const RecordingSource& real, const RecordingSource& simulated,
                                          const CompareRecordingsOptions& options,
                                          const std::vector<int>& frames) {
  std::vector<ComparedFrame> compared;
  CompareAgain(
      real, simulated, options, frames,
      [&](const PolarImage& recorded, const PolarImage& rendered, const metrics::FrameMetrics& metrics) {
        compared.push_back({recorded, rendered, metrics});
      });
  return compared;
}

std::vector<int> SpreadFrames(const metrics::MetricsReport& report, const std::vector<int>& always,
                              std::size_t count) {
  std::set<int> chosen(always.begin(), always.end());
  const std::size_t frames = report.frames.size();
  // Takes halves, quarters, eighths ... of the recording until there are enough frames.
  for (std::size_t parts = 1; parts <= 2 * frames; parts *= 2) {
    for (std::size_t i = 0; i <= parts; ++i) {
      if (chosen.size() >= count) return {chosen.begin(), chosen.end()};
      const std::size_t place = std::min(frames - 1, i * frames / parts);
      chosen.insert(report.frames[place].index);
    }
  }
  return {chosen.begin(), chosen.end()};
}

std::string RecordingName(const RecordingInfo& info) {
  return info.synthetic ? info.source + " (synthetic)" : info.source;
}

std::vector<int> RepresentativeFrames(const metrics::MetricsReport& report) {
  const auto error_of = [&](const metrics::FrameMetrics& frame) {
    return frame.polar.intensity.Over(report.options.intensity_domain).mean_absolute().value_or(1.0);
  };
  std::vector<const metrics::FrameMetrics*> by_error;
  for (const metrics::FrameMetrics& frame : report.frames) by_error.push_back(&frame);
  std::stable_sort(by_error.begin(), by_error.end(),
                   [&](const metrics::FrameMetrics* a, const metrics::FrameMetrics* b) {
                     return error_of(*a) < error_of(*b);
                   });
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

namespace {

metrics::SweepOptions SweepOf(const CompareOptions& options) {
  metrics::SweepOptions sweep{.steps = options.sweep_steps, .low = {}, .high = {}};
  if (options.sweep_range) {
    sweep.low = options.sweep_range->low;
    sweep.high = options.sweep_range->high;
  }
  return sweep;
}

std::string NameOfEarlier(const CompareOptions& options) {
  return options.against.file.empty() ? "against" : options.against.file.string();
}

// Search boxes of the object. A frame without any pose has none, and throws DataError if it is compared.
std::map<int, metrics::PixelBox> ObjectBoxes(const RecordingSource& real, const RecordingSource& simulated,
                                             const std::vector<int>& compared, const SceneGeometry& geometry,
                                             const metrics::ObjectSearch& object) {
  std::map<int, metrics::PixelBox> boxes;
  for (const int frame : FramesWithBoxes(real, compared)) {
    if (const std::optional<Pose> pose = PoseInScene(real, simulated, frame)) {
      boxes.emplace(frame, geometry.ObjectBox(*pose, object));
    } else if (std::ranges::find(compared, frame) != compared.end()) {
      throw DataError(
          "frame {} has no 'world_from_sonar' in {} and in {}, expected it in one of them, to "
          "search the object '{}'",
          frame, real.info().source, simulated.info().source, object.material);
    }
  }
  return boxes;
}

// Frames are paired by their numbers. Says so if both recordings state poses for them, and they are further
// apart than the sonar resolves.
std::optional<std::string> NoteOfPosesApart(const RecordingSource& real, const RecordingSource& simulated,
                                            const std::vector<int>& frames) {
  const PolarAxes& axes = real.info().sonar.axes;
  int apart = 0;
  double largest_m = 0.0;
  double largest_rad = 0.0;
  for (const int frame : frames) {
    const std::optional<Pose> a = real.frame_info(frame).world_from_sonar;
    const std::optional<Pose> b = simulated.frame_info(frame).world_from_sonar;
    if (!a || !b) continue;
    const double distance_m = (a->position_m - b->position_m).norm();
    const double turn_rad = a->rotation.angularDistance(b->rotation);
    if (distance_m <= axes.range_bin_m() && turn_rad <= axes.beam_spacing_rad()) continue;
    ++apart;
    largest_m = std::max(largest_m, distance_m);
    largest_rad = std::max(largest_rad, turn_rad);
  }
  if (apart == 0) return std::nullopt;
  return fmt::format(
      "frames are paired by number: in {} of {}, the poses that both recordings state are more than a range "
      "bin or a beam apart, by up to {:.3g} m and {:.3g} deg",
      apart, frames.size(), largest_m, DegFromRad(largest_rad));
}

}  // namespace

Comparison Compare(const RecordingSource& real, const RecordingSource& simulated,
                   const CompareOptions& options, const Scene* scene, bool residuals_by_scene,
                   const Listener& listener, const OnComparedFrame& on_frame) {
  Comparison comparison{.options = {.compare = options.comparison.For(real.info().sonar.axes),
                                    .as_displayed = options.as_displayed,
                                    .noise_floor = options.whole,
                                    .measured = options.measured},
                        .frames = {},
                        .metrics = {}};
  CompareRecordingsOptions& compare = comparison.options;
  if (options.against) metrics::CheckIsComparison(*options.against.value, NameOfEarlier(options));
  compare.compare.sweep = SweepOf(options);
  compare.compare.Check();
  compare.frames = options.frames;
  comparison.frames = FramesToCompare(real, simulated, compare.frames);
  const int total = static_cast<int>(comparison.frames.size());
  listener.Progress("Comparing", 0, total);
  compare.progress = [&](int done) { listener.Progress("Comparing", done, total); };

  std::optional<SceneGeometry> geometry;
  if (scene != nullptr) geometry.emplace(*scene, real.info().sonar);
  if (compare.compare.object) {
    if (!geometry) throw UsageError("--object needs --scene, because neither recording names its scene");
    CheckObject(*compare.compare.object, geometry->material_names());
    compare.boxes = ObjectBoxes(real, simulated, comparison.frames, *geometry, *compare.compare.object);
  }
  FrameGatherer gatherer(real, simulated, geometry && residuals_by_scene ? &*geometry : nullptr);
  metrics::MetricsReport& metrics = comparison.metrics;
  metrics = CompareRecordings(
      real, simulated, compare,
      [&](const PolarImage& recorded, const PolarImage& rendered, const metrics::FrameMetrics& frame) {
        gatherer.Add(recorded, rendered, frame);
        if (on_frame) on_frame(recorded, rendered, frame);
      });
  compare.progress = {};
  if (options.measured == nullptr) {
    gatherer.MoveInto(metrics);
  } else {
    metrics.residuals = options.measured->residuals;
    metrics.residuals_by_scene = options.measured->residuals_by_scene;
  }
  if (options.whole) {
    if (const std::optional<std::string> note = NoteOfPosesApart(real, simulated, comparison.frames))
      metrics.notes.push_back(*note);
  }
  if (options.params) {
    metrics.noise_floor.drawn =
        DrawFloor(simulated, comparison.frames, *options.params.value, metrics.options, compare.boxes);
  }
  if (options.against) {
    metrics.against = metrics::CompareAgainst(metrics, *options.against.value, NameOfEarlier(options));
  }
  return comparison;
}

}  // namespace sonarcal::workflow
