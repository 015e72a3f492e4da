#include "calib/curve_alternatives.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>

#include "calib/fit_starts.h"
#include "calib/models/one_curve_model.h"
#include "calib/solve.h"

namespace sonarcal::calib {
namespace {

// Number of pixels of all frames together for the search of alternatives.
constexpr std::size_t kCoarsePixels = 40'000;
constexpr int kExchangeIterations = 40;
constexpr int kProfileIterations = 12;
constexpr double kCostTolerance = 0.02;  // nats
constexpr std::size_t kMaxBetter = 2;

// An optimum is nearly as good if the odds against it are less than a hundred to one, in nats.
const double kAlikeNats = std::log(100.0);
// Standard errors by which a parameter of such an optimum may differ and still count as the same.
constexpr double kSameSigmas = 1.0;
constexpr double kProfileSigmas = 2.5;
// A profile that reaches a bound before this fraction of its step is not conclusive.
constexpr double kMinReach = 0.3;
// If a profile rises by less than this fraction of the parabola's rise, no standard error describes it.
constexpr double kMinRise = 0.3;

using Curve = std::array<double, kGsabMembers>;  // A, B, C, D, E, F

// Half-width of the Gaussian nearest to cos^d, and the exponent of the cosine nearest to a Gaussian.
double WidthOfExponent(double d) {
  return 180.0 / std::numbers::pi / std::sqrt(std::max(d, 0.3));
}
double ExponentOfWidth(double width_deg) {
  return std::pow(180.0 / std::numbers::pi / width_deg, 2);
}

// Curves similar to this one, with exchanged bumps.
std::vector<Curve> Exchanged(const Curve& curve) {
  constexpr double kWeak = 0.3;
  const auto [a, b, c_or_none, d, e_or_none, f] = curve;
  // A bump that is as good as absent would not grow: a solver moves the logarithms of amplitudes.
  const double c = std::max(c_or_none, kWeak * e_or_none);
  const double e = std::max(e_or_none, kWeak * c_or_none);
  return {
      // The wide Gaussian takes the narrow one's place, the cosine the wide one's.
      {e, f, kWeak * c, 1.5, c, WidthOfExponent(d)},
      // The cosine takes the wide Gaussian's place.
      {a, b, e, ExponentOfWidth(f), kWeak * c, f},
      // As before, and the wide Gaussian takes the narrow one's place.
      {kWeak * a, 0.5 * b, e, ExponentOfWidth(f), a, b},
      // The narrow Gaussian splits into two; so does the wide one.
      {kWeak * a, 0.5 * b, c, d, a, b},
      {e, f, c, d, kWeak * e, 2.0 * f},
  };
}

struct Optimum {
  double cost = 0.0;
  ParameterValues values;
};

// An optimum of one material's curve. The costs of two materials are those of different pixels, so only their
// falls can be compared.
struct BetterOptimum {
  int material = 0;
  double fall = 0.0;  // of the cost, from the tested point
  ParameterValues values;
};

// The optima whose cost falls most, without those that another one of the same material equals.
std::vector<ParameterValues> BestOf(std::vector<BetterOptimum> better) {
  std::ranges::sort(better, std::ranges::greater(), &BetterOptimum::fall);
  std::vector<BetterOptimum> best;
  for (BetterOptimum& optimum : better) {
    const bool is_known = std::ranges::any_of(best, [&](const BetterOptimum& known) {
      return known.material == optimum.material && known.fall - optimum.fall < kBetterCurveNats;
    });
    if (!is_known && best.size() < kMaxBetter) best.push_back(std::move(optimum));
  }
  std::vector<ParameterValues> values;
  for (BetterOptimum& optimum : best) values.push_back(std::move(optimum.values));
  return values;
}

// The free entries of one material's curve.
struct MaterialEntries {
  int material = 0;
  int first = 0;            // entry of A; the others follow
  std::vector<int> free;    // entries
  std::vector<int> inside;  // entries that are not at a bound, as indices into FittedPoint::interior
};

class Search {
 public:
  Search(const FrameModel& model, const std::vector<CatalogEntry>& catalog, const FittedPoint& point,
         const std::function<bool()>& stop)
      : catalog_(catalog),
        point_(point),
        stop_(stop),
        fine_(model),
        pixels_per_cell_(model.speckle_cell().pixels()),
        coarse_(model.CoarseAbout(point.values, kCoarsePixels)),
        whole_(coarse_ != nullptr ? *coarse_ : model) {
    result_.widening.assign(catalog.size(), 1.0);
  }

