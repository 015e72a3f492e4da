#include "calib/acoustic_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "calib/geometry_ambiguity.h"
#include "calib/joint_steps.h"
#include "calib/mirror_start.h"
#include "calib/models/move_slopes.h"
#include "calib/parameters/placement_steps.h"
#include "calib/poses/pose_ambiguity.h"
#include "calib/poses/pose_refinement.h"
#include "calib/problem_builder.h"
#include "core/math/statistics.h"
#include "core/types/error.h"
#include "core/types/units.h"

namespace sonarcal::calib {
namespace {

// Max number of rounds, each about a new point. Rounds end if the largest move, as a fraction of its reach,
// is below kJointSettled.
constexpr int kJointRounds = 10;
constexpr double kJointSettled = 0.05;
constexpr double kShrink = 0.1;  // factor of the reach after a rejected move

// Min predicted fall of the cost of a joint step, as a fraction of the effect of noise on one parameter: the
// search ends about a third of a standard error from the best values.
constexpr double kLeastGain = 0.1;

// Scan of a width: factor of a step, max number of steps, and pixels of all frames together.
constexpr double kScanFactor = 1.5;
constexpr int kScanSteps = 6;
constexpr std::size_t kScanPixels = 200'000;

// Reach of the last solve for poses that joint steps have settled, as a fraction of the reach of a round.
constexpr double kHeld = 0.02;

// Max number of moves to better poses away from the present ones, and the min gain of a move.
constexpr int kPoseMovesToBetter = 3;
constexpr double kBetterNats = 1.0;

// Max number of joint steps after such a move. Few frames move, so the curves change little.
constexpr int kStepsAfterMove = 2;

// Rounds of reducing the weight of pixels that do not match the scene.
constexpr int kWeightRounds = 2;

// Reach of a geometric parameter in one round: for placements a quarter of a speckle cell, otherwise a fifth
// of its value.
double Reach(const CatalogEntry& entry, double value, const AcousticFrameModel& model) {
  constexpr double kOfWidth = 0.2;
  constexpr double kOfCell = 0.25;
  if (!IsPlacement(entry)) return kOfWidth * value;
  const double step = 2.0 * PlacementDifference(model.sonar().axes, entry);
  const bool along_range = entry.unit == "m" || entry.name.ends_with("range_scale");
  return kOfCell * step * (along_range ? model.speckle_cell().bins : 0.5 * model.speckle_cell().beams);
}

// Configuration with a trust region for geometric parameters, in which the model is nearly linear.
FitConfig Near(const FitConfig& config, const AcousticFrameModel& model, const std::vector<int>& geometric,
               const ParameterValues& point, double scale) {
  FitConfig near = config;
  for (const int index : geometric) {
    const CatalogEntry& entry = model.catalog()[index];
    const double reach = scale * Reach(entry, point[index], model);
    near.trust_regions[entry.name] = {point[index] - reach, point[index] + reach};
  }
  return near;
}

FitConfig WithDefaults(FitConfig config, const ParameterSet& initial, const Scene& scene) {
  if (!config.free) config.free = AcousticFreeByDefault(initial, scene.material_names);
  return WithOutlineNamed(std::move(config), scene);
}

// True if a configuration may free placements.
bool MayMove(const FitConfig& config) {
  constexpr std::array<std::string_view, 6> kPlacements = {"pose",   "mount",   "geometry",
                                                           "object", "outline", "*"};
  return std::ranges::any_of(*config.free, [&](const std::string& name) {
    return std::ranges::any_of(kPlacements, [&](std::string_view of) { return name.starts_with(of); });
  });
}

// Runs the steps of a fit one after the other.
class AcousticFitter {
 public:
  AcousticFitter(const sim::Simulator& simulator, const std::vector<AcousticFrame>& frames,
                 const ParameterSet& initial, const FitConfig& given, const FitOptions& options)
      : options_(options),
        simulator_(simulator),
        config_(WithDefaults(given, initial, simulator.caster().scene())),
        few_rays_(simulator.shared_caster(), simulator.sonar(), WithFewerRays(simulator)),
        model_(std::make_unique<AcousticFrameModel>(
            MayMove(config_) && HasFewerRays() ? few_rays_ : simulator, frames,
            WithMirrorStart(initial, config_, simulator.caster().material_names(), simulator.sonar()),
            ObjectsNamed(config_), OutlinesNamed(config_))),
        catalog_(model_->catalog()) {
    free_ = ApplyFitConfigWithPriors(model_->initial_values(), config_, catalog_);
    for (std::size_t i = 0; i < catalog_.size(); ++i) {
      if (!free_[i]) continue;
      (IsGeometric(catalog_[i]) ? geometric_ : radiometric_).push_back(static_cast<int>(i));
    }
    poses_ = FreePlacements(catalog_, free_);
    std::ranges::copy_if(poses_, std::back_inserter(rigid_),
                         [&](int entry) { return catalog_[entry].group != ParameterGroup::kOutline; });
    near_ = config_;
    again_ = options;
    again_.starts = 1;
    again_.search_level = false;
    again_.rough = true;
    fit_ = {.values = StartValues(config_, catalog_, model_->initial_values()), .report = {}, .usable = true};
    for (std::size_t i = 0; i < catalog_.size(); ++i) {
      if (free_[i]) fit_.values[i] = std::clamp(fit_.values[i], catalog_[i].lower, catalog_[i].upper);
    }
    if (fit_.values != model_->initial_values()) model_->Linearise(fit_.values, {});
    if (poses_.empty()) TakeAllRays();
  }

