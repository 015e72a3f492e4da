#include "apps/workflow/calibration/calibrate.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "apps/workflow/assumptions.h"
#include "apps/workflow/calibration/held_out_trial.h"
#include "apps/workflow/compare.h"
#include "apps/workflow/fit_frames.h"
#include "apps/workflow/frame_choice.h"
#include "apps/workflow/simulate.h"
#include "calib/models/move_slopes.h"
#include "calib/noise/noise_fit.h"
#include "calib/parameters/object_placement.h"
#include "calib/selection/declared_values.h"
#include "calib/selection/model_choice.h"
#include "calib/selection/model_variants.h"
#include "core/types/error.h"
#include "core/types/parse_number.h"
#include "data_io/pose_io.h"
#include "sim/gathered/empty_frames.h"

namespace sonarcal::workflow {
namespace {

using calib::FitConfig;
using calib::FittedParameter;
using calib::ParameterStatus;

// Largest KS distance of a noise law that is found in the frames themselves.
constexpr double kLargestKs = 0.05;

// Max number of steps of the search of the placement. It ends earlier if the likelihood no longer rises.
constexpr int kSearchSteps = 40;

// As above for other patterns of the beam, from where the search ended.
constexpr int kPatternSteps = 8;

// A mirror that loses more than this shows no ghosts.
constexpr double kNoMirrorDb = 40.0;

// Curve of a surface that is neither a mirror nor black: the start of every material.
constexpr GsabParameters<double> kStartCurve = {
    .a = 0.05, .b_deg = 5.0, .c = 0.005, .d = 1.5, .e = 0.02, .f_deg = 15.0};

std::string Names(const std::vector<std::string>& names) {
  return names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", "));
}

// Words for the gain of a trial.
std::string GainText(const calib::LikelihoodDifference& gain) {
  return fmt::format("held-out frames {:+.4f} +- {:.4f} nats a pixel", gain.mean, gain.sigma);
}

double Cost(const calib::AcousticFit& fit) {
  return fit.report.cost_final;
}

bool IsPlacementName(const std::string& name) {
  return name.starts_with("pose.") || name.starts_with("geometry.") || name.starts_with("object.");
}

// Part of a parameter's name after the last dot.
std::string_view Component(const std::string& name) {
  return std::string_view(name).substr(name.rfind('.') + 1);
}

bool IsAngle(const std::string& name) {
  return name.ends_with("_deg");
}

// Scatter of the corrections of the recorded poses about the correction that all have in common, which
// belongs to a mount or to the geometry.
calib::PosePrior ScatterOfPoses(const calib::FitReport& report) {
  struct Sums {
    double squares = 0.0;
    int freedom = 0;
  };
  Sums position;
  Sums angle;
  for (const char* component : calib::kPoseNames) {
    std::vector<double> moves;
    for (const FittedParameter& parameter : report.parameters) {
      if (parameter.name.starts_with("pose.") && Component(parameter.name) == component && parameter.sigma)
        moves.push_back(calib::Moved(parameter));
    }
    if (moves.size() < 2) continue;
    double mean = 0.0;
    for (const double move : moves) mean += move / static_cast<double>(moves.size());
    Sums& of = IsAngle(component) ? angle : position;
    for (const double move : moves) of.squares += (move - mean) * (move - mean);
    of.freedom += static_cast<int>(moves.size()) - 1;
  }
  calib::PosePrior prior;
  constexpr double kMinPositionM = 1e-3;
  constexpr double kMinAngleDeg = 0.05;
  if (position.freedom > 0)
    prior.position_m = std::max(kMinPositionM, std::sqrt(position.squares / position.freedom));
  if (angle.freedom > 0) prior.angle_deg = std::max(kMinAngleDeg, std::sqrt(angle.squares / angle.freedom));
  return prior;
}

// Names of the chosen forms.
std::vector<std::string> FormOf(const calib::ModelChoice& choice) {
  std::vector<std::string> names;
  for (const calib::JudgedAxis& axis : choice.axes)
    names.push_back(fmt::format("{} {}", ToString(axis.axis), axis.Chosen().name));
  return names;
}

// Names of the parameters that priors decide. Coefficients of curves are named once per material, and
// components of poses once for all frames.
std::vector<std::string> UndeterminedIn(const calib::FitReport& report) {
  std::vector<std::string> names;
  for (const FittedParameter& parameter : report.parameters) {
    if (parameter.status != ParameterStatus::kUnidentifiable) continue;
    std::string name = parameter.name;
    if (const std::size_t curve = name.find(".gsab."); curve != std::string::npos)
      name = fmt::format("some coefficients of the curve of {}", name.substr(9, curve - 9));
    if (name.starts_with("pose.")) name = fmt::format("{} of poses", Component(name));
    if (std::ranges::find(names, name) == names.end()) names.push_back(std::move(name));
  }
  return names;
}

// Recording whose beams have the pose of their frame.
class WithoutPings final : public RecordingSource {
 public:
  explicit WithoutPings(const RecordingSource& recording) : recording_(recording), info_(recording.info()) {
    info_.sonar.pings = {};
  }

  const RecordingInfo& info() const override { return info_; }
  int frame_count() const override { return recording_.frame_count(); }
  FrameInfo frame_info(int index) const override { return recording_.frame_info(index); }
  Frame ReadFrame(int index) const override { return recording_.ReadFrame(index); }

 private:
  const RecordingSource& recording_;
  RecordingInfo info_;
};

