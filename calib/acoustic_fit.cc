#include "calib/acoustic_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "data_io/types/error.h"
#include "data_io/types/units.h"

namespace sonarcal {
namespace {

// Rounds about a new point, at most; and the move, in parts of what a round may move, below which no other
// round follows.
constexpr int kRounds = 10;
constexpr double kSettled = 0.05;

// Rounds of weighing down what the scene does not explain.
constexpr int kWeightRounds = 2;

// How far a round may move a geometric parameter from its point.
double Reach(const CatalogEntry& entry, double value) {
  constexpr double kOfWidth = 0.2;
  if (entry.group != ParameterGroup::kPose) return kOfWidth * value;
  return entry.index < 3 ? 0.02 : 1.0;  // m, degrees
}

// The configuration that lets geometric parameters move about a point only as far as they are linear there.
FitConfig Near(const FitConfig& config, const std::vector<CatalogEntry>& catalog,
               const std::vector<int>& geometric, const ParameterValues& point) {
  FitConfig near = config;
  for (const int entry : geometric) {
    const double reach = Reach(catalog[entry], point[entry]);
    near.bounds[catalog[entry].name] = {std::max(point[entry] - reach, catalog[entry].lower),
                                        std::min(point[entry] + reach, catalog[entry].upper)};
  }
  return near;
}

}  // namespace

void GivePriors(const ParameterValues& initial, const std::vector<bool>& free,
                const std::vector<CatalogEntry>& catalog, FitConfig& config) {
  for (std::size_t i = 0; i < catalog.size(); ++i) {
    const CatalogEntry& entry = catalog[i];
    if (!free[i] || entry.prior) continue;
    const double value = std::clamp(initial[i], entry.lower, entry.upper);
    config.priors[entry.name] = {value, entry.typical_step * entry.ValueSlope(value)};
  }
}

std::vector<std::string> AcousticFreeByDefault(const ParameterSet& initial) {
  std::vector<std::string> free = {"materials", "receiver.noise_db"};
  if (!(initial.pulse.length_m > 0.0)) free.emplace_back("pulse.length_m");
  return free;
}

double NoiseStartDb(const std::vector<AcousticFrame>& frames, double looks) {
  constexpr double kDarkest = 0.2;
  std::vector<double> powers;
  for (const AcousticFrame& frame : frames) {
    for (const RecordedPower& recorded : frame.recorded) powers.push_back(recorded.power);
  }
  if (powers.empty()) throw DataError("fit: no pixels");
  const auto at = powers.begin() + static_cast<std::ptrdiff_t>(kDarkest * static_cast<double>(powers.size()));
  std::nth_element(powers.begin(), at, powers.end());
  // Were all of them noise, the darkest fifth of exponential power would end at -ln(0.8) of its mean; of more
  // looks, nearer to it.
  const double of_mean = looks > 2.0 ? 1.0 : -std::log1p(-kDarkest);
  return DbFromPower(*at / of_mean);
}

AcousticFit FitAcousticModel(const Simulator& simulator, const std::vector<AcousticFrame>& frames,
                             const ParameterSet& initial, const FitConfig& given, const FitOptions& options) {
  if (frames.empty()) throw DataError("fit: no frames");
  FitConfig config = given;
  if (!config.free) config.free = AcousticFreeByDefault(initial);
  const auto began = std::chrono::steady_clock::now();
  AcousticFrameModel model(simulator, frames, initial);
  std::vector<CatalogEntry> catalog = model.catalog();
  const std::vector<bool> free = ApplyFitConfig(config, catalog);
  GivePriors(model.initial_values(), free, catalog, config);
  std::vector<int> geometric;
  for (std::size_t i = 0; i < catalog.size(); ++i) {
    if (free[i] && IsGeometric(catalog[i])) geometric.push_back(static_cast<int>(i));
  }

  // Curves and receiver first: about a wrong level no geometry can be told.
  FitConfig radiometry = config;
  for (const int entry : geometric) radiometry.fixed.push_back(catalog[entry].name);
  const bool only_geometry = std::all_of(free.begin(), free.end(), [&, i = 0](bool value) mutable {
    const CatalogEntry& entry = catalog[i++];
    return !value || IsGeometric(entry);
  });
  FitOptions start = options;
  start.rough = !geometric.empty();
  ModelFit fit{.values = model.initial_values(), .report = {}, .usable = true};
  if (!only_geometry) fit = Fit(model, fit.values, geometric.empty() ? config : radiometry, start);

  std::vector<double> start_costs = fit.report.start_costs;
  const double cost_initial = only_geometry ? 0.0 : fit.report.cost_initial;
  int iterations = fit.report.iterations;
  FitOptions again = options;
  again.starts = 1;
  again.search_level = false;
  FitConfig near = config;
  bool settled = geometric.empty();
  for (int round = 0; round < kRounds && fit.usable && !settled; ++round) {
    if (options.progress)
      options.progress(fmt::format("round {}: tracing about the point reached", round + 1));
    const ParameterValues point = fit.values;
    model.Linearise(point, geometric);
    near = Near(config, catalog, geometric, point);
    again.rough = true;
    fit = Fit(model, point, near, again);
    iterations += fit.report.iterations;
    double largest = 0.0;
    for (const int entry : geometric) {
      largest =
          std::max(largest, std::abs(fit.values[entry] - point[entry]) / Reach(catalog[entry], point[entry]));
    }
    settled = largest < kSettled;
  }
  again.rough = false;
  if (!geometric.empty() && fit.usable) {
    fit = Fit(model, fit.values, near, again);
    iterations += fit.report.iterations;
  }

  for (int round = 0; round < kWeightRounds && fit.usable && options.down_weight; ++round) {
    if (options.progress) options.progress("weighing down what the scene does not explain");
    model.DownWeight(fit.values);
    fit = Fit(model, fit.values, near, again);
    iterations += fit.report.iterations;
  }

  AcousticFit result{.parameters = model.Parameters(fit.values),
                     .world_from_sonar = {},
                     .weights = {},
                     .report = std::move(fit.report),
                     .usable = fit.usable};
  for (int frame = 0; frame < model.frame_count(); ++frame)
    result.world_from_sonar.push_back(model.PoseOf(frame, fit.values));
  FitReport& report = result.report;
  if (options.down_weight) {
    std::size_t low = 0;
    std::size_t counted = 0;
    for (int frame = 0; frame < model.frame_count(); ++frame) {
      result.weights.push_back(model.weights(frame));
      for (std::size_t pixel = 0; pixel < model.pixel_count(); ++pixel) {
        if (!model.Counts(frame, pixel)) continue;
        ++counted;
        if (model.weights(frame)[pixel] < 0.5F) ++low;
      }
    }
    report.down_weighted_share =
        static_cast<double>(low) / static_cast<double>(std::max<std::size_t>(1, counted));
  }
  for (std::size_t i = 0; i < report.parameters.size(); ++i) {
    report.parameters[i].initial = model.initial_values()[i];
    report.parameters[i].lower = catalog[i].lower;
    report.parameters[i].upper = catalog[i].upper;
  }
  // Poses that nobody freed are data, not parameters.
  std::erase_if(report.parameters, [](const FittedParameter& parameter) {
    return parameter.name.starts_with("pose.") && parameter.status == ParameterStatus::kFixed;
  });
  if (!start_costs.empty()) report.start_costs = start_costs;
  if (!only_geometry) report.cost_initial = cost_initial;
  report.iterations = iterations;
  report.solve_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  if (!settled) {
    report.termination +=
        fmt::format("; beam, pulse or poses still moved after {} rounds of tracing", kRounds);
  }
  return result;
}

}  // namespace sonarcal
