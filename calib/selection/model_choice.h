// Which form of the acoustic model a recording asks for, where no parameter leads from one form to the other:
// chosen by the likelihood of frames that the fit does not see (calib/selection/held_out_likelihood.h).
//
// One axis after the other, from the best so far: the variants of an axis are fitted in a few iterations to
// the frames used, and judged on those held out. The best is the one of greatest likelihood; those that lie
// within `tie_sigmas` standard errors of their difference to it are as good. Of these the one is chosen that
// fits the fewest values, and among equals the one that was given: nothing is changed without evidence.
//
//   kPattern    azimuth pattern of the beams: Gaussian, or an aperture of taper 0, 0.5, 1, at the same width
//   kElevation  elevation pattern: Gaussian, cosine, or an aperture of taper 0, 1
//   kMirrors    lobes of the elevation pattern through which mirrors are seen: all, or the main lobe
//   kLooks      looks: 1, the number given, and the one that explains the frames used best
//   kTrend      a trend of the noise floor with range: as given, or free
//   kDisplay    logarithm, or one softened in power or amplitude, as the background of the first frame used
//               has it (calib/noise/background_display.h), where the image states its dB span
//
// To add an axis: a word in ToString, a case in VariantsOf (model_choice.cc, model_variants.h).
#pragma once

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
  int first_iterations = 60;  // at most, of the fit that all others start from
  int iterations = 20;        // at most, of each variant's solves
  FitOptions fit = {};        // starts of the first fit, threads, blocks, progress
};

struct JudgedVariant {
  std::string name;
  int fitted_values = 0;        // beyond the plainest variant of its axis
  bool given = false;           // what the parameters said before this axis
  bool usable = false;          // else its fit ended nowhere, and the figures say nothing
  double nats_per_pixel = 0.0;  // mean log-likelihood of the grey values held out
  LikelihoodDifference behind;  // the best of its axis, less this
  bool tied = false;            // with the best
  bool chosen = false;
};

struct JudgedAxis {
  ChoiceAxis axis = ChoiceAxis::kPattern;
  std::vector<JudgedVariant> variants;
  std::vector<std::string> notes;  // why a variant is missing
};

struct ModelChoice {
  ParameterSet parameters;  // those given, in the form chosen; not fitted
  FitConfig config;         // that given, with what the form frees or holds
  std::vector<JudgedAxis> axes;
  std::vector<int> frames_chosen_on;
  double pixels = 0.0;
  int blocks = 0;  // of pixels, over which standard errors are taken
  double tie_sigmas = 2.0;
};

// The rays of `simulator` must do for every pattern tried: for kElevation, those of a pattern with side
// lobes. `initial` may lack a noise level, which is then looked for. Throws DataError where no frame is held
// out, an axis has nothing to choose, and as FitAcousticModel does; where the first fit ends without a usable
// solution too.
ModelChoice ChooseModel(const sim::Simulator& simulator, const std::vector<GreyFrame>& used,
                        const std::vector<GreyFrame>& held_out, const ParameterSet& initial,
                        const FitConfig& config, const ModelChoiceOptions& options);

}  // namespace sonarcal::calib
