#include "tests/calib/coverage.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numeric>

#include "calib/acoustic_fit.h"
#include "calib/problem_builder.h"
#include "core/math/random.h"
#include "core/types/units.h"
#include "sim/physics/gsab.h"
#include "tests/calib/small_tank.h"

namespace sonarcal::testing {
namespace {

constexpr double kTwoSided95 = 1.959964;

// Views of every face, steep and slant, each with others beside it.
std::vector<Pose> Poses(int views_of_each) {
  std::vector<Pose> poses;
  const auto look = [&](double x_m, double y_m, double z_m, double yaw_deg, double pitch_deg) {
    for (int view = 0; view < views_of_each; ++view) {
      const double aside = view - 0.5 * (views_of_each - 1);
      poses.push_back({RotationFromYawPitchRoll(RadFromDeg(yaw_deg + 6.0 * aside),
                                                RadFromDeg(pitch_deg + 3.0 * aside), 0.0),
                       {x_m + 0.1 * aside, y_m + 0.1 * aside, z_m}});
    }
  };
  look(0.0, -2.5, 1.2, 0.0, -25.0);
  look(1.4, -2.2, 1.5, 30.0, -40.0);
  look(-0.3, -1.2, 2.6, 0.0, -80.0);
  look(0.3, 2.4, 0.6, 180.0, -5.0);
  look(-2.2, 0.1, 0.5, -90.0, -3.0);
  look(2.4, -0.2, 0.6, 90.0, 5.0);
  look(0.2, -0.3, 3.2, 10.0, -85.0);
  look(2.0, 0.3, 2.2, 40.0, -78.0);
  return poses;
}

SonarModel Sonar(const CoverageOptions& options) {
  SonarModel sonar = SmallSonar();
  sonar.azimuth_beam_width_deg = options.beam_width_deg;
  return sonar;
}

sim::SimulationOptions Noisy() {
  sim::SimulationOptions options = SmallTankOptions();
  options.bits = 8;
  options.noise = true;
  return options;
}

// Running sums of a parameter.
struct Tally {
  int count = 0;
  int covered_68 = 0;
  int covered_95 = 0;
  double error = 0.0;
  double error_square = 0.0;
  double linear = 0.0;
  double linear_square = 0.0;
  double sigma_square = 0.0;
};

// Counts of one data set.
struct SetTally {
  int determined = 0;
  int covered_68 = 0;
  int covered_95 = 0;
};

CoveredShare ShareOf(const std::vector<SetTally>& sets, int SetTally::*covered) {
  std::vector<double> shares;
  for (const SetTally& set : sets) {
    if (set.determined > 0) shares.push_back(static_cast<double>(set.*covered) / set.determined);
  }
  if (shares.size() < 2) return {};
  const auto n = static_cast<double>(shares.size());
  const double mean = std::accumulate(shares.begin(), shares.end(), 0.0) / n;
  double squares = 0.0;
  for (const double share : shares) squares += (share - mean) * (share - mean);
  return {.mean = mean, .standard_error = std::sqrt(squares / (n - 1.0) / n)};
}

class Study {
 public:
  explicit Study(const CoverageOptions& options)
      : options_(options),
        truth_(Truth(options)),
        simulator_(SmallTank(), Sonar(options), Noisy()),
        frames_(TraceFrames()),
        model_(simulator_, frames_, truth_),
        catalog_(model_.catalog()) {
    config_.free = {"materials", "receiver.noise_db"};
    const std::vector<bool> free = calib::ApplyFitConfig(config_, catalog_);
    for (std::size_t i = 0; i < free.size(); ++i) {
      if (free[i]) free_.push_back(static_cast<int>(i));
    }
    for (int frame = 0; frame < model_.frame_count(); ++frame)
      means_.push_back(model_.MeanPower(frame, model_.initial_values()));
    const calib::NormalEquations at_truth = EquationsAtTruth();
    information_ = at_truth.information;
    prior_.resize(static_cast<Eigen::Index>(free_.size()));
    for (std::size_t k = 0; k < free_.size(); ++k) {
      const double step = catalog_[free_[k]].typical_step;
      prior_(static_cast<Eigen::Index>(k)) = 1.0 / (step * step);
    }
    information_.diagonal() += prior_;
    bound_ = information_.inverse();
  }

