// Fit of the paper's model (declared in calib/fit.h). The noise is not known in advance, so values and noise
// are fitted in turn.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "calib/degenerate_fit.h"
#include "calib/fit.h"
#include "calib/fit_starts.h"
#include "calib/problem_builder.h"

namespace sonarcal::calib {
namespace {

// Noise before the first fit: a tenth of full scale, and enough dither to give faint pixels a slope.
constexpr PaperNoise kFirstNoise = {.sigma = 0.1, .knee_sigma = 0.1, .variance_levels = 0.7};
constexpr int kNoiseRounds = 3;
// An optimum is worse than another for certain if its cost on blocks of pixels is higher by this much.
constexpr double kCertainNats = 10.0;

// Returns true if another round would change no value by as much as its standard error.
bool AreAlike(const PaperNoise& a, const PaperNoise& b) {
  constexpr double kRelative = 0.1;
  const auto alike = [](double x, double y) { return std::abs(x - y) <= kRelative * std::max(x, y); };
  return alike(a.sigma, b.sigma) && alike(a.knee_sigma, b.knee_sigma) &&
         alike(std::min(a.variance_levels, kUnroundedLevels), std::min(b.variance_levels, kUnroundedLevels));
}

class PaperFitter {
 public:
  PaperFitter(PaperFrameModel& model, ParameterValues given, const FitConfig& config,
              const FitOptions& options)
      : model_(model), given_(std::move(given)), config_(config), options_(options) {}

  // `coarse`: the same frames in blocks, for the search.
  ModelFit Run(PaperFrameModel& coarse) {
    model_.SetNoise(kFirstNoise);
    coarse.SetNoise(kFirstNoise);
    Search(coarse);
    if (ends_.empty() || options_.rough) return ends_.empty() ? last_ : ends_.front();
    ModelFit fit = Settle(ends_.front(), coarse);
    if (!fit.usable) return fit;
    if (ends_.size() > 1 && model_.RmsDifference(fit.values, ends_[1].values) > kOtherImage)
      TrySecondBest(coarse, fit);
    Complete(fit);
    return fit;
  }

 private:
  void Say(const std::string& line) const {
    if (options_.progress) options_.progress(line);
  }

  static double CostOf(const PaperFrameModel& model, const ParameterValues& values) {
    return CostAt(model, values, model.frame_count());
  }
  double CostOf(const ParameterValues& values) const { return CostOf(model_, values); }

  FitOptions Again(bool rough) const {
    FitOptions again = options_;
    again.starts = 1;
    again.search_level = false;
    again.rough = rough;
    return again;
  }

  // Bounds in bins and beams refer to the recording's pixels, not to blocks.
  FitConfig ConfigOfBlocks() const {
    FitConfig config = config_;
    for (const CatalogEntry& entry : model_.catalog()) {
      if (entry.group == ParameterGroup::kJitter)
        config.bounds.try_emplace(entry.name, entry.lower, entry.upper);
    }
    return config;
  }

  // Solves from the second-best result of the search, which may become the better one when it has converged:
  // by blocks of pixels, and by all pixels unless it is worse for certain. Exchanges `fit` for a better one.
  void TrySecondBest(PaperFrameModel& coarse, ModelFit& fit) {
    Say("solving from the second-best start");
    coarse.SetNoise(coarse.NoiseAbout(fit.values));
    ModelFit other = Fit(coarse, ends_[1].values, ConfigOfBlocks(), Again(/*rough=*/true));
    Count(other);
    if (!other.usable) return;
    if (CostOf(coarse, other.values) < CostOf(coarse, fit.values) + kCertainNats) {
      other = Fit(model_, other.values, config_, Again(/*rough=*/true));
      Count(other);
      if (other.usable && CostOf(other.values) < CostOf(fit.values)) {
        ModelFit better = SettleBy(model_, config_, other);
        if (better.usable && CostOf(better.values) < CostOf(fit.values)) std::swap(fit, better);
        other = std::move(better);
      }
    }
    if (other.usable) other_ = std::move(other.values);
  }

