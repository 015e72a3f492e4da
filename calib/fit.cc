#include "calib/fit.h"

#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>

#include "calib/curve_alternatives.h"
#include "calib/fit_starts.h"
#include "calib/identifiability.h"
#include "calib/problem_builder.h"
#include "calib/solve.h"
#include "core/types/error.h"

namespace sonarcal::calib {
namespace {

// Relative change of cost that ends a trial start.
constexpr double kRoughTolerance = 1e-5;
constexpr int kRoughIterations = 20;
constexpr std::size_t kStartPixels = 100'000;  // of all frames together: enough to distinguish valleys
constexpr double kNegligibleNats = 1e-2;       // of log-likelihood, per speckle cell
constexpr double kNegligibleInSearch = 1e-1;   // the same without standard errors

// Steps by all pixels between moves by blocks of pixels, and the max number of moves.
constexpr int kStepsBetweenMoves = 4;
constexpr int kMovesByBlocks = 5;

// Max number of moves to a better curve.
constexpr int kMovesToBetter = 2;

// State of a fit while it runs: the free parameters, and the reason why others are not free.
class Fitter {
 public:
  Fitter(const FrameModel& model, ParameterValues initial, const FitConfig& config, const FitOptions& options,
         const FrameModel* by_other_rays)
      : model_(model),
        by_other_rays_(by_other_rays),
        options_(options),
        catalog_(model.catalog()),
        initial_(std::move(initial)) {
    const std::vector<bool> free = ApplyFitConfig(config, catalog_);
    state_.values = initial_;
    for (std::size_t i = 0; i < catalog_.size(); ++i) {
      status_.push_back(free[i] ? ParameterStatus::kFree : ParameterStatus::kFixed);
    }
    MoveInsideBounds(catalog_, free, state_.values);
    if (std::none_of(free.begin(), free.end(), [](bool value) { return value; })) {
      throw DataError("fit: no parameter is free");
    }
    if (model_.IsLikelihood()) SetPriors();
  }

  ModelFit Run() {
    FreezeUnseen();
    if (!options_.rough) report_.cost_initial = CostOfStart();
    const auto start = std::chrono::steady_clock::now();
    // A single start at the result of an earlier fit needs no trial.
    if (options_.rough || options_.starts > 1 || options_.search_level) SolveFromSeveralStarts();
    bool usable = !report_.start_costs.empty();
    report_.solve_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (options_.rough) return {.values = state_.values, .report = std::move(report_), .usable = usable};
    // Each round except the last freezes at least one parameter, so the number of parameters limits the
    // rounds.
    for (std::size_t round = 0; round <= catalog_.size(); ++round) {
      Activate();
      if (state_.active.empty()) {
        usable = false;
        report_.termination = "the frames determine none of the free parameters";
        break;
      }
      usable = SolveInOrder();
      if (!usable) break;
      if (model_.IsLikelihood()) {
        if (options_.standard_errors) FlagWhatPriorsDecide();
        break;
      }
      if (!FreezeUndetermined()) break;
    }
    report_.solve_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    Finish(usable);
    return {.values = state_.values, .report = std::move(report_), .usable = usable};
  }

 private:
  void Say(const std::string& line) const {
    if (options_.progress) options_.progress(line);
  }

  // Default prior: the start value, with a surprisingly large step as standard deviation.
  void SetPriors() {
    for (std::size_t i = 0; i < catalog_.size(); ++i) {
      CatalogEntry& entry = catalog_[i];
      if (status_[i] != ParameterStatus::kFree || entry.prior) continue;
      entry.prior =
          Prior{.coordinate = entry.CoordinateFromValue(state_.values[i]), .sigma = entry.typical_step};
    }
  }

  void Freeze(std::size_t index, const std::string& why) {
    status_[index] = ParameterStatus::kUnidentifiable;
    state_.values[index] = initial_[index];
    report_.unidentifiable_directions.push_back(why);
  }

