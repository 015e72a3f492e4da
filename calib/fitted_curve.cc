#include "calib/fitted_curve.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "calib/models/curve_table.h"
#include "sim/physics/gsab.h"

namespace sonarcal::calib {
namespace {

// The entries of a material's curve.
struct CurveEntries {
  std::array<double, kGsabMembers> fitted = {};          // values, of fixed entries too
  std::array<double, kGsabMembers> at_priors = {};       // as above, with the centres of the priors
  std::array<double, kGsabMembers> prior_variance = {};  // of the coordinates
  std::array<int, kGsabMembers> place = {};              // among the fitted entries; -1: not fitted
  std::array<const CatalogEntry*, kGsabMembers> entry = {};
};

CurveEntries EntriesOf(int material, const std::vector<CatalogEntry>& catalog, const ParameterValues& values,
                       const std::vector<int>& fitted) {
  CurveEntries of;
  for (std::size_t i = 0; i < catalog.size(); ++i) {
    const CatalogEntry& entry = catalog[i];
    if (entry.group != ParameterGroup::kGsab || entry.material != material) continue;
    const auto place = std::ranges::find(fitted, static_cast<int>(i));
    const bool is_fitted = place != fitted.end();
    const int k = entry.index;
    of.entry[k] = &entry;
    of.place[k] = is_fitted ? static_cast<int>(place - fitted.begin()) : -1;
    of.fitted[k] = values[i];
    of.at_priors[k] =
        is_fitted && entry.prior ? entry.ValueFromCoordinate(entry.prior->coordinate) : values[i];
    of.prior_variance[k] =
        entry.prior ? entry.prior->sigma * entry.prior->sigma : std::numeric_limits<double>::infinity();
  }
  return of;
}

// Level of a curve, and its slopes by the coordinates of A to F.
struct SlopedLevel {
  double level_db = 0.0;
  Eigen::Matrix<double, kGsabMembers, 1> slope;
};

SlopedLevel LevelAt(const std::array<double, kGsabMembers>& g, const CurveEntries& of, double incidence_deg) {
  const CurveDual level_db =
      sim::GsabDb(WithDerivatives({g[0], g[1], g[2], g[3], g[4], g[5]}), incidence_deg);
  SlopedLevel at{.level_db = level_db.a, .slope = level_db.v};
  for (int k = 0; k < kGsabMembers; ++k) at.slope(k) *= of.place[k] < 0 ? 0.0 : of.entry[k]->ValueSlope(g[k]);
  return at;
}

double VarianceOfPriors(const CurveEntries& of, const SlopedLevel& at) {
  double variance = 0.0;
  for (int k = 0; k < kGsabMembers; ++k) {
    if (at.slope(k) != 0.0) variance += at.slope(k) * at.slope(k) * of.prior_variance[k];
  }
  return variance;
}

}  // namespace

std::vector<FittedCurve> FittedCurves(const std::vector<CatalogEntry>& catalog,
                                      const std::vector<std::string>& material_names,
                                      const ParameterValues& values, const std::vector<int>& fitted,
                                      const Eigen::MatrixXd& covariance) {
  std::vector<FittedCurve> curves;
  for (std::size_t material = 0; material < material_names.size(); ++material) {
    const CurveEntries of = EntriesOf(static_cast<int>(material), catalog, values, fitted);
    std::vector<int> columns;
    std::vector<int> places;
    for (int k = 0; k < kGsabMembers; ++k) {
      if (of.entry[k] == nullptr || of.place[k] < 0) continue;
      columns.push_back(k);
      places.push_back(of.place[k]);
    }
    if (columns.empty()) continue;
    const Eigen::MatrixXd of_curve = covariance(places, places);
    FittedCurve curve;
    curve.material = material_names[material];
    for (int deg = 0; deg <= 90; ++deg) {
      const SlopedLevel at = LevelAt(of.fitted, of, deg);
      const Eigen::VectorXd slope = at.slope(columns);
      const double variance = slope.dot(of_curve * slope);
      curve.incidence_deg.push_back(deg);
      curve.backscatter_db.push_back(at.level_db);
      curve.sigma_db.push_back(std::sqrt(variance));
      // On the steep side of a peak its width moves the level by far more than elsewhere.
      const double of_priors =
          std::min(VarianceOfPriors(of, at), VarianceOfPriors(of, LevelAt(of.at_priors, of, deg)));
      curve.determined.push_back(variance <= kOpenShare * of_priors);
    }
    curves.push_back(std::move(curve));
  }
  return curves;
}

}  // namespace sonarcal::calib