  CoverageTable Run() {
    std::vector<Tally> tallies(free_.size());
    CoverageTable table{.data_sets = options_.data_sets};
    double pooled = 0.0;
    for (int set = 0; set < options_.data_sets; ++set) {
      for (int frame = 0; frame < model_.frame_count(); ++frame)
        frames_[frame].recorded = calib::RecordedPowers(Draw(set, frame), truth_.display);
      const calib::ParameterValues initial = DrawInitial(set);
      const calib::ModelFit fit = calib::Fit(model_, initial, config_, options_.fit);
      if (!fit.usable) {
        ++table.failed;
        continue;
      }
      CountCurves(fit);
      pooled += Count(fit, LinearError(initial), tallies);
      if (options_.progress) options_.progress(set + 1);
    }
    const double counted = std::max(1, options_.data_sets - table.failed);
    table.variance_over_bound = pooled / counted / static_cast<double>(free_.size());
    table.curves_covered_95 =
        static_cast<double>(curve_covered_) / static_cast<double>(std::max(1L, curve_points_));
    for (std::size_t k = 0; k < free_.size(); ++k) table.rows.push_back(Row(k, tallies[k]));
    table.all_68 = ShareOf(sets_, &SetTally::covered_68);
    table.all_95 = ShareOf(sets_, &SetTally::covered_95);
    return table;
  }

 private:
  static ParameterSet Truth(const CoverageOptions& options) {
    ParameterSet truth = SmallTankAcousticTruth();
    if (options.tank_curves) {
      truth.materials["floor"].gsab = {
          .a = 0.1, .b_deg = 5.0, .c = 0.002, .d = 1.8, .e = 0.01, .f_deg = 11.0};
      truth.materials["box"].gsab = {
          .a = 0.126, .b_deg = 5.5, .c = 0.01, .d = 1.3, .e = 0.025, .f_deg = 17.0};
      truth.receiver.noise_db = 112.0;
      truth.display = {.db_min = 102.0, .db_max = 152.0};
    }
    truth.pulse.length_m = options.pulse_bins * SmallSonar().axes.range_bin_m();
    return truth;
  }

  std::vector<calib::AcousticFrame> TraceFrames() {
    std::vector<calib::AcousticFrame> frames;
    const std::size_t pixels =
        static_cast<std::size_t>(simulator_.sonar().axes.range_bins) * simulator_.sonar().axes.beam_count();
    for (const Pose& pose : Poses(options_.views)) {
      echoes_.push_back(simulator_.TraceEchoes(pose));
      frames.push_back({.index = static_cast<int>(frames.size()),
                        .world_from_sonar = pose,
                        .recorded = std::vector<calib::RecordedPower>(pixels)});
    }
    return frames;
  }

  // The image of a frame in one data set, in grey levels.
  PolarImage Draw(int set, int frame) const {
    const std::uint64_t number = static_cast<std::uint64_t>(set) * frames_.size() + frame;
    if (options_.speckle == Speckle::kGrained)
      return simulator_.RenderEchoes(echoes_[frame], truth_,
                                     static_cast<int>(1'000'000 * options_.seed + number));
    const PolarAxes& axes = simulator_.sonar().axes;
    PolarImage power{
        axes,
        {.quantity = Quantity::kPower, .full_scale = 1.0, .db_min = {}, .db_max = {}, .db_span = {}},
        Grid<float>(axes.range_bins, axes.beam_count())};
    const CounterRandom random(options_.seed << 32 | number);
    for (std::size_t i = 0; i < power.value.size(); ++i)
      power.value.values()[i] = static_cast<float>(-means_[frame][i] * std::log(random.Uniform2(i).first));
    PolarImage shown = sim::DisplayPower(power, truth_, simulator_.options().full_scale());
    for (float& grey : shown.value.values()) grey = std::round(grey);
    return shown;
  }