  CurveAlternatives Run(const std::vector<std::string>& material_names) {
    std::vector<BetterOptimum> better;
    for (const MaterialEntries& material : Materials()) {
      if (material.inside.empty()) continue;
      const std::unique_ptr<OneCurveModel> of_curve = whole_.OfCurve(material.material, point_.values);
      model_ = of_curve != nullptr ? of_curve.get() : &whole_;
      guide_ = nullptr;
      const std::optional<Optimum> base = Solve(material.free, point_.values, kExchangeIterations);
      if (!base) continue;
      const std::unique_ptr<FrameModel> quadratic =
          of_curve != nullptr ? of_curve->Quadratic(base->values) : nullptr;
      guide_ = quadratic.get();
      const Eigen::MatrixXd information = Information(material, base->values);
      if (!(information.diagonal().minCoeff() > 0.0)) continue;
      std::vector<bool> open(catalog_.size(), false);
      if (MayBePlateau(material) && LiesLower(*base)) better.push_back(Better(material, *base));
      TryExchanges(material, *base, DesignEffect(material, information), open, better);
      TryProfiles(material, *base, information, open);
      Report(material, material_names[material.material], open);
    }
    result_.better = BestOf(std::move(better));
    return std::move(result_);
  }

 private:
  std::vector<MaterialEntries> Materials() const {
    std::vector<MaterialEntries> materials;
    for (std::size_t i = 0; i + kGsabMembers <= catalog_.size(); ++i) {
      if (catalog_[i].group != ParameterGroup::kGsab || catalog_[i].index != 0) continue;
      MaterialEntries material{
          .material = catalog_[i].material, .first = static_cast<int>(i), .free = {}, .inside = {}};
      const auto is_of = [&](int entry) {
        return entry >= material.first && entry < material.first + kGsabMembers;
      };
      std::copy_if(point_.free.begin(), point_.free.end(), std::back_inserter(material.free), is_of);
      for (std::size_t k = 0; k < point_.interior.size(); ++k) {
        if (is_of(point_.interior[k])) material.inside.push_back(static_cast<int>(k));
      }
      materials.push_back(std::move(material));
    }
    return materials;
  }

  std::optional<Optimum> Solve(const std::vector<int>& active, const ParameterValues& start,
                               int max_iterations) const {
    FitState state{.active = active, .values = start};
    if (!active.empty()) {
      const SolveLimits limits{.least_fall = kCostTolerance, .max_iterations = max_iterations};
      if (guide_ != nullptr) SolveFit(*guide_, catalog_, limits, stop_, state);
      const SolveSummary summary = SolveFit(*model_, catalog_, limits, stop_, state);
      if (!summary.usable) return std::nullopt;
    }
    const double cost = CostOf(state.values);
    if (!std::isfinite(cost)) return std::nullopt;
    return Optimum{cost, std::move(state.values)};
  }

  // With priors.
  double CostOf(const ParameterValues& values) const {
    return CostAt(*model_, values, model_->frame_count()) + CostOfPriors(catalog_, point_.free, values);
  }

  BetterOptimum Better(const MaterialEntries& material, const Optimum& optimum) const {
    return {.material = material.material,
            .fall = CostOf(point_.values) - optimum.cost,
            .values = optimum.values};
  }

  std::vector<bool> Flags(const std::vector<int>& entries) const {
    std::vector<bool> flags(catalog_.size(), false);
    for (const int entry : entries) flags[entry] = true;
    return flags;
  }

  // True if an amplitude or width has no effect at the tested point.
  bool MayBePlateau(const MaterialEntries& material) const {
    return material.inside.size() < material.free.size() || std::ranges::any_of(material.inside, [&](int k) {
             return !(Sigma(k) < catalog_[point_.interior[k]].typical_step);
           });
  }