  AcousticFit Run() {
    const auto began = std::chrono::steady_clock::now();
    ShareRepeats();
    cost_initial_ = CostAt(*model_, fit_.values, model_->frame_count()) +
                    CostOfPriors(catalog_, FreeEntries(), fit_.values);
    FitRadiometryFirst();
    ScanWidths();
    RefinePosesWithRadiometry();
    FitGeometry();
    GoToBetterPoses();
    EndWithAllRays();
    again_.test_others = options_.test_others && !options_.down_weight;
    if (!geometric_.empty()) Refit(false);
    WeighDown();
    LookForOtherPoses();
    AcousticFit result = Result();
    result.report.solve_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    return result;
  }

 private:
  void Say(const std::string& line) const {
    if (options_.progress) options_.progress(line);
  }

  // Continues from the present values, about the point of the last linearisation. Standard errors, which a
  // rough fit has not, include those of the rays.
  void Refit(bool rough) {
    if (!fit_.usable) return;
    FitOptions options = again_;
    options.rough = rough;
    if (rough || !options.standard_errors) {
      fit_ = Fit(*model_, fit_.values, near_, options);
    } else {
      const OtherRays others(*this, fit_.values, geometric_);
      fit_ = Fit(*model_, fit_.values, near_, options, &others.model());
    }
    iterations_ += fit_.report.iterations;
  }

  // Model of the same frames with another grid of rays, linearised about `values`.
  class OtherRays {
   public:
    OtherRays(const AcousticFitter& fitter, const ParameterValues& values, const std::vector<int>& geometric)
        : simulator_(fitter.simulator_.shared_caster(), fitter.simulator_.sonar(),
                     Options(fitter.model_->simulator().options())),
          model_(AcousticFrameModel::OneFrameAtATime(*fitter.model_, simulator_, values, geometric)) {}
    ~OtherRays() = default;
    OtherRays(const OtherRays&) = delete;
    OtherRays& operator=(const OtherRays&) = delete;

    const AcousticFrameModel& model() const { return model_; }

   private:
    static sim::SimulationOptions Options(sim::SimulationOptions options) {
      options.fan = OtherGrid(options.fan);
      return options;
    }

    sim::Simulator simulator_;
    AcousticFrameModel model_;
  };

  static sim::RayFanOptions OtherGrid(sim::RayFanOptions fan) {
    constexpr int kOtherRows = 31;  // one row more for so many rows
    fan.rows += 1 + fan.rows / kOtherRows;
    return fan;
  }

