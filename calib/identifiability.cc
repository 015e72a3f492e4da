#include "calib/identifiability.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <span>
#include <utility>

#include "core/types/error.h"
#include "core/types/units.h"

namespace sonarcal::calib {
namespace {

// Names the parameters with at least this fraction of the largest component of a direction.
constexpr double kNamedShare = 0.3;

// Number of parameters that a reader can follow in one sentence.
constexpr std::size_t kMaxNamed = 4;

// Returns the parameters that take part, the largest component first.
std::vector<int> Participants(const Eigen::VectorXd& direction) {
  std::vector<int> order(direction.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](int a, int b) { return std::abs(direction(a)) > std::abs(direction(b)); });
  const double least = kNamedShare * std::abs(direction(order[0]));
  std::erase_if(order, [&](int i) { return std::abs(direction(i)) < least; });
  return order;
}

// Makes the text "a with the opposite of b". Names the first kMaxNamed of `participants`.
std::string MovingTogether(const Eigen::VectorXd& direction, const std::vector<int>& participants,
                           const std::vector<std::string>& names) {
  std::string text;
  const std::size_t named = std::min(participants.size(), kMaxNamed);
  for (const int i : std::span(participants).first(named)) {
    const bool same = direction(i) * direction(participants[0]) > 0.0;
    text += fmt::format("{}{}{}", text.empty() ? "" : " with ", same ? "" : "the opposite of ", names[i]);
  }
  if (named < participants.size()) text += fmt::format(" and {} more", participants.size() - named);
  return text;
}

// Returns the best-determined combination of parameters that move together: a product of powers if all are
// logarithms, otherwise a sum. Empty if no combination is determined much better than by the prior.
std::string KnownAllTheSame(const Eigen::MatrixXd& covariance,
                            const std::vector<NamedCoordinate>& coordinates) {
  constexpr double kKnownShare = 0.1;
  const auto n = static_cast<Eigen::Index>(coordinates.size());
  Eigen::VectorXd step(n);
  for (Eigen::Index i = 0; i < n; ++i) step(i) = coordinates[i].step;
  const Eigen::MatrixXd scaled =
      step.cwiseInverse().asDiagonal() * covariance * step.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(scaled);
  if (solver.eigenvalues()(0) > kKnownShare) return {};
  Eigen::VectorXd factor = solver.eigenvectors().col(0).cwiseQuotient(step);
  Eigen::Index largest = 0;
  factor.cwiseAbs().maxCoeff(&largest);
  factor /= factor(largest);
  const double sigma = std::sqrt(factor.dot(covariance * factor));
  const bool product =
      std::all_of(coordinates.begin(), coordinates.end(), [](const auto& c) { return c.logarithmic; });
  std::string text;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (std::abs(factor(i)) < 0.01) continue;
    const std::string& name = coordinates[i].name;
    if (product) {
      text += fmt::format("{}{}^{:.2f}", text.empty() ? "" : " ", name, factor(i));
    } else {
      const std::string of = coordinates[i].logarithmic ? fmt::format("ln({})", name) : name;
      text += fmt::format("{}{:.2f} {}", text.empty() ? "" : " + ", factor(i), of);
    }
  }
  if (product) return fmt::format("only 10 log10({}) is known, to {:.2g} dB", text, kDbPerNeper * sigma);
  return fmt::format("only {} is known, to {:.2g}", text, sigma);
}

// Inverse of the information with priors. Parameters differ by many orders of magnitude, so it is the inverse
// of a matrix with unit diagonal, with the factors of its rows and columns.
struct Inverse {
  Eigen::VectorXd scale;
  Eigen::MatrixXd scaled;

  Eigen::MatrixXd full() const { return scale.asDiagonal() * scaled * scale.asDiagonal(); }
};

Inverse InverseWithPriors(const NormalEquations& equations) {
  Eigen::MatrixXd information = equations.information;
  if (equations.prior.size() > 0) information.diagonal() += equations.prior;
  const Eigen::VectorXd scale = information.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd unit = scale.asDiagonal() * information * scale.asDiagonal();
  return {.scale = scale, .scaled = unit.ldlt().solve(Eigen::MatrixXd::Identity(unit.rows(), unit.cols()))};
}