class Calibrator {
 public:
  Calibrator(const RecordingSource& recording, const Scene& scene, const CalibrateOptions& options,
             const CalibrationInput& input, const Listener& listener,
             const std::function<void(const CalibrationPlan&)>& on_stage)
      : recording_(recording),
        scene_(scene),
        sonar_(recording.info().sonar),
        options_(options),
        background_(input.background),
        listener_(listener),
        on_stage_(on_stage),
        plan_(input.plan) {
    solver_.threads = options.rays.threads;
    solver_.progress = listener.message;
    solver_.stop = listener.stop;
    solver_.starts = 2;
    solver_.test_others = false;
  }

  Calibration Run() {
    const ThreadLimit threads(options_.rays.threads);
    PrepareStart();
    Stage(CalibrationStage::kFrames, [&] { return ChooseFrames(); });
    CheckSceneIsSeen();
    Stage(CalibrationStage::kWater, [&] { return ChooseWaterAndAbsorption(); });
    Stage(CalibrationStage::kNoise, [&] { return ChooseNoise(); });
    Stage(CalibrationStage::kPlacement, [&] { return ChoosePlacement(); });
    Stage(CalibrationStage::kBeam, [&] { return ChooseBeam(); });
    Stage(CalibrationStage::kMirrors, [&] { return ChooseMirrors(); });
    return LastFits();
  }

 private:
  template <typename Decide>
  void Stage(CalibrationStage stage, const Decide& decide) {
    if (!plan_.Has(stage)) {
      Forget(stage);
      CalibrationDecision decision = decide();
      decision.stage = stage;
      plan_.decided.push_back(std::move(decision));
      if (on_stage_) on_stage_(plan_);
    }
    const auto& of = *std::ranges::find(plan_.decided, stage, &CalibrationDecision::stage);
    listener_.Message(fmt::format("{}: {}{}{}", ToString(stage), of.choice,
                                  of.reason.empty() ? "" : ", because ", of.reason));
  }

  // Drops what a plan says about a stage that it does not decide.
  void Forget(CalibrationStage stage) {
    std::vector<std::string>& free = *plan_.fit.free;
    if (stage == CalibrationStage::kPlacement) plan_.fit = Radiometry();
    if (stage == CalibrationStage::kNoise) std::erase(free, "receiver.noise_db");
    if (stage == CalibrationStage::kMirrors) {
      const auto of_mirrors = [](const std::string& name) {
        return name.starts_with("mirror.") || name == "beam.transmit_end_deg";
      };
      std::erase_if(free, of_mirrors);
      std::erase_if(plan_.fit.start, [&](const auto& start) { return of_mirrors(start.first); });
      plan_.parameters.mirrors.clear();
    }
  }

  // Fills in what a plan leaves open.
  void PrepareStart() {
    data_io::PosesOfRecording(recording_);  // throws if a frame has none
    if (plan_.Has(CalibrationStage::kFrames)) TakeFramesOfPlan();
    ParameterSet& start = plan_.parameters;
    start.model = EchoModel::kAcoustic;
    if (plan_.decided.empty() && recording_.info().source_level_db)
      start.source_level_db = *recording_.info().source_level_db;
    if (!options_.target.empty()) {
      Scene scene = scene_;
      calib::PlaceableObject(scene, options_.target);  // throws if there is no such node
    }
    if (start.materials.empty()) start.materials["default"].gsab = kStartCurve;
    if (!plan_.fit.free) plan_.fit.free = std::vector<std::string>{"materials"};
    AddMaterialPriors(options_.materials, start, scene_, plan_.fit);
    for (const std::string& sentence :
         MaterialCaveats(options_.materials, start, scene_, sonar_.frequency_hz))
      listener_.Message(sentence);
    // A wrong width would turn and shift the objects, so a width that is not stated is fitted.
    for (const AssumedWidth& width : AssumeWidths(sonar_, start.beam)) {
      plan_.fit.free->emplace_back(width.name);
      assumed_.push_back(
          fmt::format("{}: neither the recording nor the parameters state it, so it is fitted", width.name));
    }
    std::ranges::copy(AssumeMissing(recording_.info().scale, /*find_display=*/true, sonar_, start),
                      std::back_inserter(assumed_));
  }

  // Throws DataError unless the plan names frames of the recording. Held-out frames are not fitted.
  void TakeFramesOfPlan() {
    FitConfig& fit = plan_.fit;
    if (!fit.used || fit.used->empty())
      throw DataError("the plan decides the stage 'frames', but its fit.used names no frame, expected one");
    if (!fit.held_out) {
      throw DataError(
          "the plan decides the stage 'frames', but has no fit.held_out, expected a list, which may be "
          "empty");
    }
    fit.used = calib::SplitFrames(fit, recording_.frame_count()).used;
  }

  CalibrationDecision ChooseFrames() {
    if (options_.frames.empty() && recording_.frame_count() > options_.limits.max_frames)
      return ChooseOfMany();
    std::vector<int> frames = options_.frames.In(recording_.frame_count());
    std::ranges::sort(frames);
    if (frames.empty()) {
      frames.resize(recording_.frame_count());
      std::iota(frames.begin(), frames.end(), 0);
    }
    std::vector<int> used;
    std::vector<int> held_out;
    for (std::size_t i = 0; i < frames.size(); ++i) {
      const bool last_of_two = frames.size() == 2 && i == 1;
      (i % 3 == 2 || last_of_two ? held_out : used).push_back(frames[i]);
    }
    plan_.fit.used = used;
    plan_.fit.held_out = held_out;
    if (held_out.empty()) {
      return {"the only frame is fitted",
              "nothing else is there, so that no choice can be tried on another frame"};
    }
    CalibrationDecision decision{fmt::format("{} of {} frames are fitted, {} held out", used.size(),
                                             recording_.frame_count(), held_out.size()),
                                 "the held-out ones decide the choices below"};
    SayIfRepeated(decision);
    return decision;
  }