  // Solves roughly from every start and sorts `ends_`, best first.
  void Search(const PaperFrameModel& model) {
    const FitConfig config = ConfigOfBlocks();
    std::vector<CatalogEntry> catalog = model.catalog();
    const std::vector<bool> free = ApplyFitConfig(config, catalog);
    for (int start = 0; start < options_.starts; ++start) {
      if (options_.starts > 1) Say(fmt::format("start {} of {}", start + 1, options_.starts));
      FitOptions search = Again(/*rough=*/true);
      search.search_level = options_.search_level;
      const ParameterValues& level = ends_.empty() ? given_ : ends_.front().values;
      last_ = Fit(model, start == 0 ? given_ : WithCurveShape(catalog, free, given_, level, start), config,
                  search);
      Count(last_);
      if (!last_.usable) continue;
      start_costs_.push_back(last_.report.cost_final);
      ends_.push_back(last_);
    }
    std::stable_sort(ends_.begin(), ends_.end(), [](const ModelFit& a, const ModelFit& b) {
      return a.report.cost_final < b.report.cost_final;
    });
  }

  // Solves for values and noise: by blocks of pixels, where moves to better curves cost little, and from
  // there by all pixels.
  ModelFit Settle(const ModelFit& from, PaperFrameModel& coarse) {
    if (&coarse == &model_) return SettleBy(model_, config_, from);
    const ModelFit on_blocks = SettleBy(coarse, ConfigOfBlocks(), from);
    return SettleBy(model_, config_, on_blocks.usable ? on_blocks : from);
  }

  // Solves for values and noise in turn.
  ModelFit SettleBy(PaperFrameModel& model, const FitConfig& config, const ModelFit& from) {
    ModelFit fit = from;
    bool settled = false;
    for (int round = 1; !settled && fit.usable; ++round) {
      const PaperNoise noise = model.NoiseAbout(fit.values);
      settled = round == kNoiseRounds || AreAlike(noise, model.noise());
      model.SetNoise(noise);
      fit = Fit(model, fit.values, config, Again(/*rough=*/!settled));
      Count(fit);
    }
    return fit;
  }

  void Count(const ModelFit& fit) {
    iterations_ += fit.report.iterations;
    solve_s_ += fit.report.solve_s;
  }

  void Complete(ModelFit& fit) {
    FitReport& report = fit.report;
    model_.SetNoise(model_.NoiseAbout(fit.values));
    std::vector<OtherOptimum> others;
    if (!other_.empty()) {
      others.push_back({.cost = CostOf(other_), .difference = model_.RmsDifference(fit.values, other_)});
    }
    report.start_costs = start_costs_;
    report.iterations = iterations_;
    report.solve_s = solve_s_;
    for (std::size_t i = 0; i < report.parameters.size(); ++i) report.parameters[i].initial = given_[i];
    report.cost_initial = CostOf(given_);
    report.cost_final = CostOf(fit.values);
    const double sigma = model_.noise().sigma;
    report.raw =
        ResidualSummary{.mean = report.whitened.mean * sigma, .spread = report.whitened.spread * sigma};
    for (std::string& warning : DegenerateFitWarnings(report, model_.ClippingAt(fit.values), others))
      report.warnings.push_back(std::move(warning));
  }

  PaperFrameModel& model_;
  const ParameterValues given_;
  const FitConfig& config_;
  const FitOptions& options_;
  std::vector<ModelFit> ends_;
  ModelFit last_;
  std::vector<double> start_costs_;
  ParameterValues other_;  // result of another start; empty: the same optimum
  int iterations_ = 0;
  double solve_s_ = 0.0;
};

}  // namespace

std::vector<std::string> PaperFreeByDefault() {
  return {"materials", "display.db_max", "jitter.sigma_range_m", "jitter.sigma_azimuth_deg"};
}

FitResult FitPaperModel(const std::vector<FitFrame>& frames, const sim::ImageGeometry& geometry,
                        const std::vector<std::string>& material_names, const ParameterSet& initial,
                        const FitConfig& config, const FitOptions& options) {
  PaperFrameModel model(frames, geometry, material_names, initial);
  FitConfig complete = config;
  if (!complete.free) complete.free = PaperFreeByDefault();
  const std::unique_ptr<PaperFrameModel> coarse = model.InBlocks();
  ModelFit fit =
      PaperFitter(model, model.Values(initial), complete, options).Run(coarse != nullptr ? *coarse : model);
  // If the data determine nothing, only the priors remain: that is no solution.
  const bool determined = std::any_of(
      fit.report.parameters.begin(), fit.report.parameters.end(), [](const FittedParameter& parameter) {
        return parameter.status == ParameterStatus::kFree || parameter.status == ParameterStatus::kAtBound;
      });
  FitResult result{
      .parameters = initial, .report = std::move(fit.report), .usable = fit.usable && determined};
  model.Store(fit.values, result.parameters);
  return result;
}

}  // namespace sonarcal::calib