// Returns the block without one parameter; those behind it move up.
NormalEquations::Block Without(const NormalEquations::Block& block, int parameter) {
  std::vector<int> kept;
  NormalEquations::Block without;
  for (std::size_t k = 0; k < block.columns.size(); ++k) {
    const int column = block.columns[k];
    if (column == parameter) continue;
    kept.push_back(static_cast<int>(k));
    without.columns.push_back(column < parameter ? column : column - 1);
  }
  without.information = block.information(kept, kept);
  without.score = block.score(kept);
  return without;
}

}  // namespace

void AddBlock(const NormalEquations::Block& added, NormalEquations::Block& block) {
  if (added.columns != block.columns) {
    std::vector<int> all;
    std::ranges::set_union(added.columns, block.columns, std::back_inserter(all));
    const auto size = static_cast<Eigen::Index>(all.size());
    NormalEquations::Block sum{.columns = all,
                               .information = Eigen::MatrixXd::Zero(size, size),
                               .score = Eigen::VectorXd::Zero(size)};
    const auto add = [&](const NormalEquations::Block& part) {
      std::vector<int> places;
      for (const int column : part.columns)
        places.push_back(static_cast<int>(std::ranges::lower_bound(all, column) - all.begin()));
      sum.information(places, places) += part.information;
      sum.score(places) += part.score;
    };
    add(added);
    add(block);
    block = std::move(sum);
    return;
  }
  block.information += added.information;
  block.score += added.score;
}

NormalEquations HoldParameter(const NormalEquations& equations, int parameter) {
  std::vector<int> kept;
  for (int i = 0; i < equations.information.rows(); ++i) {
    if (i != parameter) kept.push_back(i);
  }
  NormalEquations held = equations;
  held.information = equations.information(kept, kept);
  if (equations.prior.size() > 0) held.prior = equations.prior(kept);
  for (NormalEquations::Block& block : held.blocks) block = Without(block, parameter);
  for (Eigen::VectorXd& score : held.numerical) score = Eigen::VectorXd(score(kept));
  return held;
}

std::optional<OpenDirection> LeastDetermined(const NormalEquations& equations,
                                             const Eigen::VectorXd& typical_step,
                                             const std::vector<std::string>& names) {
  const Eigen::Index n = equations.information.rows();
  SONARCAL_CHECK(n == typical_step.size() && n == static_cast<Eigen::Index>(names.size()),
                 "{} parameters, {} names", n, names.size());
  if (n == 0) return std::nullopt;
  const double variance =
      equations.residual_square / static_cast<double>(std::max<long>(1, equations.residual_count - n));
  const Eigen::MatrixXd scaled =
      typical_step.asDiagonal() * equations.information * typical_step.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(scaled);
  const double eigenvalue = std::max(0.0, solver.eigenvalues()(0));  // ascending
  const Eigen::VectorXd direction = solver.eigenvectors().col(0);
  // Rounding alone gives eigenvalues of this size to a singular matrix.
  const double rounding = 1e-12 * std::max(0.0, solver.eigenvalues()(n - 1));
  const double sigma_of_largest = std::sqrt(variance / eigenvalue) * direction.cwiseAbs().maxCoeff();
  if (eigenvalue > rounding && sigma_of_largest <= 1.0) return std::nullopt;

  const std::vector<int> participants = Participants(direction);
  return OpenDirection{participants[0], MovingTogether(direction, participants, names)};
}

Eigen::MatrixXd JackknifeCovariance(const NormalEquations& equations) {
  const Eigen::Index n = equations.information.rows();
  const Inverse inverse = InverseWithPriors(equations);
  // Without block b, whose rows and columns E are few: (A - E B E^T)^-1 E s = A^-1 E (I - B E^T A^-1 E)^-1 s.
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(n, n);
  for (const NormalEquations::Block& block : equations.blocks) {
    const std::vector<int>& columns = block.columns;
    const Eigen::VectorXd scale = inverse.scale(columns);
    const auto m = static_cast<Eigen::Index>(columns.size());
    const Eigen::MatrixXd left = Eigen::MatrixXd::Identity(m, m) - scale.asDiagonal() * block.information *
                                                                       scale.asDiagonal() *
                                                                       inverse.scaled(columns, columns);
    const Eigen::VectorXd score = left.partialPivLu().solve(scale.cwiseProduct(block.score));
    const Eigen::VectorXd change = inverse.scaled(Eigen::all, columns) * score;
    covariance.selfadjointView<Eigen::Lower>().rankUpdate(change);
  }
  covariance = inverse.scale.asDiagonal() * Eigen::MatrixXd(covariance.selfadjointView<Eigen::Lower>()) *
               inverse.scale.asDiagonal();
  const auto count = static_cast<double>(equations.blocks.size());
  covariance *= equations.variance_factor * (count - 1.0) / count;
  if (equations.prior.size() > 0) {
    const Eigen::MatrixXd of_prior = inverse.full() * equations.prior.cwiseSqrt().asDiagonal();
    covariance += of_prior * of_prior.transpose();
  }
  for (const Eigen::VectorXd& score : equations.numerical) {
    const Eigen::VectorXd change = inverse.full() * score;
    covariance += change * change.transpose();
  }
  return covariance;
}