  // Rays of the search for poses.
  static sim::SimulationOptions WithFewerRays(const sim::Simulator& simulator) {
    constexpr int kDecimation = 2;
    sim::SimulationOptions options = simulator.options();
    options.fan = Decimated(simulator.sonar(), options.fan, kDecimation);
    return options;
  }

  bool HasFewerRays() const {
    const sim::RayFanOptions& few = few_rays_.options().fan;
    const sim::RayFanOptions& all = simulator_.options().fan;
    return few.rows < all.rows || few.cols < all.cols;
  }

  // In the order of the catalog.
  std::vector<int> FreeEntries() const {
    std::vector<int> entries = geometric_;
    entries.insert(entries.end(), radiometric_.begin(), radiometric_.end());
    std::ranges::sort(entries);
    return entries;
  }

  void TakeAllRays() {
    if (&model_->simulator() == &simulator_) return;
    model_->DropEchoes();
    model_ = std::make_unique<AcousticFrameModel>(*model_, simulator_, fit_.values, std::vector<int>());
  }

  // Prepares the last solve: all rays, about the point that the search found. Fits the curves to blocks of
  // pixels first, because a step costs less there.
  void EndWithAllRays() {
    if (poses_.empty() || !fit_.usable) return;
    TakeAllRays();
    model_->Linearise(fit_.values, geometric_);
    near_ = Near(config_, *model_, geometric_, fit_.values, 1.0);
    if (radiometric_.empty()) return;
    FitOptions fine = again_;
    fine.rough = false;
    fine.test_others = false;
    fit_ = FitOnBlocks(fine);
    iterations_ += fit_.report.iterations;
  }

  // Configuration that fixes all geometric parameters.
  FitConfig RadiometryOnly() const {
    FitConfig config = config_;
    for (const int entry : geometric_) config.fixed.push_back(catalog_[entry].name);
    return config;
  }

  // The correlation of frames from one pose depends on the echoes. A first rough fit gives them; its values
  // are discarded.
  void ShareRepeats() {
    if (!model_->has_repeats()) return;
    if (!options_.repeat_shares.empty()) {
      model_->TakeRepeatShares(options_.repeat_shares);
      return;
    }
    ParameterValues values = fit_.values;
    if (!radiometric_.empty()) {
      FitOptions look = options_;
      look.starts = 1;
      look.rough = true;
      const ModelFit first = Fit(*model_, values, RadiometryOnly(), look);
      if (first.usable) values = first.values;
    }
    Say("frames of one pose share their speckle and get less weight");
    model_->ShareRepeats(values);
  }

  // Fits curves and receiver first, because a wrong level would lead the geometry astray.
  void FitRadiometryFirst() {
    if (radiometric_.empty() && !geometric_.empty()) return;
    if (options_.near_start && poses_.empty() && !geometric_.empty()) return;  // rounds begin with it
    FitOptions start = options_;
    start.rough = !geometric_.empty();
    start.test_others = options_.test_others && !options_.down_weight;
    if (poses_.empty()) {
      fit_ = Fit(*model_, fit_.values, RadiometryOnly(), start);
    } else {
      fit_ = FitOnBlocks(start);
    }
    iterations_ += fit_.report.iterations;
    start_costs_ = fit_.report.start_costs;
  }

  // Moves widths of beam and pulse in large steps, each followed by a fit of the radiometry to blocks of
  // pixels. Rounds reach only a fifth farther each, and cost more.
  void ScanWidths() {
    if (!poses_.empty() || radiometric_.empty() || options_.near_start || !fit_.usable) return;
    for (const int entry : geometric_) {
      if (ScanWidth(entry, kScanFactor) == 0) ScanWidth(entry, 1.0 / kScanFactor);
    }
  }