  // True if the solver, which started at the tested point, has left a plateau: if blocks of pixels and all
  // pixels agree that the cost fell.
  bool LiesLower(const Optimum& base) const {
    if (base.cost > CostOf(point_.values) - kAlikeNats * pixels_per_cell_) return false;
    return coarse_ == nullptr || CostAt(fine_, base.values, fine_.frame_count()) <
                                     CostAt(fine_, point_.values, fine_.frame_count());
  }

  double Sigma(int inside) const { return std::sqrt(point_.covariance(inside, inside)); }

  // Information matrix of the material's entries that are not at a bound, including their priors.
  Eigen::MatrixXd Information(const MaterialEntries& material, const ParameterValues& values) const {
    std::vector<int> active;
    for (const int k : material.inside) active.push_back(point_.interior[k]);
    const NormalEquations equations =
        Accumulate(*model_, catalog_, {.active = active, .values = values}, FitOptions());
    Eigen::MatrixXd information = equations.information;
    information.diagonal() += equations.prior;
    return information;
  }

  // Factor by which the variances of the fit exceed those of independent pixels. A nat of cost counts less by
  // this factor. Geometric mean over the entries of the material, at least 1.
  double DesignEffect(const MaterialEntries& material, const Eigen::MatrixXd& information) const {
    const Eigen::MatrixXd covariance = point_.covariance(material.inside, material.inside);
    const Eigen::LDLT<Eigen::MatrixXd> of_covariance(covariance);
    const Eigen::LDLT<Eigen::MatrixXd> of_information(information);
    const double logarithm = of_covariance.vectorD().array().abs().log().sum() +
                             of_information.vectorD().array().abs().log().sum();
    const double effect = std::exp(logarithm / static_cast<double>(material.inside.size()));
    return std::isfinite(effect) ? std::max(1.0, effect) : 1.0;
  }

  ParameterValues With(const MaterialEntries& material, const Curve& curve) const {
    ParameterValues values = point_.values;
    for (const int entry : material.free)
      values[entry] = std::clamp(curve[entry - material.first], catalog_[entry].lower, catalog_[entry].upper);
    return values;
  }

  void TryExchanges(const MaterialEntries& material, const Optimum& base, double design_effect,
                    std::vector<bool>& open, std::vector<BetterOptimum>& better) const {
    if (material.free.size() < 2) return;
    Curve curve{};
    std::copy_n(point_.values.begin() + material.first, kGsabMembers, curve.begin());
    std::vector<Curve> starts = Exchanged(curve);
    for (int shape = 1; shape <= kStartShapeCount; ++shape)
      starts.push_back(AtLevelOf(curve, StartCurve(shape)));
    for (const Curve& start : starts) {
      std::optional<Optimum> other = Solve(material.free, With(material, start), kExchangeIterations);
      if (!other || other->cost - base.cost > kAlikeNats * design_effect) continue;
      OrderGaussians(catalog_, Flags(material.free), other->values);
      for (const int k : material.inside) {
        const int entry = point_.interior[k];
        const double moved = catalog_[entry].CoordinateFromValue(other->values[entry]) -
                             catalog_[entry].CoordinateFromValue(base.values[entry]);
        if (std::abs(moved) > kSameSigmas * Sigma(k)) open[entry] = true;
      }
      if (other->cost < base.cost - kBetterCurveNats) better.push_back(Better(material, *other));
    }
  }

  void TryProfiles(const MaterialEntries& material, const Optimum& base, const Eigen::MatrixXd& information,
                   std::vector<bool>& open) {
    const Eigen::MatrixXd conditional = information.inverse();
    const auto n = static_cast<Eigen::Index>(material.inside.size());
    for (Eigen::Index k = 0; k < n; ++k) {
      const int entry = point_.interior[material.inside[k]];
      if (open[entry] || !(conditional(k, k) > 0.0) || !std::isfinite(Sigma(material.inside[k]))) continue;
      double wide = 0.0;
      for (const double side : {-1.0, 1.0}) {
        const double rise = RiseOverParabola(material, base, conditional, k, side);
        if (rise < kMinRise) open[entry] = true;
        wide += 0.5 / std::sqrt(std::max(rise, kMinRise));
      }
      result_.widening[entry] = std::max(1.0, wide);
    }
  }

