#include "calib/noise/noise_solver.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "calib/noise/noise_information.h"
#include "core/types/units.h"

namespace sonarcal::calib {
namespace {

// Precision (1 / dB^2) that holds the mean of a taper over beams at 0. A taper is relative to the level of
// its floor.
constexpr double kTaperMeanPrecision = 1e8;
// Convergence: remaining gain in nats. No parameter is then further than 0.05 sigma from the optimum.
constexpr double kNoiseConverged = 1e-3;
// Alternative: total gain of the last steps in nats. For a likelihood that is not quadratic, such as that of
// beams with interference, which no law with one speckle describes.
constexpr double kGainedLittle = 0.02;
constexpr int kLastSteps = 4;
constexpr double kMaxStepDb = 6.0;
constexpr double kDiffuseLogitSpread = 2.0;  // prior standard deviation of the logit of the diffuse share
constexpr double kMaxNoiseDamping = 1e8;
constexpr double kFreeDamping = 1e-2;  // up to here, damping is not the cause of a short step
// Min curvature for damping, as a fraction of the largest diagonal element.
constexpr double kLeastCurvature = 1e-8;

double Logit(double share) {
  return std::log(share / (1.0 - share));
}

double ShareOfLogit(double logit) {
  return 1.0 / (1.0 + std::exp(-logit));
}

NoiseLayout MakeLayout(const NoiseLaw& law, bool fit_span, bool fit_soft_db, int beams) {
  NoiseLayout layout;
  layout.beams = beams;
  const auto take = [&layout](int count) { return std::exchange(layout.count, layout.count + count); };
  if (law.receiver.noise_db) {
    layout.noise_db = take(1);
    layout.slope = take(1);
  }
  if (law.receiver.noise_after_gain_db) layout.after_db = take(1);
  if (fit_span) {
    layout.span_db = take(1);
  } else {
    layout.log_looks = take(1);
    if (law.speckle == sim::SpeckleLaw::kKDiffuse) layout.logit_diffuse = take(1);
  }
  if (fit_soft_db) layout.soft_db = take(1);
  if (law.receiver.noise_db) layout.taper = take(beams);
  if (law.receiver.noise_after_gain_db) layout.after_taper = take(beams);
  return layout;
}

Eigen::VectorXd ToVector(const NoiseLaw& law, const NoiseLayout& layout) {
  Eigen::VectorXd value = Eigen::VectorXd::Zero(layout.count);
  const auto set = [&value](int place, double number) {
    if (place >= 0) value[place] = number;
  };
  set(layout.noise_db, law.receiver.noise_db.value_or(0.0));
  set(layout.slope, law.receiver.noise_slope_db_per_m);
  set(layout.after_db, law.receiver.noise_after_gain_db.value_or(0.0));
  set(layout.log_looks, std::log(law.receiver.looks));
  set(layout.logit_diffuse, Logit(law.receiver.diffuse_share));
  set(layout.span_db, law.display.db_max - law.display.db_min);
  set(layout.soft_db, law.display.soft_db);
  for (int beam = 0; beam < layout.beams; ++beam) {
    if (layout.taper >= 0 && !law.receiver.noise_taper_db.empty()) {
      value[layout.taper + beam] = law.receiver.noise_taper_db[beam];
    }
    if (layout.after_taper >= 0 && !law.receiver.noise_after_gain_taper_db.empty()) {
      value[layout.after_taper + beam] = law.receiver.noise_after_gain_taper_db[beam];
    }
  }
  return value;
}

NoiseLaw FromVector(const NoiseLaw& form, const NoiseLayout& layout, const Eigen::VectorXd& value) {
  NoiseLaw law = form;
  if (layout.noise_db >= 0) {
    law.receiver.noise_db = value[layout.noise_db];
    law.receiver.noise_slope_db_per_m = value[layout.slope];
    law.receiver.noise_taper_db.assign(&value[layout.taper], &value[layout.taper] + layout.beams);
  }
  if (layout.after_db >= 0) {
    law.receiver.noise_after_gain_db = value[layout.after_db];
    law.receiver.noise_after_gain_taper_db.assign(&value[layout.after_taper],
                                                  &value[layout.after_taper] + layout.beams);
  }
  if (layout.log_looks >= 0) law.receiver.looks = std::exp(value[layout.log_looks]);
  if (layout.logit_diffuse >= 0) law.receiver.diffuse_share = ShareOfLogit(value[layout.logit_diffuse]);
  if (layout.span_db >= 0) law.display.db_max = law.display.db_min + value[layout.span_db];
  if (layout.soft_db >= 0) law.display.soft_db = value[layout.soft_db];
  return law;
}

// Tests the bounds that calib/noise/noise_fit_report.cc states.
bool WithinBounds(const NoiseLayout& layout, const Eigen::VectorXd& value) {
  if (!value.allFinite()) return false;
  for (int place = 0; place < layout.count; ++place) {
    const double most = place == layout.slope ? kMaxSlopeDbPerM : kMaxLevelDb;
    if (std::abs(value[place]) > most) return false;
  }
  return true;
}

// Levenberg's damping: a fraction of the diagonal, with a min value for parameters that the pings do not
// determine.
Eigen::MatrixXd Damped(const Eigen::MatrixXd& information, double damping) {
  const Eigen::VectorXd size = information.diagonal().cwiseAbs();
  Eigen::MatrixXd damped = information;
  damped.diagonal() += damping * size.cwiseMax(kLeastCurvature * size.maxCoeff());
  return damped;
}

// Newton's step if the curvature of ln N leaves the information positive definite, else Fisher's.
std::optional<Eigen::VectorXd> Step(const Eigen::MatrixXd& information, const Eigen::MatrixXd& curvature,
                                    const Eigen::VectorXd& score, double damping) {
  Eigen::LLT<Eigen::MatrixXd> solver(Damped(information + curvature, damping));
  if (solver.info() != Eigen::Success) solver.compute(Damped(information, damping));
  if (solver.info() != Eigen::Success) return std::nullopt;
  return solver.solve(score);
}

constexpr int kMaxPerCell = 8;

// Parameters of a cell, and the derivatives of ln N and of the levels' probabilities by them.
struct CellParameters {
  std::array<int, kMaxPerCell> place;
  std::array<double, kMaxPerCell> by_log_noise;    // d ln N / d parameter
  std::array<double, kMaxPerCell> curvature_sign;  // for d2 ln N: outer product of these times bend
  std::array<int, kMaxPerCell> grey_derivative;    // index in GreyLevels::Chance, or -1
  int count = 0;
  double noise_power = 0.0;
  double bend = 0.0;