  calib::ParameterValues ReadmeInitial() const {
    constexpr std::array<double, 6> kCurve = {0.05, 5.0, 0.005, 1.5, 0.02, 15.0};
    calib::ParameterValues initial = model_.initial_values();
    ParameterSet unknown = truth_;
    unknown.receiver.noise_db.reset();
    const double noise_db = *calib::WithNoiseStart(std::move(unknown), frames_).receiver.noise_db;
    for (const int i : free_) {
      initial[i] = catalog_[i].group == calib::ParameterGroup::kGsab ? kCurve[catalog_[i].index] : noise_db;
    }
    return initial;
  }

  // What somebody knew beforehand: values about the truth, as the priors say.
  calib::ParameterValues DrawInitial(int set) const {
    if (options_.start == Start::kReadme) return ReadmeInitial();
    const CounterRandom random(options_.seed << 32 | static_cast<std::uint64_t>(set), 1);
    calib::ParameterValues initial = model_.initial_values();
    for (const int i : free_) {
      const calib::CatalogEntry& entry = catalog_[i];
      const double moved = options_.prior_scatter * entry.typical_step * random.Normal2(i).first;
      initial[i] = std::clamp(entry.ValueFromCoordinate(entry.CoordinateFromValue(initial[i]) + moved),
                              entry.lower, entry.upper);
    }
    return initial;
  }

  calib::NormalEquations EquationsAtTruth() const {
    return calib::Accumulate(model_, catalog_, {.active = free_, .values = model_.initial_values()},
                             options_.fit);
  }

  // Coordinates relative to the truth's.
  Eigen::VectorXd FromTruth(const calib::ParameterValues& values) const {
    Eigen::VectorXd error(static_cast<Eigen::Index>(free_.size()));
    for (std::size_t k = 0; k < free_.size(); ++k) {
      const calib::CatalogEntry& entry = catalog_[free_[k]];
      error(static_cast<Eigen::Index>(k)) = entry.CoordinateFromValue(values[free_[k]]) -
                                            entry.CoordinateFromValue(model_.initial_values()[free_[k]]);
    }
    return error;
  }

  // Of one step of Fisher scoring from the truth.
  Eigen::VectorXd LinearError(const calib::ParameterValues& prior_centre) const {
    Eigen::VectorXd gradient = -prior_.cwiseProduct(FromTruth(prior_centre));
    for (const calib::NormalEquations::Block& block : EquationsAtTruth().blocks)
      gradient(block.columns) += block.score;
    return -bound_ * gradient;
  }

  // Adds the points of a fit's curves.
  void CountCurves(const calib::ModelFit& fit) {
    for (const calib::FittedCurve& curve : fit.report.curves) {
      for (std::size_t i = 0; i < curve.incidence_deg.size(); ++i) {
        if (curve.incidence_deg[i] < 5.0 || curve.incidence_deg[i] > 80.0) continue;
        const double true_db = sim::GsabDb(truth_.Material(curve.material).gsab, curve.incidence_deg[i]);
        ++curve_points_;
        if (std::abs(curve.backscatter_db[i] - true_db) <= kTwoSided95 * curve.sigma_db[i]) ++curve_covered_;
      }
    }
  }

