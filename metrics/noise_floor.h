// Noise floor of the figures: the errors that no simulator can avoid. Compare every intensity error with it.
//
// Theory of speckle. The power of a single-look pixel is exponentially distributed. Mean absolute differences
// in dB:
//
//   two independent looks at the same scene      (10/ln 10) 2 ln 2               = 6.02 dB
//   one look and the mean level E[10 log10 P]    (10/ln 10) 2 E1(exp(-gamma))    = 4.27 dB
//
// The logarithm of an exponential variable has a Gumbel distribution with mean -gamma (Euler's constant), and
// the difference of two such variables a logistic one. Divided by the dB that a display spreads over its full
// scale, these are floors of the normalised error of a speckled simulation and of a noise-free one. They hold
// if the display is a plain logarithm and nothing is clipped or below the noise. A soft logarithm, several
// looks or a background clipped to black lower them. (The mean level lies 2.51 dB below the level of the mean
// power. One look differs from the latter by 4.41 dB.)
//
// Measurement. Two real frames of one static scene go through the same metrics: detector, noise and all.
// Speckle does not change while nothing moves, so this floor can lie below the theoretical one. Then it shows
// how repeatable the metric is, not how good a simulation with its own speckle can be.
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
  double span_db = 0.0;              // dB between 0 and full scale
  double speckled_simulation = 0.0;  // two independent looks, fraction of full scale
  double smooth_simulation = 0.0;    // one look against its mean, fraction of full scale
};

// Returns nothing if the scale does not state its dB. Throws DataError if its span is not positive.
std::optional<SpeckleFloor> SpeckleFloorFor(const ImageScale& scale);

struct RealAgainstReal {
  // the earlier frame takes the place of the real one; index: that of the earlier
  std::vector<FrameMetrics> pairs;
  Aggregate aggregate;
  bool assumed_still = false;      // true if some pair has no recorded poses
  std::string absent_reason;       // empty if there are pairs
  std::vector<std::string> notes;  // assumptions, one sentence each
};

// Compares each frame with the next, at most `max_pairs` pairs. Omits pairs whose recorded poses differ by
// more than 1 mm or 1 mrad, because they show different things. Frames without recorded poses are assumed to
// show a static scene, which is noted. `boxes`: search box of the object, by frame. Pairs whose earlier frame
// has none are omitted, unless no frame has one.
RealAgainstReal CompareRealWithReal(const RecordingSource& real, const CompareOptions& options,
                                    const std::map<int, PixelBox>& boxes = {}, int max_pairs = 100);

// Figures of frames drawn from a fitted distribution, compared with its expected image. For recordings
// without frames of a static scene.
struct DrawnFloor {
  Aggregate aggregate;
  std::string law;  // description of the distribution
};

// Source of the floor that is shown beside the figures.
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

  // Real against real if pairs are known to be static, otherwise drawn frames, otherwise pairs assumed to be
  // static.
  FloorSource source() const;
  // Figures of this source; null if there are none.
  const Aggregate* Beside() const;
};

NoiseFloor MeasureNoiseFloor(const RecordingSource& real, const CompareOptions& options,
                             const std::map<int, PixelBox>& boxes = {}, int max_pairs = 100);

}  // namespace sonarcal::metrics
