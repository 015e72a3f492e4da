#include "metrics/noise_floor.h"

#include <cmath>
#include <numbers>
#include <utility>

#include "core/types/pose.h"
#include "core/types/units.h"

namespace sonarcal::metrics {
namespace {

enum class Motion { kStatic, kMoved, kUnknown };

Motion Between(const FrameInfo& a, const FrameInfo& b) {
  if (!a.world_from_sonar || !b.world_from_sonar) return Motion::kUnknown;
  return IsSamePose(*a.world_from_sonar, *b.world_from_sonar) ? Motion::kStatic : Motion::kMoved;
}

}  // namespace

double SingleLookPairDifferenceDb() {
  return kDbPerNeper * 2.0 * std::numbers::ln2;
}

double SingleLookMeanDifferenceDb() {
  // X = ln U, U exponential, has the mean m = -gamma, so E|X - m| = 2 E[(X - m)+], and
  // E[(X - m)+] = integral of P(U > e^x) over x > m = E1(e^m); E1(x) = -Ei(-x).
  return kDbPerNeper * 2.0 * -std::expint(-std::exp(-std::numbers::egamma));
}

std::optional<SpeckleFloor> SpeckleFloorFor(const ImageScale& scale) {
  const std::optional<double> span_db = DbSpan(scale);
  if (!span_db) return std::nullopt;
  if (!(std::isfinite(*span_db) && *span_db > 0.0)) {
    throw DataError("the display spans {} dB, expected more than 0", *span_db);
  }
  return SpeckleFloor{*span_db, SingleLookPairDifferenceDb() / *span_db,
                      SingleLookMeanDifferenceDb() / *span_db};
}

RealAgainstReal CompareRealWithReal(const RecordingSource& real, const CompareOptions& options,
                                    const std::map<int, PixelBox>& boxes, int max_pairs) {
  RealAgainstReal result;
  CompareOptions of_real = options;
  of_real.valid = Both(options.valid, real.info().valid);
  FrameComparer comparer(std::move(of_real));
  FrameLevels levels;
  bool lacks_box = false;        // some still pair has no box
  std::optional<Frame> earlier;  // frame i, if the previous pair has already read it
  for (int i = 0; i + 1 < real.frame_count() && static_cast<int>(result.pairs.size()) < max_pairs; ++i) {
    const Motion motion = Between(real.frame_info(i), real.frame_info(i + 1));
    const auto box = boxes.find(i);
    const bool has_no_box = box == boxes.end() && !boxes.empty();
    if (motion == Motion::kMoved || has_no_box) {
      lacks_box |= motion != Motion::kMoved;
      earlier.reset();
      continue;
    }
    result.assumed_still |= motion == Motion::kUnknown;
    if (!earlier) earlier = real.ReadFrame(i);
    Frame later = real.ReadFrame(i + 1);
    FrameMetrics pair =
        comparer.Compare(earlier->image, later.image, box == boxes.end() ? nullptr : &box->second);
    pair.index = i;
    pair.name = fmt::format("{} and {}", earlier->info.name, later.info.name);
    pair.time_s = earlier->info.time_s;
    levels += *pair.levels;
    pair.levels.reset();
    result.pairs.push_back(std::move(pair));
    earlier = std::move(later);
  }
  result.aggregate = AggregateFrames(result.pairs, std::move(levels));
  if (result.pairs.empty()) {
    result.absent_reason = real.frame_count() < 2
                               ? fmt::format("{} real frame, two are needed", real.frame_count())
                           : lacks_box ? "no two consecutive real frames of one pose have a box"
                                       : "no two consecutive real frames share a pose";
  }
  if (result.assumed_still) {
    result.notes.emplace_back(
        "no poses are recorded: consecutive real frames are assumed to show a static scene");
  }
  return result;
}

NoiseFloor MeasureNoiseFloor(const RecordingSource& real, const CompareOptions& options,
                             const std::map<int, PixelBox>& boxes, int max_pairs) {
  return {.speckle = SpeckleFloorFor(real.info().scale),
          .real_against_real = CompareRealWithReal(real, options, boxes, max_pairs),
          .drawn = std::nullopt};
}

FloorSource NoiseFloor::source() const {
  const bool pairs = !real_against_real.pairs.empty();
  if (drawn && !(pairs && !real_against_real.assumed_still)) return FloorSource::kDrawn;
  return pairs ? FloorSource::kRealAgainstReal : FloorSource::kNone;
}

const Aggregate* NoiseFloor::Beside() const {
  switch (source()) {
    case FloorSource::kRealAgainstReal:
      return &real_against_real.aggregate;
    case FloorSource::kDrawn:
      return &drawn->aggregate;
    case FloorSource::kNone:
      break;
  }
  return nullptr;
}

}  // namespace sonarcal::metrics
