#include "calib/selection/explanation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "calib/mirror_start.h"
#include "calib/models/acoustic_frame_model.h"
#include "calib/noise/noise_form.h"
#include "calib/problem_builder.h"
#include "core/math/bisection.h"
#include "core/types/error.h"
#include "core/types/units.h"
#include "sim/acoustic/acoustic_image.h"
#include "sim/physics/beam_and_pulse.h"
#include "sim/physics/display.h"
#include "sim/physics/speckle.h"

namespace sonarcal::calib {
namespace {

// Area under the autocorrelation of speckle power, in half-power widths of a Gaussian response: sqrt(pi / (2
// ln 2)).
constexpr double kCellWidths = 1.5053;

constexpr const char* kNoiseLevel = "receiver.noise_db";
// The only material of the first steps, and its curve, which those of the materials replace.
constexpr const char* kWholeScene = "scene";
constexpr const char* kWholeSceneCurve = "material.scene.";

Scene OfOneMaterial(Scene scene) {
  scene.material_names = {kWholeScene};
  std::fill(scene.triangle_material.begin(), scene.triangle_material.end(), std::uint16_t{0});
  return scene;
}

// Limits the rays to the half-power elevation beam.
sim::SimulationOptions WithinElevationBeam(sim::SimulationOptions options, double width_deg) {
  if (!(width_deg > 0.0)) return options;
  const double share = std::min(1.0, width_deg / options.fan.elevation_span_deg);
  options.fan.elevation_span_deg *= share;
  options.fan.row_crowding = 1.0;
  options.fan.rows = std::max(32, static_cast<int>(std::lround(options.fan.rows * std::sqrt(share))));
  return options;
}

// Converts expected power to grey values up to full scale: those of the display, or their mean over speckle.
PolarImage Shown(const std::vector<double>& mean_power, const PolarAxes& axes, const ParameterSet& parameters,
                 double full_scale, bool knows_speckle) {
  PolarImage power{
      axes,
      {.quantity = Quantity::kPower, .full_scale = 1.0, .db_min = {}, .db_max = {}, .db_span = {}},
      Grid<float>(axes.range_bins, axes.beam_count())};
  std::transform(mean_power.begin(), mean_power.end(), power.value.values().begin(),
                 [](double value) { return static_cast<float>(value); });
  return knows_speckle ? sim::ExpectedDisplay(power, parameters, full_scale)
                       : sim::DisplayPower(power, parameters, full_scale);
}

std::vector<std::vector<double>> GreyOf(const std::vector<std::vector<double>>& mean_power,
                                        const std::vector<GreyFrame>& frames,
                                        const ParameterSet& parameters) {
  std::vector<std::vector<double>> grey;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    const PolarImage& image = frames[f].image;
    const PolarImage shown = Shown(mean_power[f], image.axes, parameters, image.scale.full_scale, false);
    grey.emplace_back(shown.value.values().begin(), shown.value.values().end());
  }
  return grey;
}

// Median of speckle power divided by its mean: the median of a Gamma law of mean 1.
double SpeckleMedian(double looks) {
  const auto is_below = [&](double ratio) { return sim::SpeckleCdf(looks, ratio) < 0.5; };
  return Bisection(0.0, 1.0, is_below);  // the median lies below the mean
}

// Medians of a step's law, as grey values per frame.
std::vector<std::vector<double>> MedianGrey(const ExplainedStep& step, const std::vector<GreyFrame>& frames,
                                            std::vector<std::vector<double>> mean_power) {
  if (step.knows_speckle) {
    const double median = SpeckleMedian(step.parameters.receiver.looks);
    for (std::vector<double>& of_frame : mean_power) {
      for (double& power : of_frame) power *= median;
    }
    return GreyOf(mean_power, frames, step.parameters);
  }
  std::vector<std::vector<double>> grey = GreyOf(mean_power, frames, step.parameters);
  for (std::size_t f = 0; f < frames.size(); ++f) {
    for (double& value : grey[f])
      value = std::clamp(value + step.grey.offset, 0.0, frames[f].image.scale.full_scale);
  }
  return grey;
}

class Explainer {
 public:
  Explainer(const Scene& scene, const SonarModel& sonar, const std::vector<GreyFrame>& used,
            const std::vector<GreyFrame>& held_out, const ParameterSet& given, const ExplainOptions& options)
      : sonar_(sonar), used_(used), held_out_(held_out), given_(given), options_(options) {
    complete_ = sim::WithResponse(sonar, given);
    block_ = BlockOf(complete_);
    narrow_.emplace(OfOneMaterial(scene), sonar,
                    WithinElevationBeam(options.simulation, complete_.beam.elevation_width_deg));
    one_.emplace(OfOneMaterial(scene), sonar, options.simulation);
    all_.emplace(scene, sonar, options.simulation);
    given_ = WithNoiseStart(std::move(given_), FramesFor(used, given.display));
    fit_options_ = options.fit;
    fit_options_.starts = 1;
    fit_options_.down_weight = false;  // the evaluation uses all pixels, so the fit does too
  }