  // Frames of a long recording, by the information that they are expected to give.
  CalibrationDecision ChooseOfMany() {
    const ChosenFrames chosen = workflow::ChooseFrames({.scene = scene_,
                                                        .sonar = sonar_,
                                                        .water = WaterOf(),
                                                        .absorption = options_.rays.absorption,
                                                        .parameters = plan_.parameters},
                                                       data_io::PosesOfRecording(recording_),
                                                       {.limits = options_.limits, .fits_held_out = true});
    plan_.fit.used = chosen.used;
    plan_.fit.held_out = chosen.held_out;
    CalibrationDecision decision{chosen.choice, chosen.reason};
    SayIfRepeated(decision);
    return decision;
  }

  // Says it if held-out frames show nothing but what fitted ones show.
  void SayIfRepeated(CalibrationDecision& decision) const {
    const std::vector<int>& used = *plan_.fit.used;
    const std::vector<int>& held_out = *plan_.fit.held_out;
    if (held_out.empty()) return;
    const std::vector<data_io::TimedPose> poses = data_io::PosesOfRecording(recording_);
    const auto is_fitted_pose = [&](int frame) {
      return std::ranges::any_of(used, [&](int other) {
        return IsSamePose(poses[other].world_from_sonar, poses[frame].world_from_sonar);
      });
    };
    if (std::ranges::all_of(held_out, is_fitted_pose)) {
      decision.open.emplace_back(
          "whether the choices hold elsewhere: the held-out frames have poses of fitted ones, and their "
          "speckle if the scene is static");
    }
  }

  void CheckSceneIsSeen() const {
    const std::string warning =
        sim::CheckSceneIsSeen(MakeSimulator(plan_.parameters),
                              data_io::PosesAlone(data_io::PosesOfRecording(recording_)), *plan_.fit.used);
    if (!warning.empty()) listener_.Message(warning);
  }

  CalibrationDecision ChooseWaterAndAbsorption() {
    plan_.absorption = options_.rays.absorption;
    const WaterChoice water = ChooseWater(plan_.parameters, recording_.info().water);
    const std::string caveat = sim::AbsorptionCaveat(plan_.absorption, sonar_.frequency_hz, water.water);
    const bool known = plan_.parameters.water || recording_.info().water;
    return {
        fmt::format("{}, absorption '{}'", WaterText(water.water), ToString(plan_.absorption)),
        known ? (caveat.empty() ? "the recording states the water" : caveat)
              : "nothing states a water, so fresh water is assumed; the levels of the curves absorb the rest",
        assumed_};
  }

  // Display and noise law. The level of the noise is fitted with the curves unless pings without targets gave
  // it.
  CalibrationDecision ChooseNoise() {
    ParameterSet& start = plan_.parameters;
    const ImageScale& scale = recording_.info().scale;
    const bool scaled = scale.db_min && scale.db_max;
    if (background_ != nullptr) {
      const calib::NoiseFit noise = calib::FitNoise(*background_, NoiseOptions());
      if (!noise.usable) throw DataError("calibrate: the noise law of the background has no usable solution");
      start.display = noise.law.display;
      start.receiver = noise.law.receiver;
      return {fmt::format("display '{}' and noise law of {} pings without targets",
                          ToString(start.display.law), background_->frame_count()),
              fmt::format("they are given, and the law agrees with them to a KS distance of {:.4f}",
                          noise.judged.ks)};
    }
    plan_.fit.free->push_back("receiver.noise_db");
    if (scaled) {
      TakeDisplay(scale, start);
      return {fmt::format("logarithm from {:g} to {:g} dB, noise level fitted", *scale.db_min, *scale.db_max),
              "the recording states its scale"};
    }
    calib::NoiseFitOptions options = NoiseOptions();
    options.find_background = true;
    options.hold_out_bands = recording_.frame_count() < 4;
    std::string why = "no law fits the darkest window of the frames";
    try {
      const calib::NoiseFit noise = calib::FitNoise(recording_, options);
      if (noise.usable && noise.judged.ks < kLargestKs) {
        start.display = noise.law.display;
        start.receiver = noise.law.receiver;
        const auto [near_m, far_m] = std::pair{noise.cells.axes.range_edge_m(noise.cells.first_bin),
                                               noise.cells.axes.range_edge_m(noise.cells.last_bin)};
        return {fmt::format("display '{}', {:.3g} looks", ToString(start.display.law), start.receiver.looks),
                fmt::format("it describes the background of the frames, from {:.2f} to {:.2f} m, to a KS "
                            "distance of {:.4f}",
                            near_m, far_m, noise.judged.ks)};
      }
    } catch (const DataError& error) {
      why = error.what();
    }
    start.display = {.db_min = 0.0, .db_max = scale.db_span.value_or(kAssumedSpanDb)};
    return {
        fmt::format("logarithm over {:g} dB", start.display.db_max),
        fmt::format("{}{}", why, scale.db_span ? "; the recording states the span" : "; the span is assumed"),
        {"the display: levels are relative to its lower end"}};
  }

  calib::NoiseFitOptions NoiseOptions() const {
    calib::NoiseFitOptions options;
    options.progress = listener_.message;
    return options;
  }

