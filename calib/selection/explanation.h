// What each part of the acoustic model is worth for a recording: one part added at a time, what is cheap
// fitted again after each, and judged on frames that no fit saw.
//
//   start      plain echoes: one curve for the whole scene, beams of one spacing, a pulse of one bin, rays
//              within the elevation beam and all alike, nothing where no echo is
//   response   beam pattern in azimuth and pulse, as given (a pulse that is not given is fitted)
//   elevation  the beam's elevation pattern, side lobes and all
//   noise      a noise floor
//   materials  a curve for each material
//   ghosts     echoes by way of the mirrors that the parameters name; left out where there are none
//   speckle    grey values vary as speckle does, of the number of looks that fits best
//   poses      every frame's pose; only where asked for
//
// Fits are by the likelihood of calib/acoustic_fit.h throughout, and those before `noise` are given the floor
// that their images lack: the constant of the law by which they are judged stands for it. Without it a curve
// would be bent to light, through the skirts of beam and pulse, what no echo lights. Before `speckle` a grey
// value is taken to be normal about what is expected and a constant (NormalGreyLaw), which is all that a
// model can say that knows of none; from there on it has the law of speckle.
//
// A step is worth it where the likelihood of the frames held out rises by more than two standard errors and
// the Bayesian criterion on the frames used falls, and their error does not rise by more than two standard
// errors. The error is the mean absolute one of the median image, which by a step's law makes it least:
// half of what a pixel may show lies below. Where likelihood and error say opposite things the step is
// contradicted, neither worth it nor worse. Both criteria,
//
//   AIC = 2 k - 2 ln L,   BIC = k ln n - 2 ln L,
//
// count n independent cells, not pixels: ln L is the sum over pixels divided by the pixels of a cell, which
// for Gaussian responses is 1.505 half-power widths of beam times as many of the pulse (the area under the
// autocorrelation of speckle's power). k counts what the data determine, not what is left to priors.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "calib/acoustic_fit.h"
#include "calib/selection/held_out_likelihood.h"
#include "core/types/scene.h"
#include "core/types/words.h"

namespace sonarcal::calib {

enum class ExplainedPart { kStart, kResponse, kElevation, kNoise, kMaterials, kGhosts, kSpeckle, kPoses };
constexpr auto WordsOf(std::type_identity<ExplainedPart>) {
  return Words<ExplainedPart, 8>{{{"start", ExplainedPart::kStart},
                                  {"response", ExplainedPart::kResponse},
                                  {"elevation", ExplainedPart::kElevation},
                                  {"noise", ExplainedPart::kNoise},
                                  {"materials", ExplainedPart::kMaterials},
                                  {"ghosts", ExplainedPart::kGhosts},
                                  {"speckle", ExplainedPart::kSpeckle},
                                  {"poses", ExplainedPart::kPoses}}};
}

enum class Verdict {
  kStart,         // the first step has nothing to be compared with
  kWorthIt,       // the frames held out are the likelier for it
  kNoMore,        // than noise would gain: a tie
  kWorse,         // the frames held out are the less likely
  kContradicted,  // likelier, but the error rises; or less likely, but it falls
};
constexpr auto WordsOf(std::type_identity<Verdict>) {
  return Words<Verdict, 5>{{{"start", Verdict::kStart},
                            {"worth it", Verdict::kWorthIt},
                            {"no more than noise", Verdict::kNoMore},
                            {"worse", Verdict::kWorse},
                            {"contradicted by the error", Verdict::kContradicted}}};
}

// `gain` of likelihood and `error_change` are those of the frames held out, over the step before.
Verdict VerdictOn(const LikelihoodDifference& gain, double bic_change,
                  const LikelihoodDifference& error_change, double tie_sigmas);

// What one of the frames held out says of a step. Where they are alike the sum says more; where one has been
// half seen by the fit, as a second frame of a still scene has, each has to be heard by itself.
struct JudgedFrame {
  BlockedLikelihood likelihood = {};
  LikelihoodDifference gain = {};  // over the step before, nats a pixel
  BlockedLikelihood error = {};    // of the median image, of full scale
  LikelihoodDifference error_change = {};
  Verdict verdict = Verdict::kStart;
};

struct ExplainedStep {
  ExplainedPart part = ExplainedPart::kStart;
  ParameterSet parameters = {};              // fitted
  std::vector<FittedParameter> fitted = {};  // what was free, with its status
  int determined = 0;                        // fitted values that the data determine, beyond their priors
  bool knows_speckle = false;
  NormalGreyLaw grey = {};                              // where it does not
  std::vector<std::vector<double>> mean_held_out = {};  // power, by frame and pixel
  std::vector<Pose> poses_held_out = {};
  double nats_used = 0.0;  // a pixel
  BlockedLikelihood held_out = {};
  LikelihoodDifference gain = {};          // of the frames held out over the step before, nats a pixel
  BlockedLikelihood error_held_out = {};   // of the median image, of full scale
  LikelihoodDifference error_change = {};  // over the step before; above 0 is worse
  double aic_change = 0.0;                 // from the step before; below 0 is better
  double bic_change = 0.0;
  Verdict verdict = Verdict::kStart;
  std::vector<JudgedFrame> by_frame = {};  // of the frames held out, each alone
};

struct Explanation {
  std::vector<ExplainedStep> steps;
  std::vector<std::string> left_out = {};  // steps, and why, in words
  std::vector<std::string> warnings =
      {};  // values that a fit took to the end of their range, a sentence each
  double pixels_used = 0.0;
  double pixels_a_cell = 1.0;  // that count as one independent
};

struct ExplainOptions {
  sim::SimulationOptions simulation;  // its fan that of the whole elevation pattern
  FitOptions fit = {};
  bool hold_noise = false;  // the floor as given, not fitted: where target-free pings have told it
  bool poses = false;
  PosePrior pose_prior = {};
  double tie_sigmas = 2.0;
  std::function<void(ExplainedPart)> on_step = {};  // before each
};

// `given` names the form of everything (beam, pulse, looks, display, mirrors) and where curves and losses
// begin; a noise level that it lacks is looked for. Throws DataError where no frame is held out, and as
// FitAcousticModel does; where a step's fit ends without a usable solution too.
Explanation Explain(const Scene& scene, const SonarModel& sonar, const std::vector<GreyFrame>& used,
                    const std::vector<GreyFrame>& held_out, const ParameterSet& given,
                    const ExplainOptions& options);

// Grey values that a step expects in the frames held out, by frame.
std::vector<PolarImage> ExpectedGrey(const ExplainedStep& step, const std::vector<GreyFrame>& held_out);

}  // namespace sonarcal::calib
