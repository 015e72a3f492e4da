// Ablation study of the acoustic model: adds one part at a time, fits again the parameters that are cheap to
// fit, and evaluates on held-out frames.
//
//   start      plain echoes: one curve for the whole scene, beams as wide as their spacing, a pulse of one
//              bin, equal rays within the elevation beam, a black background
//   response   beam pattern in azimuth and pulse, as given (a pulse that is not given is fitted)
//   elevation  elevation pattern of the beam, with side lobes
//   noise      a noise floor
//   materials  a curve for each material
//   ghosts     echoes by way of the mirrors in the parameters; left out if there are none
//   speckle    grey values vary as speckle does, with the number of looks that fits best
//   poses      the pose of every frame; only on request
//
// All fits use the likelihood of calib/acoustic_fit.h. Those before `noise` include a noise floor that their
// images lack, in place of the constant in the law of their evaluation. Without it, the fit would bend a
// curve to light pixels without echoes through the skirts of beam and pulse. Before `speckle`, a grey value
// is normal about the expected value plus a constant (NormalGreyLaw), because such a model does not know
// speckle. From there on it has the law of speckle. Materials and ghosts concern few pixels. Their likelihood
// and criteria are those of the law of speckle, with and without the part, with the number of looks that fits
// each best. Otherwise a part can gain by making up for what is wrong with the normal law in every pixel.
//
// Criterion for a significant step: the likelihood of the held-out frames rises by more than two standard
// errors, the Bayesian criterion on the frames used falls, and the error does not rise by more than two
// standard errors. The error is the mean absolute error of the median image, which is the best image for this
// error under the law of the step. If likelihood and error contradict each other, the step is neither
// significant nor worse. The criteria
//
//   AIC = 2 k - 2 ln L,   BIC = k ln n - 2 ln L
//
// count n independent cells, not pixels. ln L is the sum over pixels, divided by the number of pixels per
// cell. For Gaussian responses a cell is 1.505 half-power widths of the beam times as many of the pulse (the
// area under the autocorrelation of speckle power). k counts the values that the data determine, not those
// that priors determine. A value that several steps fit counts as in the first of them. It still counts in
// steps that keep it without fitting it. Only the curve of the whole scene is replaced, by those of the
// materials.
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
  kStart,           // the first step has no reference
  kSignificant,     // the held-out frames are significantly more likely
  kNotSignificant,  // no significant change
  kWorse,           // the held-out frames are significantly less likely
  kContradicted,    // more likely, but the error rises; or less likely, but it falls
};
constexpr auto WordsOf(std::type_identity<Verdict>) {
  return Words<Verdict, 5>{{{"start", Verdict::kStart},
                            {"significant", Verdict::kSignificant},
                            {"not significant", Verdict::kNotSignificant},
                            {"worse", Verdict::kWorse},
                            {"contradicted by the error", Verdict::kContradicted}}};
}

// `gain` of likelihood and `error_change`: of the held-out frames, relative to the previous step.
Verdict VerdictOn(const LikelihoodDifference& gain, double bic_change,
                  const LikelihoodDifference& error_change, double tie_sigmas);

// Evaluation of a step on one held-out frame. For similar frames the sum is more precise. If the fit has seen
// part of a frame, such as a second frame of a static scene, each frame must be evaluated alone.
struct JudgedFrame {
  BlockedLikelihood likelihood = {};
  LikelihoodDifference gain = {};  // relative to the previous step, nats per pixel
  BlockedLikelihood error = {};    // of the median image, full scale 1
  LikelihoodDifference error_change = {};
  Verdict verdict = Verdict::kStart;
};

struct ExplainedStep {
  ExplainedPart part = ExplainedPart::kStart;
  ParameterSet parameters = {};              // fitted
  std::vector<FittedParameter> fitted = {};  // free parameters with their status
  int determined = 0;  // values of all steps so far that the data determine more closely than their priors
  bool knows_speckle = false;
  NormalGreyLaw grey = {};                              // if the step models no speckle
  std::vector<std::vector<double>> mean_held_out = {};  // power per frame and pixel
  std::vector<Pose> poses_held_out = {};
  double nats_used = 0.0;  // per pixel
  BlockedLikelihood held_out = {};
  LikelihoodDifference gain = {};  // of the held-out frames relative to the previous step, nats per pixel
  BlockedLikelihood error_held_out = {};   // of the median image, full scale 1
  LikelihoodDifference error_change = {};  // relative to the previous step; above 0 is worse
  double aic_change = 0.0;                 // relative to the previous step; below 0 is better
  double bic_change = 0.0;
  Verdict verdict = Verdict::kStart;
  std::vector<JudgedFrame> by_frame = {};  // each held-out frame alone
};

struct Explanation {
  std::vector<ExplainedStep> steps;
  std::vector<std::string> left_out = {};  // steps with the reason, one sentence each
  std::vector<std::string> warnings = {};  // values at the end of their range, one sentence each
  double pixels_used = 0.0;
  double pixels_per_cell = 1.0;  // pixels in one independent cell
};

struct ExplainOptions {
  sim::SimulationOptions simulation;  // with a fan for the whole elevation pattern
  FitOptions fit = {};
  bool hold_noise = false;  // fixes the given floor; for a floor from target-free pings
  bool poses = false;
  PosePrior pose_prior = {};
  double tie_sigmas = 2.0;
  std::function<void(ExplainedPart)> on_step = {};  // called before each step
};

// `given` has the form of all parts (beam, pulse, looks, display, mirrors) and the start values of curves and
// losses. A missing noise level is estimated. Throws DataError if no frame is held out, if the fit of a step
// has no usable solution, and as FitAcousticModel does.
Explanation Explain(const Scene& scene, const SonarModel& sonar, const std::vector<GreyFrame>& used,
                    const std::vector<GreyFrame>& held_out, const ParameterSet& given,
                    const ExplainOptions& options);

// Expected grey values of a step in the held-out frames.
std::vector<PolarImage> ExpectedGrey(const ExplainedStep& step, const std::vector<GreyFrame>& held_out);

}  // namespace sonarcal::calib