  // Poses, geometry of the sonar and objects: all are tried together, and those that the frames agree with
  // stay as declared.
  CalibrationDecision ChoosePlacement() {
    std::vector<std::string> objects = MovableObjects(scene_);
    if (!options_.target.empty()) objects = {options_.target};
    if (!(plan_.parameters.pulse.length_m > 0.0)) plan_.fit.free->push_back("pulse.length_m");
    const sim::Simulator simulator = MakeSimulator(WithLobes());
    HeldOutTrials trials(simulator, GreyFrames(recording_, *plan_.fit.used),
                         GreyFrames(recording_, *plan_.fit.held_out));
    if (!plan_.Has(CalibrationStage::kMirrors)) Forget(CalibrationStage::kMirrors);
    listener_.Message("placement: fitting curves at the recorded poses");
    const Trial plain = trials.Try(WithNoiseLevel(trials.used()), Radiometry(), ValuesOnly(solver_));
    FoundMirrors mirrors;
    if (!plan_.Has(CalibrationStage::kMirrors)) mirrors = FindMirrors(trials, plain);
    ParameterSet start = WithNoiseLevel(trials.used());
    start.pulse = plain.fit.parameters.pulse;
    start.beam = plain.fit.parameters.beam;
    const BlockSearch blocks{.parameters = start, .objects = objects};
    const Searched searched = mirrors.names.empty() ? SearchPlacement(trials, plain, blocks)
                                                    : SearchWithMirrors(trials, plain, mirrors, blocks);
    plan_ = searched.plan;
    listener_.Message("placement: fitting it to all pixels");
    const Trial moved = trials.Try(WithNoiseLevel(trials.used()), searched.config, Near());
    const calib::LikelihoodDifference gain = HeldOutTrials::Gain(moved, searched.as_recorded);
    if (!trials.held_out().empty() && !IsSignificant(gain)) {
      plan_ = searched.plan_as_recorded;
      return {"poses, geometry and objects as declared",
              "moving them does not raise the likelihood: " + GainText(gain)};
    }
    return TakePlacement(trials, moved, searched.config, gain);
  }

  struct FoundMirrors {
    std::vector<std::string> names = {};  // materials
    Trial with = {};
    calib::LikelihoodDifference gain = {};
  };

  // Start of a search on blocks of pixels.
  struct BlockSearch {
    ParameterSet parameters = {};
    std::vector<std::string> objects = {};               // to be placed
    std::vector<std::vector<float>> repeat_shares = {};  // as in FitOptions
  };

  struct Searched {
    Trial as_recorded = {};  // with the placement fixed
    CalibrationPlan plan_as_recorded = {};
    FitConfig config = {};  // with the placement free
    CalibrationPlan plan = {};
    calib::AcousticFit found = {};  // on blocks
  };

  // Ghosts of mirrors look like another placement of sonar and objects, and a wrong placement looks like
  // ghosts. So the placement is searched with the mirrors that were found at the recorded poses, and without
  // any. Mirrors must lower the cost by `kNatsPerValue` for each of their values. Ten nats are more than the
  // Bayesian criterion asks for a million pixels: half the logarithm of their number, 6.9.
  Searched SearchWithMirrors(HeldOutTrials& trials, const Trial& plain, const FoundMirrors& mirrors,
                             BlockSearch blocks) {
    constexpr double kNatsPerValue = 10.0;
    const CalibrationPlan before = plan_;
    FreeMirrors(mirrors.names, plan_.fit);
    const std::size_t values = plan_.fit.free->size() - before.fit.free->size();
    listener_.Message(fmt::format("placement: with ghosts by {}, because {}", Names(mirrors.names),
                                  GainText(mirrors.gain)));
    Searched with = SearchPlacement(trials, mirrors.with, blocks);
    plan_ = before;
    listener_.Message("placement: the same without ghosts");
    blocks.repeat_shares = with.found.repeat_shares;
    Searched without = SearchPlacement(trials, plain, blocks);
    if (Cost(with.found) + kNatsPerValue * static_cast<double>(values) < Cost(without.found)) return with;
    listener_.Message("placement: without ghosts, because the placement explains the frames as well");
    // Staying at the recorded poses is still judged with ghosts.
    without.as_recorded = std::move(with.as_recorded);
    without.plan_as_recorded = std::move(with.plan_as_recorded);
    return without;
  }

  Searched SearchPlacement(HeldOutTrials& trials, const Trial& as_recorded, const BlockSearch& blocks) {
    // At wrong poses, the pattern that looks best is often a wrong one. From it the search does not find the
    // right placement. So it starts with the given pattern. Staying at the recorded poses is judged with the
    // best one there.
    Searched searched{.as_recorded = as_recorded};
    const CalibrationPlan given = plan_;
    StartAt(as_recorded.fit.report, plan_.fit);
    if (!plan_.Has(CalibrationStage::kBeam)) TryElevation(trials, searched.as_recorded);
    StartAt(searched.as_recorded.fit.report, plan_.fit);
    searched.plan_as_recorded = plan_;
    plan_ = given;
    StartAt(as_recorded.fit.report, plan_.fit);

    FitConfig config = Radiometry();
    config.start = plan_.fit.start;
    for (const char* name : {"pose", "geometry.range_*", "geometry.azimuth_offset_deg",
                             "geometry.azimuth_scale", "geometry.azimuth_cubic"})
      config.free->push_back(name);
    for (const std::string& object : blocks.objects) config.free->push_back("object:" + object);
    calib::FitOptions search = solver_;
    search.joint_steps = kSearchSteps;
    search.repeat_shares = blocks.repeat_shares;
    listener_.Message("placement: searching poses, geometry of the sonar and objects on blocks of pixels");
    calib::AcousticFit found = trials.Search(blocks.parameters, config, search);
    search.repeat_shares = found.repeat_shares;
    // The scatter of the poses is unknown at first. With it, the common part of their errors can be told from
    // the geometry.
    if (plan_.fit.used->size() > 1) {
      config.pose_prior = ScatterOfPoses(found.report);
      listener_.Message(
          fmt::format("placement: again, with poses that scatter by {:.3g} m and {:.2g} degrees",
                      config.pose_prior.position_m, config.pose_prior.angle_deg));
      StartAt(found.report, plan_.fit);
      config.start = plan_.fit.start;
      found = trials.Search(blocks.parameters, config, ValuesOnly(search));
    }
    StartAt(found.report, plan_.fit);
    config.start = plan_.fit.start;
    if (!plan_.Has(CalibrationStage::kBeam) && !trials.held_out().empty()) {
      calib::FitOptions near = ValuesOnly(Near());
      near.repeat_shares = search.repeat_shares;
      const double recorded_cost = Cost(trials.Search(blocks.parameters, Radiometry(), near));
      SearchElevation(trials, blocks.parameters, config, recorded_cost - Cost(found), found);
      StartAt(found.report, plan_.fit);
      config.start = plan_.fit.start;
    }
    searched.config = std::move(config);
    searched.plan = plan_;
    searched.found = std::move(found);
    return searched;
  }