  // Returns the number of steps that lowered the cost.
  int ScanWidth(int entry, double factor) {
    ModelFit best = FitOnBlocksWith(entry, fit_.values[entry]);
    for (int step = 0; step < kScanSteps; ++step) {
      const double value =
          std::clamp(factor * best.values[entry], catalog_[entry].lower, catalog_[entry].upper);
      if (value == best.values[entry] || !best.usable) return step;
      Say(fmt::format("trying {} = {:.3g}", catalog_[entry].name, value));
      ModelFit next = FitOnBlocksWith(entry, value);
      if (!next.usable || next.report.cost_final > best.report.cost_final - NoiseOfCost()) return step;
      best = std::move(next);
      fit_.values = best.values;
    }
    return kScanSteps;
  }

  ModelFit FitOnBlocksWith(int entry, double value) const {
    ParameterValues values = fit_.values;
    values[entry] = value;
    FitOptions rough = again_;
    rough.progress = {};
    if (const auto coarse = model_->CoarseAbout(values, kScanPixels))
      return Fit(*coarse, values, RadiometryOnly(), rough);
    return Fit(AcousticFrameModel(*model_, model_->simulator(), values, {}), values, RadiometryOnly(), rough);
  }

  // Fits curves and receiver to blocks of pixels, which suffice while poses are not right.
  ModelFit FitOnBlocks(const FitOptions& options) const {
    constexpr std::size_t kPixelsPerBlock = 8;
    const auto coarse = model_->CoarseAbout(
        fit_.values,
        model_->pixel_count() * static_cast<std::size_t>(model_->frame_count()) / kPixelsPerBlock);
    return Fit(coarse != nullptr ? *coarse : *model_, fit_.values, RadiometryOnly(), options);
  }

  // Refines poses in stages of decreasing reach, each followed by the radiometry, because curves fitted at
  // wrong poses are blurred.
  // The sonar's geometry is left to the joint steps: on smoothed images, wrong levels would move it far away.
  // So are outlines, which smoothed images hardly show.
  void RefinePosesWithRadiometry() {
    const bool geometry =
        std::ranges::any_of(poses_, [&](int entry) { return ChangesAxes(catalog_[entry]); });
    if (rigid_.empty() || geometry || options_.near_start) return;
    for (const PoseStage& stage : PoseStages(model_->speckle_cell())) RefineStage(stage, rigid_);
  }

  void RefineStage(const PoseStage& stage, const std::vector<int>& entries) {
    if (!fit_.usable) return;
    RefinePoses(*model_, catalog_, entries, stage, fit_.values, options_.progress);
    model_->Linearise(fit_.values, {});
    RefitRadiometry();
  }

  void RefitRadiometry() {
    if (radiometric_.empty()) return;
    fit_ = FitOnBlocks(again_);
    iterations_ += fit_.report.iterations;
  }

  void FitGeometry() {
    if (poses_.empty()) {
      FitInRounds();
    } else {
      FitJointly(options_.joint_steps);
    }
  }

  // Fits poses together with the parameters that are correlated with them. Each step is traced.
  void FitJointly(int steps) {
    if (!fit_.usable) return;
    const std::vector<int> active = FreeEntries();
    const sim::RayFanOptions& fan = model_->simulator().options().fan;
    ParameterValues values = fit_.values;
    settled_ = TakeJointSteps(*model_, catalog_, active,
                              {.steps = steps,
                               .least = kLeastGain * NoiseOfCost(),
                               .cost = [&](const ParameterValues& at) { return model_->TracedCost(at, fan); },
                               .roughness = [&](const ParameterValues& at) { return RoughnessOfCost(at); },
                               .settle =
                                   [&](ParameterValues& at) {
                                     if (radiometric_.empty()) return;
                                     fit_.values = at;
                                     const ModelFit settled = FitOnBlocks(again_);
                                     if (settled.usable) at = settled.values;
                                   }},
                              values, options_.progress);
    fit_.values = values;
    near_ = Near(config_, *model_, geometric_, values, kHeld);
  }

  // Fall of cost from the effect of noise on one parameter: half a nat per speckle cell.
  double NoiseOfCost() const { return 0.5 * model_->speckle_cell().pixels(); }