  Explanation Run() {
    ParameterSet p = Plain();
    Step(ExplainedPart::kStart, *narrow_, p, {"materials"});
    p = Last();
    const BeamParameters no_elevation = p.beam;
    p.beam = complete_.beam;
    p.beam.elevation_pattern = no_elevation.elevation_pattern;
    p.beam.elevation_width_deg = no_elevation.elevation_width_deg;
    p.pulse = given_.pulse;
    std::vector<std::string> free = {"materials"};
    if (!(given_.pulse.length_m > 0.0)) free.emplace_back("pulse.length_m");
    Step(ExplainedPart::kResponse, *narrow_, p, free);
    p = Last();
    p.beam = complete_.beam;
    Step(ExplainedPart::kElevation, *one_, p, {"materials"});
    p = Last();
    p.receiver = given_.receiver;
    p.receiver.noise_db = hidden_noise_db_;
    free = {"materials"};
    if (!options_.hold_noise) free.emplace_back(kNoiseLevel);
    Step(ExplainedPart::kNoise, *one_, p, free);
    AddMaterials(free);
    AddGhosts(free);
    AddSpeckle();
    if (options_.poses) AddPoses(free);
    Judge();
    Warn();
    return std::move(result_);
  }

 private:
  // Echoes without a model of the sonar, on a black background.
  ParameterSet Plain() const {
    ParameterSet p = given_;
    const auto fallback = given_.materials.find("default");
    p.materials = {{kWholeScene, fallback != given_.materials.end() ? fallback->second
                                                                    : given_.materials.begin()->second}};
    p.mirrors.clear();
    p.beam = {.azimuth_width_deg = DegFromRad(sonar_.axes.beam_spacing_rad()),
              .elevation_width_deg = 1e4,  // practically no pattern: the rays end at the edge of the beam
              .azimuth_pattern = AzimuthPattern::kGaussian,
              .elevation_pattern = ElevationPattern::kGaussian};
    p.pulse.length_m = sonar_.axes.range_bin_m();
    const double full_scale = used_.front().image.scale.full_scale;
    ReceiverParameters black;
    black.gain_db = given_.receiver.gain_db;
    black.looks = given_.receiver.looks;
    black.time_varied_gain = given_.receiver.time_varied_gain;
    // A soft law shows nothing below its floor, which may lie above half a level.
    black.noise_after_gain_db = DbFromPower(
        std::max(UnshownPower(given_.display), sim::PowerFromDisplay(given_.display, 0.5 / full_scale)));
    black.noise_db = *black.noise_after_gain_db - 100.0;
    p.receiver = black;
    return p;
  }

  const ParameterSet& Last() const { return result_.steps.back().parameters; }

  // A curve for each material: the given one, or else the fitted curve of the whole scene.
  ParameterSet OwnCurves() const {
    ParameterSet p = Last();
    const MaterialParameters whole = p.materials.at(kWholeScene);
    p.materials.clear();
    for (const std::string& name : all_->caster().material_names()) {
      const auto given = given_.materials.find(name);
      p.materials[name] = given != given_.materials.end() ? given->second : whole;
    }
    return p;
  }

  void AddMaterials(const std::vector<std::string>& free) {
    const std::vector<std::string>& names = all_->caster().material_names();
    if (names.size() > 1) {
      Step(ExplainedPart::kMaterials, *all_, OwnCurves(), free);
      return;
    }
    result_.left_out.emplace_back("materials: the scene has a single one");
    ParameterSet& last = result_.steps.back().parameters;
    last.materials = {{names.front(), last.materials.at(kWholeScene)}};
  }