  // Chooses the elevation pattern at the recorded poses. Poses and objects would otherwise seem to have
  // moved, to make up for a wrong one.
  void TryElevation(HeldOutTrials& trials, Trial& as_recorded) {
    if (trials.held_out().empty()) return;
    const BeamParameters before = plan_.parameters.beam;
    const calib::ModelChoice chosen =
        ChooseForm(trials.simulator(), trials.used(), trials.held_out(), {calib::ChoiceAxis::kElevation});
    listener_.Message(fmt::format("placement: at the recorded poses, {}", Names(FormOf(chosen))));
    if (plan_.parameters.beam == before) return;
    as_recorded = trials.Try(WithNoiseLevel(trials.used()), Radiometry(), ValuesOnly(Solver()));
  }

  // Tries the other elevation patterns, each with poses, geometry and objects free. `found`: the search with
  // the given pattern. `fall`: of its cost from the recorded placement. A pattern that is worse by more than
  // that at the placement found is not searched, because no placement can be expected to make up for it. One
  // that lowers the cost by less than kNatsOfAnother is no better: the odds are below 20 to 1. Blocks of
  // pixels are too wide to tell azimuth patterns apart.
  void SearchElevation(const HeldOutTrials& trials, ParameterSet best, const FitConfig& config, double fall,
                       calib::AcousticFit& found) {
    constexpr double kNatsOfAnother = 3.0;
    calib::FitOptions near = ValuesOnly(Near());
    near.joint_steps = kPatternSteps;
    const Placed placed = PlacedFrames(WithLobes());
    const HeldOutTrials at_found(*placed.simulator, placed.used, placed.held_out);
    const calib::AcousticFit given = at_found.Search(best, Radiometry(), near);
    const double most = Cost(given) + fall;
    calib::FitOptions as_given = near;
    as_given.repeat_shares = given.repeat_shares;
    near.repeat_shares = found.repeat_shares;
    found = trials.Search(best, config, near);  // as many steps as the others
    for (const calib::ModelVariant& variant : calib::ElevationVariants(best.beam)) {
      if (variant.given) continue;
      listener_.Message(fmt::format("placement: the same with elevation {}", variant.name));
      ParameterSet other = best;
      variant.apply(other);
      if (Cost(at_found.Search(other, Radiometry(), as_given)) > most) continue;
      calib::AcousticFit searched = trials.Search(other, config, near);
      if (Cost(searched) > Cost(found) - kNatsOfAnother) continue;
      found = std::move(searched);
      best = std::move(other);
      variant.apply(plan_.parameters);
    }
  }

  // Frees what was declared wrongly, and starts the last fit at the values found. All else goes back to what
  // is declared, and the poses are then fitted again. Values that the frames agree with stay free if another
  // value of their origin is wrong: as known ones, they would make standard errors too small.
  CalibrationDecision TakePlacement(HeldOutTrials& trials, const Trial& moved, const FitConfig& config,
                                    const calib::LikelihoodDifference& gain) {
    const std::vector<std::string> wrong =
        calib::ContradictedOrigins(calib::DeclaredPlacement(moved.fit.report));
    const auto is_wrong = [&](const std::string& name) {
      return std::ranges::find(wrong, calib::OriginOf(name)) != wrong.end();
    };
    std::vector<std::string> left;
    for (const FittedParameter& parameter : moved.fit.report.parameters) {
      const std::string origin = calib::OriginOf(parameter.name);
      if (origin.empty() || parameter.status == ParameterStatus::kFixed) continue;
      if (!is_wrong(parameter.name)) {
        if (std::ranges::find(left, origin) == left.end()) left.push_back(origin);
      } else if (!parameter.name.starts_with("pose.")) {
        plan_.fit.free->push_back(parameter.name);
      }
    }
    const bool poses = is_wrong("pose.");
    if (poses) {
      plan_.fit.free->push_back("pose");
      plan_.fit.pose_prior = config.pose_prior;
    }
    FitConfig taken = plan_.fit;
    taken.start.clear();
    StartAt(moved.fit.report, taken);
    std::erase_if(taken.start,
                  [&](const auto& start) { return IsPlacementName(start.first) && !is_wrong(start.first); });
    plan_.fit.start = taken.start;
    constexpr const char* kAgree = "the frames agree with what is declared";
    if (wrong.empty()) return {"poses, geometry and objects as declared", kAgree};
    if (poses && !left.empty()) {
      listener_.Message(fmt::format("placement: again, with {} as declared", Names(left)));
      calib::FitOptions near = Near();
      near.joint_steps = kPatternSteps;
      StartWithPoses(trials.Try(WithNoiseLevel(trials.used()), taken, near));
    } else if (poses) {
      StartWithPoses(moved);
    }
    std::string choice = Names(wrong) + " fitted";
    if (poses)
      choice += fmt::format("; recorded poses scatter by {:.3g} m and {:.2g} degrees",
                            config.pose_prior.position_m, config.pose_prior.angle_deg);
    std::vector<std::string> open;
    if (!left.empty()) {
      choice += fmt::format("; {} as declared", Names(left));
      open.push_back(fmt::format("{}: {}", Names(left), kAgree));
    }
    return {choice, plan_.fit.held_out->empty() ? "no frame is held out" : GainText(gain), open};
  }