  // Two standard deviations of the cost from one pose to the next, because rays appear and disappear at
  // edges. They do so as well from one grid of rays to another, which is what is measured, per frame.
  double RoughnessOfCost(const ParameterValues& values) const {
    const sim::RayFanOptions& fan = model_->simulator().options().fan;
    const std::vector<double> costs = model_->TracedCosts(values, fan);
    const std::vector<double> others = model_->TracedCosts(values, OtherGrid(fan));
    double square = 0.0;
    for (std::size_t frame = 0; frame < costs.size(); ++frame)
      square += std::max(0.5 * std::pow(others[frame] - costs[frame], 2), std::pow(NoiseOfCost(), 2));
    return 2.0 * std::sqrt(square);
  }

  // Solves for all parameters about a sequence of points. If a point proves worse after tracing, the fit goes
  // back and reduces the reach. A change of cost below the noise ends the rounds.
  void FitInRounds() {
    settled_ = geometric_.empty();
    const double noise = NoiseOfCost();
    double scale = 1.0;
    ParameterValues best;
    double best_cost = std::numeric_limits<double>::infinity();
    for (int round = 0; round < kJointRounds && fit_.usable && !settled_; ++round) {
      model_->Linearise(fit_.values, geometric_);
      const double cost = CostAt(*model_, fit_.values, model_->frame_count());
      Say(fmt::format("round {}: cost {:.1f}", round + 1, cost));
      if (cost > best_cost + noise) {
        scale *= kShrink;
        fit_.values = best;
        model_->Linearise(best, geometric_);
      } else {
        settled_ = std::abs(cost - best_cost) < noise;
        best = fit_.values;
        best_cost = cost;
      }
      near_ = Near(config_, *model_, geometric_, best, scale);
      if (!settled_) Refit(true);
      double largest = 0.0;
      for (const int entry : geometric_) {
        largest = std::max(largest, std::abs(fit_.values[entry] - best[entry]) /
                                        Reach(catalog_[entry], best[entry], *model_));
      }
      settled_ = settled_ || largest < kJointSettled;
    }
  }

  void WeighDown() {
    if (!options_.down_weight) return;
    for (int round = 0; round < kWeightRounds && fit_.usable; ++round) {
      Say("reducing the weight of pixels that do not match the scene");
      model_->DownWeight(fit_.values);
      if (!poses_.empty()) {
        FitJointly(options_.joint_steps);
        model_->Linearise(fit_.values, geometric_);
      }
      again_.test_others = options_.test_others && round + 1 == kWeightRounds;
      Refit(false);
    }
  }

  // Moves to better poses that rounds cannot reach, because rounds only follow one valley, and refits there.
  // Only frames that moved are searched again.
  void GoToBetterPoses() {
    std::vector<int> searched = poses_;  // entries
    std::vector<OtherPose> others;
    for (int move = 0; move < kPoseMovesToBetter && !options_.near_start && !poses_.empty() && fit_.usable;
         ++move) {
      Say("searching for poses that fit the frames better");
      std::vector<OtherPose> found = OtherPoses(*model_, catalog_, searched, fit_.values);
      std::ranges::move(found, std::back_inserter(others));
      const std::set<int> moved = TakeBetterPoses(others, kBetterNats, fit_.values);
      if (moved.empty()) {
        other_poses_ = std::move(others);
        return;
      }
      Say(fmt::format("{} frame{} moved to a better pose", moved.size(), moved.size() == 1 ? "" : "s"));
      const auto stays = [&](int frame) { return !moved.contains(frame); };
      std::erase_if(others, [&](const OtherPose& other) { return !stays(other.frame); });
      std::erase_if(searched, [&](int entry) { return stays(catalog_[entry].frame); });
      model_->Linearise(fit_.values, {});
      RefineStage(PoseStages(model_->speckle_cell()).back(), searched);
      FitJointly(std::min(kStepsAfterMove, options_.joint_steps));
    }
  }