  void FreezeUnseen() {
    std::vector<bool> said(model_.material_names().size(), false);
    for (std::size_t i = 0; i < catalog_.size(); ++i) {
      const int material = catalog_[i].material;
      if (material < 0 || status_[i] != ParameterStatus::kFree || model_.ShowsMaterial(material)) continue;
      status_[i] = ParameterStatus::kUnidentifiable;
      if (!said[material]) {
        report_.unidentifiable_directions.push_back(
            fmt::format("material.{}: no echo of it in the frames used", model_.material_names()[material]));
        said[material] = true;
      }
    }
    for (std::size_t i = 0; i < catalog_.size(); ++i) {
      const int mirror = catalog_[i].mirror;
      if (mirror < 0 || status_[i] != ParameterStatus::kFree || model_.ShowsMirror(mirror)) continue;
      status_[i] = ParameterStatus::kUnidentifiable;
      report_.unidentifiable_directions.push_back(
          fmt::format("{}: no ghost by way of it in the frames used", catalog_[i].name));
    }
  }

  bool IsFree(const std::string& name) const {
    const int index = FindEntry(catalog_, name);
    return index >= 0 && status_[index] == ParameterStatus::kFree;
  }

  bool IsFixed(const std::string& name) const {
    const int index = FindEntry(catalog_, name);
    return index < 0 || status_[index] == ParameterStatus::kFixed;
  }

  std::vector<bool> Free() const {
    std::vector<bool> free;
    for (const ParameterStatus status : status_) free.push_back(status == ParameterStatus::kFree);
    return free;
  }

  void Activate() {
    state_.active.clear();
    for (std::size_t i = 0; i < catalog_.size(); ++i) {
      if (status_[i] == ParameterStatus::kFree) state_.active.push_back(static_cast<int>(i));
    }
  }

  // Cost at the values that the fit starts from, with priors as in `cost_final`.
  double CostOfStart() {
    Activate();
    return CostAt(model_, state_.values, model_.frame_count()) +
           CostOfPriors(catalog_, state_.active, state_.values);
  }

  // Solves roughly from the given curves and from others, and continues from the best.
  void SolveFromSeveralStarts() {
    const ParameterValues given = state_.values;
    ParameterValues best = given;
    double best_cost = std::numeric_limits<double>::infinity();
    Activate();
    if (state_.active.empty()) return;
    // A rough fit with one start continues from the last values. Blocks of pixels would lead away from them.
    const bool continues = options_.rough && options_.starts == 1;
    const std::unique_ptr<FrameModel> coarse = continues ? nullptr : model_.Coarse(kStartPixels);
    const FrameModel& model = coarse != nullptr ? *coarse : model_;
    const SolveLimits rough{.function_tolerance = kRoughTolerance,
                            .max_iterations = std::min(kRoughIterations, options_.max_iterations)};
    for (int start = 0; start < options_.starts; ++start) {
      if (options_.starts > 1) Say(fmt::format("start {} of {}", start + 1, options_.starts));
      // Other shapes have the level that the first fit found.
      state_.values = start == 0 ? given : WithCurveShape(catalog_, Free(), given, best, start);
      if (options_.search_level) state_.values = SearchLevel(model, catalog_, Free(), state_.values);
      if (!Solve(model, rough)) continue;
      report_.start_costs.push_back(report_.cost_final);
      if (report_.cost_final < best_cost) {
        best_cost = report_.cost_final;
        best = state_.values;
      }
    }
    state_.values = best;
  }

  double PixelsPerCell() const { return model_.speckle_cell().pixels(); }

  double NegligibleNats() const { return options_.standard_errors ? kNegligibleNats : kNegligibleInSearch; }

  // Limits of a solve to the end.
  SolveLimits Limits() const {
    return {.function_tolerance = options_.function_tolerance,
            .least_fall = model_.IsLikelihood() ? NegligibleNats() * PixelsPerCell() : 0.0,
            .max_iterations = options_.max_iterations};
  }

