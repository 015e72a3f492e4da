// What no simulator can beat, to be read beside every intensity error.
//
// Speckle, in theory. The power of a single-look pixel is exponential about its mean. In dB, the mean
// absolute difference of
//   two independent looks at the same scene      (10/ln 10) 2 ln 2                       = 6.02 dB,
//   one look and the mean level E[10 log10 P]    (10/ln 10) 2 E1(exp(-gamma))            = 4.27 dB,
// since the logarithm of an exponential variable is Gumbel distributed with mean -gamma (Euler's constant),
// and the difference of two such is logistic. Divided by the dB that a display spreads over its full scale
// they are floors of the normalised error of a speckled simulation and of a noise-free one. They hold where
// the display is a plain logarithm and nothing is clipped or below the noise; a soft logarithm, several looks
// or a background clipped to black lower them. (The mean level lies 2.51 dB below the level of the mean
// power, against which one look differs by 4.41 dB.)
//
// Measured. Two real frames of one still scene through the same metrics: detector, noise and all. Speckle is
// frozen while nothing moves, so this floor can lie below the theoretical one; then it bounds how repeatable
// the metric is, not how well a simulation with its own speckle can do.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "core/types/image.h"
#include "core/types/recording.h"
#include "core/types/words.h"
#include "metrics/aggregate.h"
#include "metrics/compare.h"

namespace sonarcal::metrics {

double SingleLookPairDifferenceDb();  // 6.02
double SingleLookMeanDifferenceDb();  // 4.27

struct SpeckleFloor {
  double span_db = 0.0;              // shown over full scale
  double speckled_simulation = 0.0;  // two independent looks, fraction of full scale
  double smooth_simulation = 0.0;    // one look against its mean, fraction of full scale
};

// Nothing where the scale does not state its dB. Throws DataError where it states a span that is not
// positive.
std::optional<SpeckleFloor> SpeckleFloorFor(const ImageScale& scale);

struct RealAgainstReal {
  std::vector<FrameMetrics> pairs;  // the earlier frame in the part of the real one; index: of the earlier
  Aggregate aggregate;
  bool assumed_still = false;      // of some pair no poses are recorded
  std::string absent_reason;       // empty where there are pairs
  std::vector<std::string> notes;  // what was assumed, one sentence each
};

// Compares each frame with the next, at most `max_pairs` pairs. Pairs whose recorded poses differ by more
// than 1 mm or 1 mrad are left out: they show different things. Where no poses are recorded the frames are
// taken to show a still scene, and that is noted.
// `boxes`: by frame, where the object is searched; pairs whose earlier frame has none are left out, unless no
// frame has one.
RealAgainstReal CompareRealWithReal(const RecordingSource& real, const CompareOptions& options,
                                    const std::map<int, PixelBox>& boxes = {}, int max_pairs = 100);

// Figures of frames drawn from a fitted law against what that law expects of them, for recordings that hold
// no frames of one still scene.
struct DrawnFloor {
  Aggregate aggregate;
  std::string law;  // what was drawn, in words
};

// Where the floor beside the figures comes from.
enum class FloorSource { kNone, kRealAgainstReal, kDrawn };
constexpr auto WordsOf(std::type_identity<FloorSource>) {
  return Words<FloorSource, 3>{{{"none", FloorSource::kNone},
                                {"real_against_real", FloorSource::kRealAgainstReal},
                                {"drawn", FloorSource::kDrawn}}};
}

struct NoiseFloor {
  std::optional<SpeckleFloor> speckle;
  RealAgainstReal real_against_real;
  std::optional<DrawnFloor> drawn;

  // Real against real where there are pairs known to be still, else what was drawn, else pairs taken to be
  // still.
  FloorSource source() const;
  // Its figures; null where there are none.
  const Aggregate* Beside() const;
};

NoiseFloor MeasureNoiseFloor(const RecordingSource& real, const CompareOptions& options,
                             const std::map<int, PixelBox>& boxes = {}, int max_pairs = 100);

}  // namespace sonarcal::metrics