  // Takes the values of a trial with free poses, those of the held-out frames included.
  void StartWithPoses(const Trial& trial) {
    StartAt(trial.fit.report, plan_.fit);
    for (std::size_t i = 0; i < trial.held_out_poses.size(); ++i) {
      const calib::PoseStep named = calib::NamedValues(trial.held_out_poses[i]);
      for (int k = 0; k < calib::kPoseSteps; ++k)
        plan_.fit.start[fmt::format("pose.{}.{}", plan_.fit.held_out->at(i), calib::kPoseNames[k])] =
            named(k);
    }
  }

  // Stages after the placement keep it fixed: what a beam looks like does not move a wall.
  struct Placed {
    std::shared_ptr<const sim::Simulator> simulator;
    std::vector<calib::GreyFrame> used;
    std::vector<calib::GreyFrame> held_out;
  };

  Placed PlacedFrames(const ParameterSet& parameters) const {
    Placed placed{.simulator = {},
                  .used = GreyFrames(recording_, *plan_.fit.used),
                  .held_out = GreyFrames(recording_, *plan_.fit.held_out)};
    SonarModel sonar = sonar_;
    SonarGeometry geometry;
    std::map<std::string, calib::ObjectPlacement> objects;
    for (const auto& [name, value] : plan_.fit.start) {
      if (name.starts_with("geometry.")) calib::SetGeometry(name, value, geometry);
      if (!name.starts_with("object.")) continue;
      const std::string object = name.substr(7, name.rfind('.') - 7);
      const auto* const component = std::ranges::find(calib::kPoseNames, Component(name));
      objects[object].step(component - calib::kPoseNames.begin()) = value;
    }
    sonar.axes = Corrected(sonar.axes, geometry);
    Scene scene = scene_;
    for (const auto& [name, placement] : objects) calib::PlaceableObject(scene, name).Place(placement, scene);
    for (std::vector<calib::GreyFrame>* frames : {&placed.used, &placed.held_out}) {
      for (calib::GreyFrame& frame : *frames) {
        calib::PoseStep named = calib::NamedValues(frame.world_from_sonar);
        for (int k = 0; k < calib::kPoseSteps; ++k) {
          const auto found =
              plan_.fit.start.find(fmt::format("pose.{}.{}", frame.index, calib::kPoseNames[k]));
          if (found != plan_.fit.start.end()) named(k) = found->second;
        }
        frame.world_from_sonar = Tilted(calib::PoseFromNamedValues(named), geometry);
      }
    }
    placed.simulator =
        std::make_shared<const sim::Simulator>(std::move(scene), sonar, OfTrials(sonar, parameters));
    return placed;
  }

  CalibrationDecision ChooseBeam() {
    if (plan_.fit.held_out->empty()) {
      return {"as stated; a width that is not stated is fitted",
              "no frame is held out",
              {"the pattern of the beams and the looks: a second frame decides them"}};
    }
    const Placed placed = PlacedFrames(WithLobes());
    const calib::ModelChoice chosen = ChooseForm(*placed.simulator, placed.used, placed.held_out,
                                                 {calib::ChoiceAxis::kPattern, calib::ChoiceAxis::kElevation,
                                                  calib::ChoiceAxis::kLooks, calib::ChoiceAxis::kTrend});
    return {Names(FormOf(chosen)),
            "the likelihood of the held-out frames is the best, or as good with fewer values"};
  }

  // Parameters for which the rays reach every lobe of any pattern.
  ParameterSet WithLobes() const {
    ParameterSet parameters = plan_.parameters;
    parameters.beam.elevation_pattern = ElevationPattern::kCosine;
    return parameters;
  }

  // Frames that the forms of the model are fitted to: evenly spread, max kPixels together. Forms differ by
  // far more than what further frames would change.
  static std::vector<calib::GreyFrame> Some(const std::vector<calib::GreyFrame>& frames) {
    constexpr std::size_t kPixels = 2'000'000;
    constexpr std::size_t kMinFrames = 2;
    const std::size_t pixels = frames.empty() ? 1 : frames.front().image.value.size();
    const std::size_t wanted = std::max(kMinFrames, kPixels / std::max<std::size_t>(1, pixels));
    if (frames.size() <= wanted) return frames;
    std::vector<calib::GreyFrame> some;
    for (std::size_t i = 0; i < wanted; ++i) some.push_back(frames[i * frames.size() / wanted]);
    return some;
  }