  void LookForOtherPoses() {
    if (poses_.empty() || !fit_.usable || !options_.test_others) return;
    if (!other_poses_ || options_.down_weight) {
      Say("searching for other poses that fit the frames equally well");
      other_poses_ = OtherPoses(*model_, catalog_, poses_, fit_.values);
    }
    for (OtherPose& other : *other_poses_) fit_.report.other_poses.push_back(std::move(other.sentence));
  }

  AcousticFit Result() {
    TakeAllRays();  // the result outlives the simulator with fewer rays
    AcousticFit result{.parameters = model_->Parameters(fit_.values),
                       .world_from_sonar = {},
                       .moved_poses = MovedPoses(),
                       .mount = model_->MountOf(fit_.values),
                       .geometry = GeometryOf(catalog_, fit_.values),
                       .simulator = model_->SimulatorAt(fit_.values),
                       .weights = {},
                       .repeat_shares = {},
                       .report = std::move(fit_.report),
                       .usable = fit_.usable};
    if (model_->has_repeats()) result.repeat_shares = model_->repeat_shares();
    for (int frame = 0; frame < model_->frame_count(); ++frame) {
      result.world_from_sonar.push_back(model_->PoseOf(frame, fit_.values));
      if (options_.down_weight) result.weights.push_back(model_->weights(frame));
    }
    FitReport& report = result.report;
    if (options_.down_weight) report.down_weighted_share = DownWeightedShare();
    for (std::size_t i = 0; i < report.parameters.size(); ++i) {
      report.parameters[i].initial = model_->initial_values()[i];
      report.parameters[i].lower = catalog_[i].lower;
      report.parameters[i].upper = catalog_[i].upper;
    }
    const auto is_free = [&](const char* name) {
      const FittedParameter* parameter = report.Find(name);
      return parameter != nullptr && parameter->status != ParameterStatus::kFixed;
    };
    report.curves_level =
        CurvesLevel{.level_db = result.parameters.source_level_db + result.parameters.receiver.gain_db,
                    .sigma_db = is_free("source_level_db") || is_free("receiver.gain_db")
                                    ? std::nullopt
                                    : result.parameters.source_level_sigma_db};
    // Placements that are not free are data, not parameters.
    std::erase_if(report.parameters, [](const FittedParameter& parameter) {
      const bool placement = parameter.name.starts_with("pose.") || parameter.name.starts_with("geometry.") ||
                             parameter.name.starts_with("object.") || parameter.name.starts_with("outline.");
      return placement && parameter.status == ParameterStatus::kFixed;
    });
    for (const std::string& name : OutlinesNamed(config_)) {
      report.warnings.push_back(
          fmt::format("the outline of '{}' is fitted: only another pose of it, which the fit did not use, "
                      "can evaluate it",
                      name));
    }
    report.ambiguities = GeometryAmbiguities(report, model_->distinct_poses());
    if (!start_costs_.empty()) report.start_costs = start_costs_;
    report.cost_initial = cost_initial_;
    report.iterations = iterations_;
    if (result.usable && !settled_) {
      report.warnings.emplace_back(
          "beam, pulse or poses still moved when the fit ended: their values may still change, and the "
          "standard errors do not hold");
    }
    return result;
  }

  bool MovedPoses() const {
    return std::ranges::any_of(poses_, [&](int entry) {
      return catalog_[entry].group == ParameterGroup::kPose || catalog_[entry].name == "geometry.tilt_deg";
    });
  }

  // Share of the used pixels that have a weight below 0.5.
  double DownWeightedShare() const {
    std::size_t low = 0;
    std::size_t counted = 0;
    for (int frame = 0; frame < model_->frame_count(); ++frame) {
      for (std::size_t pixel = 0; pixel < model_->pixel_count(); ++pixel) {
        if (!model_->Counts(frame, pixel)) continue;
        ++counted;
        if (model_->weights(frame)[pixel] < 0.5F) ++low;
      }
    }
    return static_cast<double>(low) / static_cast<double>(std::max<std::size_t>(1, counted));
  }