  // Solves by the pixels. After a few steps, curves and receiver move by blocks of pixels in between.
  bool SolveToEnd() {
    const int before = report_.iterations;
    SolveLimits limits = Limits();
    const auto solve = [&](int max_iterations) {
      const int left = std::max(1, options_.max_iterations - (report_.iterations - before));
      limits.max_iterations = std::min(max_iterations, left);
      return Solve(model_, limits);
    };
    std::unique_ptr<FrameModel> coarse;
    for (int move = 0; model_.IsLikelihood() && move < kMovesByBlocks; ++move) {
      const int start = report_.iterations;
      if (!solve(kStepsBetweenMoves)) return false;
      if (report_.iterations - start < limits.max_iterations) return true;
      if (report_.iterations - before >= options_.max_iterations) return true;
      if (coarse == nullptr) coarse = model_.CoarseAbout(state_.values, kStartPixels);
      if (coarse == nullptr) break;
      FitState radiometry{.active = {}, .values = state_.values};
      std::ranges::copy_if(state_.active, std::back_inserter(radiometry.active),
                           [&](int entry) { return !IsGeometric(catalog_[entry]); });
      if (radiometry.active.empty()) break;
      const double fall = MoveByCheaperModel(model_, *coarse, catalog_, Limits(), options_.stop, radiometry);
      state_.values = radiometry.values;
      if (fall < PixelsPerCell()) break;
    }
    return solve(options_.max_iterations);
  }

  // Solves, and puts the Gaussians in order. With priors the two orders differ in cost: the exchanged values
  // are a start, not a result.
  bool SolveInOrder() {
    if (!SolveToEnd()) return false;
    const bool exchanged = OrderGaussians(catalog_, Free(), state_.values);
    return !exchanged || !model_.IsLikelihood() || SolveToEnd();
  }

  bool Solve(const FrameModel& model, const SolveLimits& limits) {
    Say(fmt::format("solving for {} parameters on {} frame{}", state_.active.size(), model_.frame_count(),
                    model_.frame_count() == 1 ? "" : "s"));
    SolveSummary summary = SolveFit(model, catalog_, limits, options_.stop, state_);
    report_.iterations += summary.iterations;
    converged_ = summary.converged;
    report_.termination = std::move(summary.termination);
    if (summary.usable) report_.cost_final = summary.cost;
    return summary.usable;
  }

  bool AtBound(std::size_t index) const {
    const CatalogEntry& entry = catalog_[index];
    const double coordinate = entry.CoordinateFromValue(state_.values[index]);
    const double lower = entry.CoordinateFromValue(entry.lower);
    const double upper = entry.CoordinateFromValue(entry.upper);
    const double tolerance = 1e-6 * (upper - lower);
    return coordinate <= lower + tolerance || coordinate >= upper - tolerance;
  }

  // Sums over the parameters that are free and not at a bound; sets `interior_` to them.
  NormalEquations AccumulateInterior() {
    interior_.clear();
    for (std::size_t i = 0; i < catalog_.size(); ++i) {
      if (status_[i] == ParameterStatus::kFree && !AtBound(i)) interior_.push_back(static_cast<int>(i));
    }
    if (interior_.empty()) return {};
    const FitState interior{.active = interior_, .values = state_.values};
    ResidualSummary residuals;
    NormalEquations equations = Accumulate(model_, catalog_, interior, options_, &residuals);
    if (by_other_rays_ != nullptr)
      equations.numerical = ScoreErrors(model_, *by_other_rays_, catalog_, interior);
    if (model_.IsLikelihood()) {
      report_.whitened = residuals;
    } else {
      report_.raw = residuals;
      if (residuals.spread > 0.0)
        report_.whitened = {.mean = residuals.mean / residuals.spread, .spread = 1.0};
    }
    return equations;
  }