  void AddGhosts(std::vector<std::string>& free) {
    const std::vector<std::string> mirrors = MirrorsFreeByDefault(given_, all_->caster().material_names());
    if (mirrors.empty()) {
      result_.left_out.emplace_back("ghosts: the parameters name no material of the scene as a mirror");
      return;
    }
    free.insert(free.end(), mirrors.begin(), mirrors.end());
    ParameterSet p = Last();
    p.mirrors = given_.mirrors;
    p.beam.transmit_even_deg = given_.beam.transmit_even_deg;
    p.beam.transmit_end_deg = given_.beam.transmit_end_deg;
    Step(ExplainedPart::kGhosts, *all_, p, free);
  }

  // Changes the law of grey values. Only its looks are fitted.
  void AddSpeckle() {
    if (options_.on_step) options_.on_step(ExplainedPart::kSpeckle);
    ExplainedStep step = WithSpeckle(result_.steps.back());
    step.part = ExplainedPart::kSpeckle;
    Keep(std::move(step));
  }

  void AddPoses(std::vector<std::string> free) {
    free.emplace_back("pose");
    Step(ExplainedPart::kPoses, *all_, Last(), free);
  }

  void Step(ExplainedPart part, const sim::Simulator& simulator, const ParameterSet& start,
            const std::vector<std::string>& free) {
    if (options_.on_step) options_.on_step(part);
    const bool hides_floor = part < ExplainedPart::kNoise;
    FitConfig config{.free = free, .pose_prior = options_.pose_prior};
    fit_options_.search_level = part == ExplainedPart::kStart;
    std::vector<AcousticFrame> used = FramesFor(used_, start.display);
    ParameterSet from = start;
    if (hides_floor) {
      from.receiver = given_.receiver;
      if (hidden_noise_db_) from.receiver.noise_db = hidden_noise_db_;
      if (!options_.hold_noise) config.free->emplace_back(kNoiseLevel);
    }
    AcousticFit fit = FitAcousticModel(simulator, used, from, config, fit_options_);
    if (hides_floor) {
      hidden_noise_db_ = fit.parameters.receiver.noise_db;
      fit.parameters.receiver = start.receiver;
      std::erase_if(fit.report.parameters,
                    [](const FittedParameter& parameter) { return parameter.name == kNoiseLevel; });
    }
    if (!fit.usable) {
      throw DataError("explain: the fit of '{}' ended without a usable solution ({})", ToString(part),
                      fit.report.termination);
    }
    ExplainedStep step{.part = part, .parameters = std::move(fit.parameters)};
    std::ranges::copy_if(
        fit.report.parameters, std::back_inserter(step.fitted),
        [](const FittedParameter& parameter) { return parameter.status != ParameterStatus::kFixed; });
    for (std::size_t f = 0; f < used.size(); ++f) used[f].world_from_sonar = fit.world_from_sonar[f];
    std::vector<AcousticFrame> held_out = FramesFor(held_out_, start.display);
    if (part == ExplainedPart::kPoses) {
      const std::vector<Pose> poses =
          FitPosesOnly(simulator, held_out, step.parameters, options_.pose_prior, fit_options_.progress);
      for (std::size_t f = 0; f < held_out.size(); ++f) held_out[f].world_from_sonar = poses[f];
    }
    const AcousticFrameModel seen(simulator, used, step.parameters);
    mean_used_ = MeanPowers(seen);
    speckle_cell_ = seen.speckle_cell();
    const AcousticFrameModel unseen(simulator, held_out, step.parameters);
    step.mean_held_out = MeanPowers(unseen);
    for (const AcousticFrame& frame : held_out) step.poses_held_out.push_back(frame.world_from_sonar);
    if (part > ExplainedPart::kSpeckle) {
      Keep(WithSpeckle(std::move(step)));
      return;
    }
    step.grey = FindNormalGreyLaw(used_, GreyOf(mean_used_, used_, step.parameters));
    Evaluate(step);
    Keep(std::move(step));
  }

  ExplainedStep WithSpeckle(ExplainedStep step) const {
    step.knows_speckle = true;
    step.parameters.receiver.looks = BestLooks(used_, mean_used_, step.parameters);
    Evaluate(step);
    return step;
  }