  const FitOptions& options_;
  const sim::Simulator& simulator_;  // as declared
  FitConfig config_;                 // with priors
  FitConfig near_;                   // as above, with the trust region about the present point
  sim::Simulator few_rays_;
  std::unique_ptr<AcousticFrameModel> model_;
  std::vector<CatalogEntry> catalog_;
  std::vector<bool> free_;
  std::vector<int> radiometric_;  // free entries
  std::vector<int> geometric_;
  std::vector<int> poses_;  // placements of `geometric_`
  std::vector<int> rigid_;  // those that keep the shape of objects
  FitOptions again_;
  ModelFit fit_;
  std::optional<std::vector<OtherPose>> other_poses_;  // of the present poses, if they were searched
  std::vector<double> start_costs_;
  double cost_initial_ = 0.0;
  int iterations_ = 0;
  bool settled_ = true;
};

}  // namespace

std::vector<std::string> AcousticFreeByDefault(const ParameterSet& initial,
                                               const std::vector<std::string>& material_names) {
  std::vector<std::string> free = MirrorsFreeByDefault(initial, material_names);
  free.emplace_back("materials");
  free.emplace_back("receiver.noise_db");
  if (!(initial.pulse.length_m > 0.0)) free.emplace_back("pulse.length_m");
  return free;
}

ParameterSet WithNoiseStart(ParameterSet parameters, const std::vector<AcousticFrame>& frames) {
  if (parameters.receiver.noise_db) return parameters;
  constexpr double kDarkest = 0.2;
  std::vector<double> powers;
  for (const AcousticFrame& frame : frames) {
    for (std::size_t pixel = 0; pixel < frame.recorded.size(); ++pixel) {
      if (frame.use.empty() || frame.use[pixel] != 0) powers.push_back(frame.recorded[pixel].power);
    }
  }
  // A soft display shows some pixels without any power. Their power is unknown, but lower than all others.
  const auto dark = static_cast<std::size_t>(std::ranges::count(powers, 0.0));
  if (dark == powers.size()) {
    throw DataError(
        "fit: {} used pixels without power above the bottom of the display, expected one with power", dark);
  }
  const auto count = static_cast<double>(powers.size());
  const double share = std::max(kDarkest, static_cast<double>(dark) / count);
  const std::size_t rank = std::max(static_cast<std::size_t>(kDarkest * count), dark);
  // If all of them were noise, the darkest fifth of exponential power would end at -ln(0.8) of its mean. With
  // more looks it would end closer to the mean.
  const double of_mean = parameters.receiver.looks > 2.0 ? 1.0 : -std::log1p(-share);
  parameters.receiver.noise_db = DbFromPower(RankedValue(std::move(powers), rank) / of_mean);
  return parameters;
}

AcousticFit FitAcousticModel(const sim::Simulator& simulator, const std::vector<AcousticFrame>& frames,
                             const ParameterSet& initial, const FitConfig& config,
                             const FitOptions& options) {
  if (frames.empty()) throw DataError("fit: no frames");
  return AcousticFitter(simulator, frames, initial, config, options).Run();
}

std::vector<Pose> FitPosesOnly(const sim::Simulator& simulator, const std::vector<AcousticFrame>& frames,
                               const ParameterSet& parameters, const PosePrior& prior,
                               const std::function<void(const std::string&)>& progress) {
  if (frames.empty()) return {};
  const AcousticFrameModel model(simulator, frames, parameters);
  FitConfig config{.free = std::vector<std::string>{"pose"}, .pose_prior = prior};
  std::vector<CatalogEntry> catalog = model.catalog();
  const std::vector<bool> free = ApplyFitConfigWithPriors(model.initial_values(), config, catalog);
  ParameterValues values = model.initial_values();
  for (const PoseStage& stage : PoseStages(model.speckle_cell())) {
    RefinePoses(model, catalog, FreePlacements(catalog, free), stage, values, progress);
  }
  std::vector<Pose> poses;
  for (int frame = 0; frame < model.frame_count(); ++frame) poses.push_back(model.PoseOf(frame, values));
  return poses;
}

}  // namespace sonarcal::calib