  // Moves to the best optimum that exchanged curves find, computes its covariance, and returns the tests
  // there.
  CurveAlternatives TestCurves() {
    for (int move = 0;; ++move) {
      const NormalEquations equations = AccumulateInterior();
      covariance_ = JackknifeCovariance(equations);
      student_ = StudentFactors(equations);
      if (!options_.test_others || interior_.empty()) return {};
      Say("searching for other curves that fit equally well");
      CurveAlternatives curves = FindCurveAlternatives(
          model_, catalog_,
          {.values = state_.values, .free = state_.active, .interior = interior_, .covariance = covariance_},
          options_.stop);
      if (move == kMovesToBetter || !TakeBetter(curves.better)) return curves;
    }
  }

  // Solves all parameters from each start and moves to the first optimum of lower cost.
  bool TakeBetter(const std::vector<ParameterValues>& starts) {
    const ParameterValues values = state_.values;
    const double cost = report_.cost_final;
    const std::string termination = report_.termination;
    const bool converged = converged_;
    for (const ParameterValues& start : starts) {
      state_.values = start;
      if (SolveInOrder() && report_.cost_final < cost - kBetterCurveNats * PixelsPerCell()) return true;
    }
    state_.values = values;
    report_.cost_final = cost;
    report_.termination = termination;
    converged_ = converged;
    return false;
  }

  // Flags parameters whose value comes mostly from the prior, and those not determined separately. With
  // priors nothing is singular, so no parameter has to be fixed.
  void FlagWhatPriorsDecide() {
    const CurveAlternatives curves = TestCurves();
    if (interior_.empty()) return;
    widening_ = curves.widening;
    std::vector<NamedCoordinate> coordinates;
    for (std::size_t i = 0; i < interior_.size(); ++i) {
      const CatalogEntry& entry = catalog_[interior_[i]];
      const double step = std::min(entry.prior->sigma, entry.typical_step);
      coordinates.push_back({entry.name, step, entry.logarithmic});
      // Sigma is not finite if hardly more than one block determines a parameter. It is then not
      // identifiable.
      if (!(StandardError(i) <= std::sqrt(kOpenShare) * step) || !std::isfinite(Sigma(i)))
        status_[interior_[i]] = ParameterStatus::kUnidentifiable;
    }
    for (const int entry : curves.not_separate) status_[entry] = ParameterStatus::kUnidentifiable;
    report_.unidentifiable_directions.insert(report_.unidentifiable_directions.end(),
                                             curves.sentences.begin(), curves.sentences.end());
    if (!covariance_.allFinite()) return;
    for (std::string& words : OpenDirections(covariance_, coordinates))
      report_.unidentifiable_directions.push_back(std::move(words));
  }

  // Standard error of the coordinate of an entry of `interior_`. Uncertain itself if few blocks determine it.
  double StandardError(std::size_t i) const {
    const auto k = static_cast<Eigen::Index>(i);
    return std::sqrt(covariance_(k, k)) * (widening_.empty() ? 1.0 : widening_[interior_[i]]);
  }

  // Reported standard error: +-1.96 of it is a 95 % interval, however few blocks determine StandardError.
  double Sigma(std::size_t i) const {
    return StandardError(i) * (student_.size() > 0 ? student_(static_cast<Eigen::Index>(i)) : 1.0);
  }

  // Freezes parameters that the data do not determine, one after the other, until the rest is determined.
  // Returns false if all were determined. The sums hold at one point only, so the caller must solve again.
  bool FreezeUndetermined() {
    NormalEquations equations = AccumulateInterior();
    std::vector<int> rest = interior_;
    while (!rest.empty()) {
      const auto open = Undetermined(equations, rest);
      if (!open) break;
      Freeze(rest[open->parameter],
             fmt::format("{} (held: {})", open->description, catalog_[rest[open->parameter]].name));
      equations = HoldParameter(equations, open->parameter);
      rest.erase(rest.begin() + open->parameter);
    }
    return rest.size() < interior_.size();
  }