  void Evaluate(ExplainedStep& step) const {
    step.nats_used = Likelihood(step, used_, mean_used_).PerPixel();
    step.held_out = Likelihood(step, held_out_, step.mean_held_out);
    step.error_held_out = Error(step, held_out_, step.mean_held_out);
    step.by_frame.clear();
    for (std::size_t f = 0; f < held_out_.size(); ++f) {
      step.by_frame.push_back({.likelihood = Likelihood(step, {held_out_[f]}, {step.mean_held_out[f]}),
                               .error = Error(step, {held_out_[f]}, {step.mean_held_out[f]})});
    }
  }

  // Adds an evaluated step to the result.
  void Keep(ExplainedStep step) {
    if (!step.parameters.materials.contains(kWholeScene))
      std::erase_if(determined_, [](const auto& value) { return value.first.starts_with(kWholeSceneCurve); });
    for (const FittedParameter& value : step.fitted)
      determined_.try_emplace(value.name, value.status != ParameterStatus::kUnidentifiable);
    const auto count = std::ranges::count_if(determined_, [](const auto& value) { return value.second; });
    step.determined = static_cast<int>(count) + (step.knows_speckle ? 1 : 2);  // looks, or offset and spread
    with_speckle_.push_back(step.knows_speckle ? step : WithSpeckle(step));
    result_.steps.push_back(std::move(step));
  }

  // Blocks have the same size in all steps, that of the given beam and pulse.
  BlockPixels BlockOf(const ParameterSet& given) const {
    const PolarAxes& axes = sonar_.axes;
    return BlockSize(SpeckleCellOf(axes, given), axes.range_bins, axes.beam_count(), options_.fit);
  }

  BlockedLikelihood Likelihood(const ExplainedStep& step, const std::vector<GreyFrame>& frames,
                               const std::vector<std::vector<double>>& mean_power) const {
    return WithEdges(step.knows_speckle
                         ? GreyLikelihood(frames, mean_power, step.parameters, block_.bins, block_.beams)
                         : GreyLikelihood(frames, GreyOf(mean_power, frames, step.parameters), step.grey,
                                          block_.bins, block_.beams));
  }

  BlockedLikelihood Error(const ExplainedStep& step, const std::vector<GreyFrame>& frames,
                          const std::vector<std::vector<double>>& mean_power) const {
    return WithEdges(GreyError(frames, MedianGrey(step, frames, mean_power), block_.bins, block_.beams));
  }

  BlockedLikelihood WithEdges(BlockedLikelihood sums) const {
    sums.variance_factor = block_.variance_factor;
    return sums;
  }

  // Materials and ghosts concern few pixels, so the law of speckle compares them: a part can make up for a
  // little of what is wrong with the normal law in every pixel.
  void Judge() {
    result_.pixels_used = Likelihood(result_.steps.back(), used_, mean_used_).Pixels();
    result_.pixels_per_cell =
        std::max(1.0, kCellWidths * speckle_cell_.bins) * std::max(1.0, kCellWidths * speckle_cell_.beams);
    const double cells = result_.pixels_used / result_.pixels_per_cell;
    for (std::size_t i = 1; i < result_.steps.size(); ++i) {
      ExplainedStep& step = result_.steps[i];
      const ExplainedStep& before = result_.steps[i - 1];
      const bool by_speckle = step.part == ExplainedPart::kMaterials || step.part == ExplainedPart::kGhosts;
      const ExplainedStep& with = by_speckle ? with_speckle_[i] : step;
      const ExplainedStep& without = by_speckle ? with_speckle_[i - 1] : before;
      step.gain = Difference(with.held_out, without.held_out);
      const double nats = cells * (with.nats_used - without.nats_used);
      const int values = step.determined - before.determined;
      step.aic_change = 2.0 * values - 2.0 * nats;
      step.bic_change = values * std::log(cells) - 2.0 * nats;
      step.error_change = Difference(step.error_held_out, before.error_held_out);
      step.verdict = VerdictOn(step.gain, step.bic_change, step.error_change, options_.tie_sigmas);
      for (std::size_t f = 0; f < step.by_frame.size(); ++f) {
        JudgedFrame& frame = step.by_frame[f];
        frame.gain = Difference(with.by_frame[f].likelihood, without.by_frame[f].likelihood);
        frame.error_change = Difference(frame.error, before.by_frame[f].error);
        frame.verdict = VerdictOn(frame.gain, step.bic_change, frame.error_change, options_.tie_sigmas);
      }
    }
  }