  // Chooses forms of the model with the placement fixed, and takes them into the plan.
  calib::ModelChoice ChooseForm(const sim::Simulator& simulator, const std::vector<calib::GreyFrame>& used,
                                const std::vector<calib::GreyFrame>& held_out,
                                std::vector<calib::ChoiceAxis> axes) {
    const std::vector<calib::GreyFrame> some = Some(used);
    calib::ModelChoice chosen = calib::ChooseModel(simulator, some, held_out, WithNoiseLevel(used),
                                                   Radiometry(), {.axes = std::move(axes), .fit = Solver()});
    const bool had_level = plan_.parameters.receiver.noise_db.has_value();
    plan_.parameters = chosen.parameters;
    if (!had_level) plan_.parameters.receiver.noise_db.reset();
    for (const std::string& name : chosen.config.free.value_or(std::vector<std::string>())) {
      if (std::ranges::find(*plan_.fit.free, name) == plan_.fit.free->end()) plan_.fit.free->push_back(name);
    }
    return chosen;
  }

  CalibrationDecision ChooseMirrors() {
    if (plan_.fit.held_out->empty()) {
      return {"none", "no frame is held out", {"mirrors: a second frame decides them"}};
    }
    const Placed placed = PlacedFrames(plan_.parameters);
    HeldOutTrials trials(*placed.simulator, placed.used, placed.held_out);
    const Trial without = trials.Try(WithNoiseLevel(placed.used), Radiometry(), ValuesOnly(Solver()));
    const FoundMirrors mirrors = FindMirrors(trials, without);
    if (mirrors.names.empty())
      return {"none", "ghosts do not raise the likelihood: " + GainText(mirrors.gain)};
    FreeMirrors(mirrors.names, plan_.fit);
    const calib::ModelChoice lobes =
        ChooseForm(*placed.simulator, placed.used, placed.held_out, {calib::ChoiceAxis::kMirrors});
    return {fmt::format("{}, seen {}", Names(mirrors.names), lobes.axes.front().Chosen().name),
            "their ghosts raise the likelihood: " + GainText(mirrors.gain)};
  }

  // Tries every material as a mirror; those without ghosts drop out. Finds none without held-out frames.
  FoundMirrors FindMirrors(HeldOutTrials& trials, const Trial& without) const {
    FoundMirrors found;
    if (trials.held_out().empty()) return found;
    const std::string scored = ScoredMaterial();
    for (const std::string& material : scene_.material_names) {
      if (material != scored) found.names.push_back(material);
    }
    const calib::FitReport* nearest = &without.fit.report;
    while (!found.names.empty()) {
      FitConfig config = Radiometry();
      StartAt(*nearest, config);
      FreeMirrors(found.names, config);
      found.with = trials.Try(WithNoiseLevel(trials.used()), config, Near());
      nearest = &found.with.fit.report;
      found.gain = HeldOutTrials::Gain(found.with, without);
      const std::size_t before = found.names.size();
      std::erase_if(found.names, [&](const std::string& name) {
        const FittedParameter* loss = found.with.fit.report.Find(MirrorLoss(name));
        return loss == nullptr || loss->status != ParameterStatus::kFree || loss->value > kNoMirrorDb;
      });
      if (!IsSignificant(found.gain)) found.names.clear();
      if (found.names.size() == before) break;
    }
    return found;
  }

  static std::string MirrorLoss(const std::string& material) {
    return fmt::format("mirror.{}.loss_db", material);
  }

  static void FreeMirrors(const std::vector<std::string>& materials, FitConfig& config) {
    std::ranges::transform(materials, std::back_inserter(*config.free), MirrorLoss);
    config.free->emplace_back("beam.transmit_end_deg");
  }

  Calibration LastFits() {
    Calibration calibration;
    if (plan_.fit.held_out->empty()) {
      calibration.fit = LastFit(plan_.fit, /*test_others=*/true);
      calibration.evaluation = calibration.fit;
    } else {
      listener_.Message("last fit without the held-out frames, for the figures");
      calibration.evaluation = LastFit(plan_.fit, /*test_others=*/false);
      FitConfig all = plan_.fit;
      all.used->insert(all.used->end(), all.held_out->begin(), all.held_out->end());
      std::ranges::sort(*all.used);
      all.held_out->clear();
      listener_.Message("last fit to all frames, for the values");
      calibration.fit = LastFit(all, /*test_others=*/true);
    }
    for (const CalibrationDecision& decision : plan_.decided)
      calibration.open.insert(calibration.open.end(), decision.open.begin(), decision.open.end());
    const std::vector<std::string> undetermined = UndeterminedIn(calibration.fit.fit.report);
    if (!undetermined.empty())
      calibration.open.push_back(fmt::format("{}: priors decide", Names(undetermined)));
    calibration.plan = plan_;
    return calibration;
  }

  // `test_others`: whether other curves or poses fit equally well.
  RecordingFit LastFit(FitConfig config, bool test_others) {
    // Start values of poses that are not among the frames of this fit have no parameter.
    std::erase_if(config.start, [&](const auto& start) {
      if (!start.first.starts_with("pose.")) return false;
      int frame = 0;
      const std::string_view name = std::string_view(start.first).substr(5);
      return ParseNumber(name.substr(0, name.find('.')), frame) &&
             std::ranges::find(*config.used, frame) == config.used->end();
    });
    FitRecordingOptions fit;
    fit.rays = Rays();
    fit.config = std::move(config);
    ComparisonOptions comparison;
    comparison.object = ScoredMaterial();
    fit.comparison = comparison.For(recording_.info().sonar.axes);
    fit.fit = Near();
    fit.fit.test_others = test_others;
    fit.on_note = listener_.message;
    fit.on_trace = [&](int done, int total) { listener_.Progress("Tracing", done, total); };
    RecordingFit last = FitRecording(recording_, scene_, plan_.parameters, fit);
    // The decisions say what is assumed.
    SonarModel stated = recording_.info().sonar;
    ParameterSet of_plan = plan_.parameters;
    for (const std::string& sentence :
         AssumeMissing(recording_.info().scale, /*find_display=*/false, stated, of_plan))
      std::erase(last.fit.report.warnings, sentence);
    return last;
  }

