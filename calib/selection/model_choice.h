// Selects the form of the acoustic model for a recording, if no parameter leads from one form to the other.
// The criterion is the likelihood of held-out frames (calib/selection/held_out_likelihood.h).
//
// The axes are processed one after the other, each from the best form so far. The variants of an axis are
// fitted in a few iterations to the frames used, and evaluated on the held-out frames. The best variant has
// the largest likelihood. Variants within `tie_sigmas` standard errors of it are equally good. Of these, the
// one with the fewest fitted values is selected, and among equals the given one: nothing changes without
// evidence.
//
//   kPattern    azimuth pattern of the beams: Gaussian, or an aperture of taper 0, 0.5, 1, at the same width
//   kElevation  elevation pattern: Gaussian, cosine, or an aperture of taper 0, 1
//   kMirrors    lobes of the elevation pattern through which mirrors are seen: all, or the main lobe
//   kLooks      looks: 1, the given number, and the one that fits the frames used best
//   kTrend      a trend of the noise floor with range: as given, or free
//   kDisplay    logarithm, or one softened in power or amplitude, as the background of the first frame used
//               shows (calib/noise/background_display.h), on the span of the parameters
//
// Without held-out frames only kDisplay can be selected, and by the background of the first frame used alone:
// each law of core/types/parameters.h is fitted to every second band of 8 range bins of it and judged on the
// others. Its span is fitted too if the image does not state it.
//
// To add an axis: add a word in WordsOf, and a case in VariantsOf (model_choice.cc, model_variants.h).
#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "calib/acoustic_fit.h"
#include "calib/selection/held_out_likelihood.h"
#include "core/types/words.h"

namespace sonarcal::calib {

enum class ChoiceAxis { kPattern, kElevation, kMirrors, kLooks, kTrend, kDisplay };
constexpr auto WordsOf(std::type_identity<ChoiceAxis>) {
  return Words<ChoiceAxis, 6>{{{"pattern", ChoiceAxis::kPattern},
                               {"elevation", ChoiceAxis::kElevation},
                               {"mirrors", ChoiceAxis::kMirrors},
                               {"looks", ChoiceAxis::kLooks},
                               {"trend", ChoiceAxis::kTrend},
                               {"display", ChoiceAxis::kDisplay}}};
}

struct ModelChoiceOptions {
  std::vector<ChoiceAxis> axes;  // in this order
  double tie_sigmas = 2.0;
  int first_iterations = 60;  // max, for the fit that all others start from
  int iterations = 20;        // max, for each solve of a variant
  FitOptions fit = {};        // starts of the first fit, threads, blocks, progress
};

struct JudgedVariant {
  std::string name;
  int fitted_values = 0;        // in excess of the plainest variant of its axis
  bool given = false;           // value in the parameters before this axis
  bool usable = false;          // false: its fit has no solution, and the figures are meaningless
  double nats_per_pixel = 0.0;  // mean log-likelihood of the held-out grey values
  LikelihoodDifference behind;  // best of its axis minus this one
  bool tied = false;            // with the best one
  bool chosen = false;
};

struct JudgedAxis {
  ChoiceAxis axis = ChoiceAxis::kPattern;
  std::vector<JudgedVariant> variants;
  std::vector<std::string> notes;  // reasons for missing variants

  // ChooseModel always chooses one variant.
  const JudgedVariant& Chosen() const {
    return *std::ranges::find_if(variants, [](const JudgedVariant& variant) { return variant.chosen; });
  }
};

struct ModelChoice {
  ParameterSet parameters;  // the given ones, in the selected form; not fitted
  FitConfig config;         // the given one, with the parameters that the form frees or fixes
  std::vector<JudgedAxis> axes;
  std::vector<int> frames_chosen_on;  // empty: the background of the first frame used
  double pixels = 0.0;
  int blocks = 0;  // number of pixel blocks for standard errors
  double tie_sigmas = 2.0;
};

// The rays of `simulator` must suffice for every pattern: for kElevation, those of a pattern with side lobes.
// A noise level missing in `initial` is estimated. Throws DataError if no frame is held out for an axis other
// than kDisplay, an axis has nothing to select, the first fit has no usable solution, and as FitAcousticModel
// does.
ModelChoice ChooseModel(const sim::Simulator& simulator, const std::vector<GreyFrame>& used,
                        const std::vector<GreyFrame>& held_out, const ParameterSet& initial,
                        const FitConfig& config, const ModelChoiceOptions& options);

}  // namespace sonarcal::calib