  // Returns the next parameter to freeze, as an index into `indices`: one that makes the information
  // singular, or whose standard error exceeds a surprisingly large step. If there is none, sets the
  // covariance of all.
  std::optional<OpenDirection> Undetermined(const NormalEquations& equations,
                                            const std::vector<int>& indices) {
    Eigen::VectorXd steps(indices.size());
    std::vector<std::string> names;
    for (std::size_t i = 0; i < indices.size(); ++i) {
      steps(static_cast<Eigen::Index>(i)) = catalog_[indices[i]].typical_step;
      names.push_back(catalog_[indices[i]].name);
    }
    if (auto open = LeastDetermined(equations, steps, names)) return open;
    covariance_ = JackknifeCovariance(equations);
    // A sigma of NaN, if one block alone determines a parameter, counts as undetermined.
    const Eigen::VectorXd sigma_in_steps = covariance_.diagonal().cwiseSqrt().cwiseQuotient(steps).unaryExpr(
        [](double sigma) { return std::isfinite(sigma) ? sigma : std::numeric_limits<double>::max(); });
    Eigen::Index worst = 0;
    if (sigma_in_steps.maxCoeff(&worst) <= 1.0) return std::nullopt;
    return OpenDirection{static_cast<int>(worst),
                         names[worst] + ", whose standard error exceeds a surprisingly large step"};
  }

  // Prior of a parameter that was free, in its unit.
  std::optional<ReportedNormal> ReportedPrior(std::size_t index) const {
    const CatalogEntry& entry = catalog_[index];
    if (status_[index] == ParameterStatus::kFixed || !entry.prior || !std::isfinite(entry.prior->sigma))
      return std::nullopt;
    const double value = entry.ValueFromCoordinate(entry.prior->coordinate);
    return ReportedNormal{.value = value, .sigma = entry.prior->sigma * entry.ValueSlope(value)};
  }

  void Finish(bool usable) {
    std::vector<std::optional<double>> sigma(catalog_.size());
    if (covariance_.rows() == static_cast<Eigen::Index>(interior_.size())) {
      for (std::size_t i = 0; i < interior_.size(); ++i) {
        const CatalogEntry& entry = catalog_[interior_[i]];
        sigma[interior_[i]] = Sigma(i) * entry.ValueSlope(state_.values[interior_[i]]);
        report_.correlation_names.push_back(entry.name);
      }
      report_.correlation = CorrelationFromCovariance(covariance_);
      report_.curves =
          FittedCurves(catalog_, model_.material_names(), state_.values, interior_,
                       student_.size() > 0 ? WidenedCovariance(covariance_, student_) : covariance_);
    }
    for (std::size_t i = 0; i < catalog_.size(); ++i) {
      const CatalogEntry& entry = catalog_[i];
      ParameterStatus status = status_[i];
      if (status == ParameterStatus::kFree && AtBound(i)) status = ParameterStatus::kAtBound;
      report_.parameters.push_back({.name = entry.name,
                                    .unit = entry.unit,
                                    .value = state_.values[i],
                                    .sigma = status == ParameterStatus::kFree ? sigma[i] : std::nullopt,
                                    .initial = initial_[i],
                                    .lower = entry.lower,
                                    .upper = entry.upper,
                                    .status = status,
                                    .prior = ReportedPrior(i)});
    }
    DescribeGauge();
    if (usable && !converged_) {
      report_.warnings.push_back(
          fmt::format("the fit reached max_iterations = {} before it converged: its values may still change, "
                      "and the standard errors do not hold",
                      options_.max_iterations));
    }
    for (int frame = 0; frame < model_.frame_count(); ++frame) {
      report_.frames_used.push_back(model_.frame_index(frame));
    }
  }