double StudentFactor(double degrees_of_freedom) {
  constexpr double kMin = 2.0;
  constexpr double z = 1.959964;
  constexpr double z2 = z * z;
  const double freedom = degrees_of_freedom;
  if (!(freedom >= kMin)) return std::numeric_limits<double>::infinity();
  // Expands the quantile of Student's law about the normal one (Abramowitz & Stegun 26.7.5).
  return 1.0 + (z2 + 1.0) / (4.0 * freedom) + (5.0 * z2 * z2 + 16.0 * z2 + 3.0) / (96.0 * freedom * freedom) +
         (3.0 * z2 * z2 * z2 + 19.0 * z2 * z2 + 17.0 * z2 - 15.0) / (384.0 * std::pow(freedom, 3));
}

Eigen::VectorXd StudentFactors(const NormalEquations& equations) {
  const Eigen::Index n = equations.information.rows();
  const Eigen::MatrixXd inverse = InverseWithPriors(equations).full();
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(n);
  Eigen::VectorXd square = Eigen::VectorXd::Zero(n);
  for (const NormalEquations::Block& block : equations.blocks) {
    const Eigen::MatrixXd columns = inverse(Eigen::all, block.columns);
    const Eigen::VectorXd share = (columns * block.information).cwiseProduct(columns).rowwise().sum();
    sum += share;
    square += share.cwiseAbs2();
  }
  return sum.cwiseAbs2().cwiseQuotient(square).unaryExpr(&StudentFactor);
}

Eigen::MatrixXd WidenedCovariance(const Eigen::MatrixXd& covariance, const Eigen::VectorXd& factors) {
  const Eigen::VectorXd finite =
      factors.unaryExpr([](double factor) { return std::isfinite(factor) ? factor : 1.0; });
  return finite.asDiagonal() * covariance * finite.asDiagonal();
}

std::vector<std::string> OpenDirections(const Eigen::MatrixXd& covariance,
                                        const std::vector<NamedCoordinate>& coordinates) {
  const auto n = static_cast<Eigen::Index>(coordinates.size());
  SONARCAL_CHECK(covariance.rows() == n, "a covariance of {} for {} coordinates", covariance.rows(), n);
  std::vector<std::string> words;
  if (n == 0) return words;
  Eigen::VectorXd inverse_step(n);
  std::vector<std::string> names;
  for (Eigen::Index i = 0; i < n; ++i) {
    inverse_step(i) = 1.0 / coordinates[i].step;
    names.push_back(coordinates[i].name);
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(inverse_step.asDiagonal() * covariance *
                                                              inverse_step.asDiagonal());
  for (Eigen::Index k = n; k-- > 0 && solver.eigenvalues()(k) > kOpenShare;) {
    const Eigen::VectorXd direction = solver.eigenvectors().col(k);
    const std::vector<int> participants = Participants(direction);
    std::string text = MovingTogether(direction, participants, names);
    if (participants.size() > 1 && participants.size() <= kMaxNamed) {
      std::vector<NamedCoordinate> of;
      for (const int i : participants) of.push_back(coordinates[i]);
      const std::string known = KnownAllTheSame(covariance(participants, participants), of);
      if (!known.empty()) text += ": " + known;
    }
    words.push_back(text);
  }
  return words;
}

Eigen::MatrixXd CorrelationFromCovariance(const Eigen::MatrixXd& covariance) {
  const Eigen::VectorXd inverse_sigma = covariance.diagonal().cwiseSqrt().cwiseInverse();
  return inverse_sigma.asDiagonal() * covariance * inverse_sigma.asDiagonal();
}

}  // namespace sonarcal::calib