  // Adds a fit's errors; returns their square in units of the bound.
  double Count(const calib::ModelFit& fit, const Eigen::VectorXd& linear, std::vector<Tally>& tallies) {
    const Eigen::VectorXd errors = FromTruth(fit.values);
    SetTally set;
    for (std::size_t k = 0; k < free_.size(); ++k) {
      const calib::CatalogEntry& entry = catalog_[free_[k]];
      const calib::FittedParameter& of = fit.report.parameters[free_[k]];
      if (!of.sigma) continue;
      const double error = errors(static_cast<Eigen::Index>(k));
      const double sigma = *of.sigma / entry.ValueSlope(of.value);
      const double of_linear = linear(static_cast<Eigen::Index>(k));
      Tally& tally = tallies[k];
      const int in_68 = std::abs(error) <= sigma ? 1 : 0;
      const int in_95 = std::abs(error) <= kTwoSided95 * sigma ? 1 : 0;
      ++set.determined;
      set.covered_68 += in_68;
      set.covered_95 += in_95;
      ++tally.count;
      tally.covered_68 += in_68;
      tally.covered_95 += in_95;
      tally.error += error;
      tally.error_square += error * error;
      tally.linear += of_linear;
      tally.linear_square += of_linear * of_linear;
      tally.sigma_square += sigma * sigma;
    }
    sets_.push_back(set);
    return errors.dot(information_ * errors);
  }

  CoverageRow Row(std::size_t k, const Tally& tally) const {
    const auto i = static_cast<Eigen::Index>(k);
    CoverageRow row{.name = catalog_[free_[k]].name,
                    .determined = tally.count,
                    .truth = model_.initial_values()[free_[k]],
                    .bound = std::sqrt(bound_(i, i)),
                    .prior_share = bound_(i, i) * prior_(i)};
    if (tally.count < 2) return row;
    const double n = tally.count;
    const auto variance = [n](double sum, double square) { return (square - sum * sum / n) / (n - 1.0); };
    row.spread = std::sqrt(variance(tally.error, tally.error_square));
    row.mean_sigma = std::sqrt(tally.sigma_square / n);
    row.bias_in_sigmas = tally.error / n / row.mean_sigma;
    row.covered_68 = tally.covered_68 / n;
    row.covered_95 = tally.covered_95 / n;
    row.variance_over_linear = row.spread * row.spread / variance(tally.linear, tally.linear_square);
    return row;
  }

  CoverageOptions options_;
  ParameterSet truth_;
  sim::Simulator simulator_;
  std::vector<sim::EchoList> echoes_;
  std::vector<calib::AcousticFrame> frames_;
  calib::AcousticFrameModel model_;
  std::vector<calib::CatalogEntry> catalog_;
  calib::FitConfig config_;
  std::vector<int> free_;
  std::vector<std::vector<double>> means_;
  Eigen::VectorXd prior_;        // 1 / variance
  Eigen::MatrixXd information_;  // expected, the priors' included
  Eigen::MatrixXd bound_;        // its inverse
  std::vector<SetTally> sets_;
  long curve_points_ = 0;
  long curve_covered_ = 0;
};

}  // namespace

CoverageTable StudyCoverage(const CoverageOptions& options) {
  return Study(options).Run();
}

std::string Markdown(const CoverageTable& table) {
  std::string text =
      "| parameter | truth | determined in | bias / sigma | spread | mean sigma | spread / bound | variance "
      "/ "
      "linear | prior share | 68 % covers | 95 % covers |\n|---|---|---|---|---|---|---|---|---|---|---|\n";
  for (const CoverageRow& row : table.rows) {
    if (row.determined < 2) {
      fmt::format_to(std::back_inserter(text), "| {} | {:.4g} | {} | | | | | | | |\n", row.name, row.truth,
                     row.determined);
      continue;
    }
    fmt::format_to(
        std::back_inserter(text),
        "| {} | {:.4g} | {} | {:+.2f} | {:.4f} | {:.4f} | {:.2f} | {:.2f} | {:.3f} | {:.1f} | {:.1f} |\n",
        row.name, row.truth, row.determined, row.bias_in_sigmas, row.spread, row.mean_sigma,
        row.spread / row.bound, row.variance_over_linear, row.prior_share, 100.0 * row.covered_68,
        100.0 * row.covered_95);
  }
  return text;
}

}  // namespace sonarcal::testing