  // Warns of each value at the end of its range, in the last step that fitted it.
  void Warn() {
    std::map<std::string, std::string> warnings;
    for (const ExplainedStep& step : result_.steps) {
      for (const FittedParameter& fitted : step.fitted) {
        if (fitted.status != ParameterStatus::kAtBound) {
          warnings.erase(fitted.name);
          continue;
        }
        warnings[fitted.name] =
            fmt::format("step '{}': {} ended at the end of its range, {:.4g} of {:g} to {:g}{}{}",
                        ToString(step.part), fitted.name, fitted.value, fitted.lower, fitted.upper,
                        fitted.unit == "1" ? "" : " ", fitted.unit == "1" ? "" : fitted.unit);
      }
    }
    for (const auto& [name, sentence] : warnings) result_.warnings.push_back(sentence);
    const double looks = result_.steps.back().parameters.receiver.looks;
    constexpr double kBeside = 1.005;
    // The lower end, one look, is normal: speckle of a single ping has one look.
    if (looks > kMaxSimulatedLooks / kBeside) {
      result_.warnings.push_back(
          fmt::format("step '{}': receiver.looks ended at the end of its range, {:.3g} of {:g} to {:g}",
                      ToString(ExplainedPart::kSpeckle), looks, kMinSimulatedLooks, kMaxSimulatedLooks));
    }
  }

  const SonarModel& sonar_;
  const std::vector<GreyFrame>& used_;
  const std::vector<GreyFrame>& held_out_;
  ParameterSet given_;
  ParameterSet complete_;  // with actual beam and pulse
  const ExplainOptions& options_;
  BlockPixels block_;
  FitOptions fit_options_;
  // noise level in fits before `noise`; the images of these steps lack it
  std::optional<double> hidden_noise_db_;
  std::optional<sim::Simulator> narrow_;  // one material, within the elevation beam
  std::optional<sim::Simulator> one_;     // one material
  std::optional<sim::Simulator> all_;
  std::vector<std::vector<double>> mean_used_;  // for the last step
  FrameModel::SpeckleCell speckle_cell_;
  // Names of the values that the steps so far fitted; true: the data determined it in the first of them.
  std::map<std::string, bool> determined_;
  std::vector<ExplainedStep> with_speckle_;  // each step under the law of speckle
  Explanation result_;
};

}  // namespace

Verdict VerdictOn(const LikelihoodDifference& gain, double bic_change,
                  const LikelihoodDifference& error_change, double tie_sigmas) {
  const double least = tie_sigmas * gain.sigma;
  const double least_error = tie_sigmas * error_change.sigma;
  if (gain.mean < -least) {
    return error_change.mean < -least_error ? Verdict::kContradicted : Verdict::kWorse;
  }
  if (!(gain.mean > least && bic_change < 0.0)) return Verdict::kNotSignificant;
  return error_change.mean > least_error ? Verdict::kContradicted : Verdict::kSignificant;
}

Explanation Explain(const Scene& scene, const SonarModel& sonar, const std::vector<GreyFrame>& used,
                    const std::vector<GreyFrame>& held_out, const ParameterSet& given,
                    const ExplainOptions& options) {
  if (used.empty()) throw DataError("explain: no frames");
  if (held_out.empty())
    throw DataError("explain: no frame is held out, expected at least one for the evaluation");
  if (given.materials.empty()) throw DataError("explain: the parameters name no material");
  return Explainer(scene, sonar, used, held_out, given, options).Run();
}

std::vector<PolarImage> ExpectedGrey(const ExplainedStep& step, const std::vector<GreyFrame>& held_out) {
  std::vector<PolarImage> images;
  for (std::size_t f = 0; f < held_out.size(); ++f) {
    const PolarImage& recorded = held_out[f].image;
    images.push_back(Shown(step.mean_held_out[f], recorded.axes, step.parameters, recorded.scale.full_scale,
                           step.knows_speckle));
    if (step.knows_speckle) continue;
    for (float& value : images.back().value.values()) {
      value = std::clamp(static_cast<float>(value + step.grey.offset), 0.0F,
                         static_cast<float>(recorded.scale.full_scale));
    }
  }
  return images;
}

}  // namespace sonarcal::calib