  // Rise of the cost if entry k is fixed away from its optimum and the other entries of the material are
  // fitted, divided by the rise that the curvature at the optimum predicts. 1 if there is no room for the
  // step.
  double RiseOverParabola(const MaterialEntries& material, const Optimum& base,
                          const Eigen::MatrixXd& conditional, Eigen::Index k, double side) const {
    const int held = point_.interior[material.inside[k]];
    const double step = side * kProfileSigmas * Sigma(material.inside[k]);
    ParameterValues start = base.values;
    for (Eigen::Index i = 0; i < conditional.rows(); ++i) {
      const int entry = point_.interior[material.inside[i]];
      const CatalogEntry& of = catalog_[entry];
      const double moved =
          of.CoordinateFromValue(base.values[entry]) + step * conditional(i, k) / conditional(k, k);
      start[entry] = std::clamp(of.ValueFromCoordinate(moved), of.lower, of.upper);
    }
    const CatalogEntry& of = catalog_[held];
    const double moved = of.CoordinateFromValue(start[held]) - of.CoordinateFromValue(base.values[held]);
    if (std::abs(moved) < kMinReach * std::abs(step)) return 1.0;
    std::vector<int> others = material.free;
    std::erase(others, held);
    const std::optional<Optimum> profile = Solve(others, start, kProfileIterations);
    if (!profile) return 1.0;
    return (profile->cost - base.cost) / (0.5 * moved * moved / conditional(k, k));
  }

  void Report(const MaterialEntries& material, const std::string& name, const std::vector<bool>& open) {
    std::vector<std::string> members;
    for (const int entry : material.free) {
      if (!open[entry]) continue;
      result_.not_separate.push_back(entry);
      members.push_back(catalog_[entry].name.substr(catalog_[entry].name.rfind('.') + 1));
    }
    if (members.empty()) return;
    std::string list = members.back();
    if (members.size() > 1) {
      members.pop_back();
      list = fmt::format("{} and {}", fmt::join(members, ", "), list);
    }
    result_.sentences.push_back(
        fmt::format("Not determined separately: {} {} (curves with other values fit equally well); the "
                    "curve itself is determined",
                    name, list));
  }

  const std::vector<CatalogEntry>& catalog_;
  const FittedPoint& point_;
  const std::function<bool()>& stop_;
  const FrameModel& fine_;
  double pixels_per_cell_;
  std::unique_ptr<FrameModel> coarse_;
  const FrameModel& whole_;
  const FrameModel* model_ = nullptr;  // for the material that is tested
  const FrameModel* guide_ = nullptr;  // approximation of it, or none
  CurveAlternatives result_;
};

}  // namespace

CurveAlternatives FindCurveAlternatives(const FrameModel& model, const std::vector<CatalogEntry>& catalog,
                                        const FittedPoint& point, const std::function<bool()>& stop) {
  return Search(model, catalog, point, stop).Run(model.material_names());
}

bool OrderGaussians(const std::vector<CatalogEntry>& catalog, const std::vector<bool>& free,
                    ParameterValues& values) {
  bool exchanged = false;
  for (std::size_t a = 0; a + kGsabMembers <= catalog.size(); ++a) {
    if (catalog[a].group != ParameterGroup::kGsab || catalog[a].index != 0) continue;
    const std::size_t b = a + 1;
    const std::size_t e = a + 4;
    const std::size_t f = a + 5;
    const auto fits = [&](std::size_t from, std::size_t to) {
      return free[to] && values[from] >= catalog[to].lower && values[from] <= catalog[to].upper;
    };
    if (values[b] <= values[f] || !fits(a, e) || !fits(e, a) || !fits(b, f) || !fits(f, b)) continue;
    std::swap(values[a], values[e]);
    std::swap(values[b], values[f]);
    exchanged = true;
  }
  return exchanged;
}

}  // namespace sonarcal::calib