  // Source level, gain or db_min, and the common factor of all A, C and E change the same number.
  void DescribeGauge() {
    const bool acoustic = FindEntry(catalog_, "receiver.gain_db") >= 0;
    const std::string other = acoustic ? "receiver.gain_db" : "display.db_min";
    std::vector<std::string> held;
    for (const std::string& name : {std::string("source_level_db"), other}) {
      if (IsFixed(name)) held.emplace_back(name);
    }
    if (held.empty()) {
      report_.gauge.push_back(
          fmt::format("source_level_db and {} are both free: together with the materials' amplitudes they "
                      "change the same number, so the reported values are one of many equal solutions",
                      other));
      return;
    }
    report_.gauge.push_back(
        fmt::format("{} fixed at the given values: source level {}, and a common factor on A, C and E of all "
                    "materials are one number, carried by the materials",
                    fmt::join(held, " and "), acoustic ? "and gain" : "minus db_min"));
    if (!acoustic) {
      report_.gauge.emplace_back(
          "A, C and E of every material have a prior about the paper's curve 70 dB above db_min at 1 m, 20 "
          "dB wide; B, D and F about the paper's values, a factor of e, 1 and a factor of e wide; other free "
          "parameters about the value given, one surprising step wide; a named material (--material) or a "
          "configuration (--config) may give others");
    }
    if (acoustic) {
      report_.gauge.emplace_back(
          "every free parameter has a prior about the value given, one surprising step wide: a factor of ten "
          "for powers, of e for widths, 1 for D, 10 dB for losses of mirrors; a named material (--material) "
          "or a configuration (--config) may give others");
    }
  }

  const FrameModel& model_;
  const FrameModel* by_other_rays_;  // may be null
  const FitOptions& options_;
  std::vector<CatalogEntry> catalog_;
  ParameterValues initial_;
  std::vector<ParameterStatus> status_;
  FitState state_;
  std::vector<int> interior_;
  Eigen::MatrixXd covariance_;
  Eigen::VectorXd student_;       // factors on standard errors, per entry of `interior_`; empty: 1
  std::vector<double> widening_;  // factors on standard errors, per catalog entry; empty: 1
  FitReport report_;
  bool converged_ = false;  // the last solve
};

}  // namespace

void FitOptions::Check() const {
  if (max_iterations < 1) throw DataError("fit: max_iterations {}, expected at least 1", max_iterations);
  if (!(function_tolerance > 0.0)) {
    throw DataError("fit: function_tolerance {}, expected a positive one", function_tolerance);
  }
  if (starts < 1) throw DataError("fit: starts {}, expected at least 1", starts);
  if (threads < 0) throw DataError("fit: threads {}, expected 0 (all cores) or more", threads);
  if (block_bins < 1 || block_beams < 1) {
    throw DataError("fit: covariance blocks of {} x {} pixels, expected at least 1 x 1", block_bins,
                    block_beams);
  }
}

std::vector<double> MeasuredForFit(const PolarImage& image) {
  if (image.scale.quantity != Quantity::kGrey) {
    throw DataError("fit: the recorded image holds {}, expected grey levels", ToString(image.scale.quantity));
  }
  std::vector<double> measured;
  measured.reserve(image.value.size());
  for (const float value : image.value.values()) {
    if (!std::isfinite(value)) throw DataError("fit: a recorded pixel is not finite");
    measured.push_back(std::clamp(value / image.scale.full_scale, 0.0, 1.0));
  }
  return measured;
}

double GreyLevel(const PolarImage& image) {
  const auto whole = [](float value) { return value == std::round(value); };
  return std::all_of(image.value.values().begin(), image.value.values().end(), whole)
             ? 1.0 / image.scale.full_scale
             : 0.0;
}

ModelFit Fit(const FrameModel& model, const ParameterValues& initial, const FitConfig& config,
             const FitOptions& options, const FrameModel* by_other_rays) {
  options.Check();
  if (model.frame_count() == 0) throw DataError("fit: no frames");
  if (options.threads == 0) return Fitter(model, initial, config, options, by_other_rays).Run();
  tbb::task_arena arena(options.threads);
  return arena.execute([&] { return Fitter(model, initial, config, options, by_other_rays).Run(); });
}

}  // namespace sonarcal::calib