  // Material of the target, or of the only object that may stand elsewhere. A node without a material of its
  // name is scored as the whole image is.
  std::string ScoredMaterial() const {
    const std::vector<std::string> objects = MovableObjects(scene_);
    const std::string name =
        options_.target.empty() && objects.size() == 1 ? objects.front() : options_.target;
    return std::ranges::find(scene_.material_names, name) != scene_.material_names.end() ? name
                                                                                         : std::string();
  }

  // Configuration of a fit with the placement fixed.
  FitConfig Radiometry() const {
    FitConfig config = plan_.fit;
    std::erase_if(*config.free, [](const std::string& name) {
      return name == "pose" || IsPlacementName(name) || name.starts_with("object:");
    });
    std::erase_if(config.start, [](const auto& start) { return IsPlacementName(start.first); });
    return config;
  }

  // Options of a fit of the radiometry, which an earlier fit may have started.
  calib::FitOptions Solver() const {
    const bool started = std::ranges::any_of(
        plan_.fit.start, [](const auto& start) { return start.first.starts_with("material."); });
    return started ? Near() : solver_;
  }

  // Options without standard errors, for fits of which only values and costs are taken.
  static calib::FitOptions ValuesOnly(calib::FitOptions options) {
    options.standard_errors = false;
    return options;
  }

  // Options of fits that start where an earlier one ended.
  calib::FitOptions Near() const {
    calib::FitOptions near = solver_;
    near.near_start = true;
    near.starts = 1;
    return near;
  }

  RayOptions Rays() const {
    RayOptions rays = options_.rays;
    rays.absorption = plan_.absorption;
    return rays;
  }

  Water WaterOf() const { return ChooseWater(plan_.parameters, recording_.info().water).water; }

  sim::Simulator MakeSimulator(const ParameterSet& parameters) const {
    return {scene_, sonar_, OfTrials(sonar_, parameters)};
  }

  // Trials differ by far more than what their rays at edges change. So they have fewer rays than the last
  // fits.
  sim::SimulationOptions OfTrials(const SonarModel& sonar, const ParameterSet& parameters) const {
    constexpr int kDecimation = 2;
    sim::SimulationOptions options = AcousticSimulation(Rays(), sonar, WaterOf(), parameters);
    options.fan = calib::Decimated(sonar, options.fan, kDecimation);
    return options;
  }

  ParameterSet WithNoiseLevel(const std::vector<calib::GreyFrame>& frames) const {
    return calib::WithNoiseStart(plan_.parameters, calib::FramesFor(frames, plan_.parameters.display));
  }

  const RecordingSource& recording_;
  const Scene& scene_;
  SonarModel sonar_;  // as stated and, where nothing is, as assumed
  const CalibrateOptions& options_;
  const RecordingSource* background_;
  const Listener& listener_;
  const std::function<void(const CalibrationPlan&)>& on_stage_;
  CalibrationPlan plan_;
  calib::FitOptions solver_;
  std::vector<std::string> assumed_;  // sentences
};

}  // namespace

std::vector<std::string> MovableObjects(const Scene& scene) {
  constexpr std::size_t kMax = 3;
  constexpr double kOfScene = 0.5;
  constexpr double kFlat = 0.02;  // of the longest side
  Eigen::AlignedBox3f whole;
  for (const Eigen::Vector3f& vertex : scene.vertices_m) whole.extend(vertex);
  std::vector<std::pair<double, std::string>> found;  // by volume of the box
  const auto add = [&](const std::string& name, const Eigen::AlignedBox3f& box) {
    const Eigen::Vector3f size = box.sizes();
    const Eigen::Vector3f of_scene = whole.sizes();
    const bool inside = size.x() <= kOfScene * of_scene.x() && size.y() <= kOfScene * of_scene.y();
    if (inside && size.minCoeff() > kFlat * size.maxCoeff()) found.emplace_back(-box.volume(), name);
  };
  for (const SceneObject& object : scene.objects) {
    Eigen::AlignedBox3f box;
    for (std::size_t i = 0; i < object.vertex_count; ++i)
      box.extend(scene.vertices_m[object.first_vertex + i]);
    add(object.name, box);
  }
  if (scene.objects.empty()) {
    std::vector<Eigen::AlignedBox3f> boxes(scene.material_names.size());
    for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
      for (const int vertex : scene.triangles[i])
        boxes[scene.triangle_material[i]].extend(scene.vertices_m[vertex]);
    }
    for (std::size_t i = 0; i < boxes.size(); ++i) add(scene.material_names[i], boxes[i]);
  }
  std::ranges::sort(found);
  std::vector<std::string> names;
  for (const auto& [volume, name] : found) {
    if (names.size() < kMax && std::ranges::find(names, name) == names.end()) names.push_back(name);
  }
  return names;
}

Calibration Calibrate(const RecordingSource& recording, const Scene& scene, const CalibrateOptions& options,
                      const CalibrationInput& input, const Listener& listener,
                      const std::function<void(const CalibrationPlan&)>& on_stage) {
  if (options.pings == PingUse::kIgnore) {
    const WithoutPings one_pose(recording);
    return Calibrator(one_pose, scene, options, input, listener, on_stage).Run();
  }
  return Calibrator(recording, scene, options, input, listener, on_stage).Run();
}

}  // namespace sonarcal::workflow