  void Add(int where, double log_noise, double sign, int grey) {
    if (where < 0) return;
    place[count] = where;
    by_log_noise[count] = log_noise;
    curvature_sign[count] = sign;
    grey_derivative[count] = grey;
    ++count;
  }
};

CellParameters AtCell(const NoiseLaw& law, const NoiseLayout& layout, double range_m, int beam,
                      double absorption_db_per_m) {
  CellParameters cell;
  cell.noise_power = sim::NoisePower(law.receiver, range_m, beam, absorption_db_per_m);
  double share = 1.0;
  if (law.receiver.noise_after_gain_db) {
    const double taper_db =
        law.receiver.noise_after_gain_taper_db.empty() ? 0.0 : law.receiver.noise_after_gain_taper_db[beam];
    share = 1.0 - PowerFromDb(*law.receiver.noise_after_gain_db + taper_db) / cell.noise_power;
  }
  // ln N is the logarithm of a sum of two powers. Its curvature by their ratio is share (1 - share).
  cell.bend = kNeperPerDb * kNeperPerDb * share * (1.0 - share);
  cell.Add(layout.noise_db, kNeperPerDb * share, 1.0, -1);
  cell.Add(layout.slope, kNeperPerDb * share * range_m, range_m, -1);
  cell.Add(layout.taper < 0 ? -1 : layout.taper + beam, kNeperPerDb * share, 1.0, -1);
  cell.Add(layout.after_db, kNeperPerDb * (1.0 - share), -1.0, -1);
  cell.Add(layout.after_taper < 0 ? -1 : layout.after_taper + beam, kNeperPerDb * (1.0 - share), -1.0, -1);
  cell.Add(layout.log_looks, 0.0, 0.0, 1);
  cell.Add(layout.span_db, 0.0, 0.0, 2);
  cell.Add(layout.soft_db, 0.0, 0.0, 3);
  cell.Add(layout.logit_diffuse, 0.0, 0.0, 4);
  return cell;
}

struct Evaluation {
  double cost = 0.0;  // -log likelihood
  Eigen::VectorXd score;
  Eigen::MatrixXd information;  // expected: positive semi-definite
  Eigen::MatrixXd curvature;    // second derivative of ln N; may make the sum indefinite
};

Evaluation Evaluate(const NoiseLaw& law, const NoiseLayout& layout, const NoiseCounts& counts,
                    const NoiseCells& cells, const std::vector<double>& weight, double absorption_db_per_m,
                    bool with_information) {
  const GreyLevels grey(law, cells.full_scale, layout.log_looks >= 0);
  Evaluation sum{.score = Eigen::VectorXd::Zero(layout.count), .information = {}, .curvature = {}};
  constexpr int kKinds = GreyLevels::kDerivatives;
  struct Used {
    CellParameters parameters;
    Eigen::Matrix<double, kKinds, kMaxPerCell> jacobian;
    double pixels = 0.0;
    double by_log_noise = 0.0;  // score
  };
  std::vector<Used> used;
  for (int i = 0; i < cells.count(); ++i) {
    if (counts[i].empty() || (!weight.empty() && weight[i] == 0.0)) continue;
    Used& cell = used.emplace_back();
    cell.parameters =
        AtCell(law, layout, cells.RangeM(i / cells.beams()), i % cells.beams(), absorption_db_per_m);
    const CellParameters& parameters = cell.parameters;
    // Computes the score in ln N and by the derivatives of GreyLevels first: few numbers per level.
    Eigen::Vector<double, kKinds> score = Eigen::Vector<double, kKinds>::Zero();
    int last = -1;
    GreyLevels::Chance lower;
    for (const auto& [level, count] : counts[i]) {
      if (level != last + 1) lower = grey.Below(level - 1, parameters.noise_power);
      const GreyLevels::Chance upper = grey.Below(level, parameters.noise_power);
      const GreyLevels::Chance chance = GreyLevels::Between(lower, upper);
      lower = upper;
      last = level;
      sum.cost -= count * std::log(chance.value);
      score +=
          count / chance.value * Eigen::Map<const Eigen::Vector<double, kKinds>>(chance.derivative.data());
      cell.pixels += count;
    }
    cell.by_log_noise = score[0];
    cell.jacobian.setZero();
    for (int p = 0; p < parameters.count; ++p) {
      cell.jacobian(0, p) = parameters.by_log_noise[p];
      if (parameters.grey_derivative[p] >= 0) cell.jacobian(parameters.grey_derivative[p], p) = 1.0;
    }
    const Eigen::Vector<double, kMaxPerCell> by_parameter = cell.jacobian.transpose() * score;
    for (int p = 0; p < parameters.count; ++p) sum.score[parameters.place[p]] += by_parameter[p];
  }
  if (!with_information) return sum;
  sum.information = Eigen::MatrixXd::Zero(layout.count, layout.count);
  sum.curvature = sum.information;
  if (used.empty() || !std::isfinite(sum.cost)) return sum;
  const auto [least, most] = std::minmax_element(used.begin(), used.end(), [](const Used& a, const Used& b) {
    return a.parameters.noise_power < b.parameters.noise_power;
  });
  const InformationTable expected(grey, cells.full_scale, least->parameters.noise_power,
                                  most->parameters.noise_power);
  for (const Used& cell : used) {
    const CellParameters& parameters = cell.parameters;
    const Eigen::Matrix<double, kMaxPerCell, kMaxPerCell> block =
        cell.pixels * cell.jacobian.transpose() * expected(parameters.noise_power) * cell.jacobian;
    for (int p = 0; p < parameters.count; ++p) {
      for (int q = 0; q < parameters.count; ++q) {
        sum.information(parameters.place[p], parameters.place[q]) += block(p, q);
        sum.curvature(parameters.place[p], parameters.place[q]) -=
            cell.by_log_noise * parameters.bend * parameters.curvature_sign[p] * parameters.curvature_sign[q];
      }
    }
  }
  return sum;
}

// Moves the mean of each taper into the level of its floor. The law stays the same.
void CentreTapers(const NoiseLayout& layout, Eigen::VectorXd& value) {
  const auto centre = [&](int first, int level) {
    if (first < 0) return;
    const double mean = value.segment(first, layout.beams).mean();
    value.segment(first, layout.beams).array() -= mean;
    value[level] += mean;
  };
  centre(layout.taper, layout.noise_db);
  centre(layout.after_taper, layout.after_db);
}

void SetPriors(NoiseSolution& solution, const NoiseFitOptions& options) {
  const NoiseLayout& layout = solution.layout;
  solution.prior_mean = solution.value;
  solution.prior_precision = Eigen::VectorXd::Zero(layout.count);
  const auto spread = [&](int place, double sigma, double mean) {
    if (place < 0) return;
    solution.prior_precision[place] = 1.0 / (sigma * sigma);
    solution.prior_mean[place] = mean;
  };
  const auto about_start = [&](int place, double sigma) {
    if (place >= 0) spread(place, sigma, solution.value[place]);
  };
  about_start(layout.noise_db, options.level_spread_db);
  about_start(layout.after_db, options.level_spread_db);
  about_start(layout.soft_db, options.level_spread_db);
  about_start(layout.span_db, options.level_spread_db);
  spread(layout.slope, options.slope_spread_db_per_m, 0.0);
  spread(layout.log_looks, 1.0, 0.0);
  spread(layout.logit_diffuse, kDiffuseLogitSpread, 0.0);
  for (int beam = 0; beam < layout.beams; ++beam) {
    if (layout.taper >= 0) spread(layout.taper + beam, options.taper_spread_db, 0.0);
    if (layout.after_taper >= 0) spread(layout.after_taper + beam, options.taper_spread_db, 0.0);
  }
}

// Adds priors and the gauge of the tapers to cost, score and information.
void AddPriors(const NoiseSolution& solution, Evaluation& sum) {
  const Eigen::VectorXd away = solution.value - solution.prior_mean;
  const Eigen::VectorXd pull = solution.prior_precision.cwiseProduct(away);
  sum.cost += 0.5 * away.dot(pull);
  sum.score -= pull;
  const bool with_information = sum.information.size() > 0;
  if (with_information) sum.information.diagonal() += solution.prior_precision;
  for (const int first : {solution.layout.taper, solution.layout.after_taper}) {
    if (first < 0) continue;
    const int beams = solution.layout.beams;
    const double mean = solution.value.segment(first, beams).mean();
    sum.cost += 0.5 * kTaperMeanPrecision * mean * mean;
    sum.score.segment(first, beams).array() -= kTaperMeanPrecision * mean / beams;
    if (with_information) {
      sum.information.block(first, first, beams, beams).array() += kTaperMeanPrecision / (beams * beams);
    }
  }
}

// Limits a step from `from`, centres the tapers, and clamps looks, diffuse share and span to their bounds.
Eigen::VectorXd Next(const NoiseLayout& layout, double min_looks, const Eigen::VectorXd& from,
                     const Eigen::VectorXd& step) {
  Eigen::VectorXd next = from + step.cwiseMin(kMaxStepDb).cwiseMax(-kMaxStepDb);
  CentreTapers(layout, next);
  const auto clamp = [&next](int place, double lower, double upper) {
    if (place >= 0) next[place] = std::clamp(next[place], lower, upper);
  };
  clamp(layout.log_looks, std::log(min_looks), std::log(kMaxNoiseLooks));
  clamp(layout.logit_diffuse, Logit(kMinDiffuseShare), Logit(kMaxDiffuseShare));
  clamp(layout.span_db, kLeastSpanDb, kMaxSpanDb);
  return next;
}

// Takes a parameter out of the next step.
void Hold(int place, Eigen::MatrixXd& information, Eigen::MatrixXd& curvature, Eigen::VectorXd& score) {
  information.row(place).setZero();
  information.col(place).setZero();
  curvature.row(place).setZero();
  curvature.col(place).setZero();
  information(place, place) = 1.0;
  score[place] = 0.0;
}

}  // namespace

Eigen::VectorXd NoiseScore(const NoiseSolution& solution, const NoiseCounts& counts, const NoiseCells& cells,
                           const std::vector<double>& weight, double absorption_db_per_m) {
  return Evaluate(solution.law, solution.layout, counts, cells, weight, absorption_db_per_m, false).score;
}

NoiseLevel FitNoiseLevel(const NoiseLaw& law, const NoiseCounts& counts, const NoiseCells& cells,
                         const std::vector<double>& weight, double absorption_db_per_m) {
  constexpr int kMaxSteps = 20;
  constexpr double kStepDb = 1e-5;
  NoiseLayout layout;  // both floors are one parameter
  layout.noise_db = 0;
  layout.after_db = 0;
  layout.count = 1;
  NoiseLevel level;
  for (int i = 0; i < kMaxSteps; ++i) {
    NoiseLaw moved = law;
    if (moved.receiver.noise_db) *moved.receiver.noise_db += level.level_db;
    if (moved.receiver.noise_after_gain_db) *moved.receiver.noise_after_gain_db += level.level_db;
    const Evaluation sum = Evaluate(moved, layout, counts, cells, weight, absorption_db_per_m, true);
    const double information = sum.information(0, 0);
    if (!(information > 0.0)) break;
    const double step_db = std::clamp(sum.score[0] / information, -kMaxStepDb, kMaxStepDb);
    level.level_db = std::clamp(level.level_db + step_db, -kMaxLevelDb, kMaxLevelDb);
    level.sigma_db = 1.0 / std::sqrt(information);
    if (std::abs(step_db) < kStepDb) break;
  }
  return level;
}

NoiseSolution SolveNoise(const NoiseLaw& start, bool fit_span, const NoiseCounts& counts,
                         const NoiseCells& cells, const std::vector<double>& weight,
                         const NoiseFitOptions& options) {
  NoiseSolution solution;
  solution.layout = MakeLayout(start, fit_span, FitsSoftDb(start.display, options), cells.beams());
  const NoiseLayout& layout = solution.layout;
  solution.value = ToVector(start, layout);
  SetPriors(solution, options);
  const double min_looks = MinNoiseLooks(start.speckle);
  const auto evaluate = [&](const Eigen::VectorXd& value, bool with_information) {
    solution.value = value;
    solution.law = FromVector(start, layout, value);
    Evaluation sum =
        Evaluate(solution.law, layout, counts, cells, weight, options.absorption_db_per_m, with_information);
    AddPriors(solution, sum);
    return sum;
  };

  Eigen::VectorXd best = solution.value;
  Evaluation at_best = evaluate(best, true);
  solution.cost_initial = at_best.cost;
  double damping = 1e-3;
  std::vector<double> gains;
  for (solution.iterations = 0; solution.iterations < options.max_iterations; ++solution.iterations) {
    // A parameter stays at its bound if the score points beyond it.
    const auto at_bound = [&](int place, double lower, double upper) {
      return place >= 0 && ((best[place] <= lower && at_best.score[place] < 0.0) ||
                            (best[place] >= upper && at_best.score[place] > 0.0));
    };
    solution.looks_at_bound =
        at_bound(layout.log_looks, std::log(min_looks), std::numeric_limits<double>::infinity());
    solution.diffuse_at_bound =
        at_bound(layout.logit_diffuse, Logit(kMinDiffuseShare), Logit(kMaxDiffuseShare));
    Eigen::MatrixXd information = at_best.information;
    Eigen::MatrixXd curvature = at_best.curvature;
    Eigen::VectorXd score = at_best.score;
    if (solution.looks_at_bound) Hold(layout.log_looks, information, curvature, score);
    if (solution.diffuse_at_bound) Hold(layout.logit_diffuse, information, curvature, score);
    if (gains.size() >= kLastSteps &&
        std::accumulate(gains.end() - kLastSteps, gains.end(), 0.0) < kGainedLittle) {
      solution.converged = true;
      break;
    }
    const std::optional<Eigen::VectorXd> step = Step(information, curvature, score, damping);
    if (step && damping <= kFreeDamping && 0.5 * score.dot(*step) < kNoiseConverged) {
      solution.converged = true;
      break;
    }
    bool better = false;
    if (step) {
      const Eigen::VectorXd next = Next(layout, min_looks, best, *step);
      if (WithinBounds(layout, next)) {
        Evaluation at_next = evaluate(next, true);
        better = std::isfinite(at_next.cost) && at_next.cost < at_best.cost;
        if (better) {
          if (damping <= kFreeDamping) {
            gains.push_back(at_best.cost - at_next.cost);
          } else {
            gains.clear();
          }
          best = next;
          at_best = std::move(at_next);
        }
      }
    }
    damping = better ? std::max(1e-6, damping * 0.1) : std::max(1e-4, damping * 10.0);
    if (damping > kMaxNoiseDamping) break;
  }
  at_best = evaluate(best, true);
  solution.cost = at_best.cost;
  solution.information = at_best.information;
  return solution;
}

}  // namespace sonarcal::calib
