#include "calib/fitted_curve.h"

#include <ceres/jet.h>

#include <array>
#include <cmath>

#include "sim/physics/gsab.h"

namespace sonarcal::calib {
namespace {

using Dual = ceres::Jet<double, 6>;

}  // namespace

std::vector<FittedCurve> FittedCurves(const std::vector<CatalogEntry>& catalog,
                                      const std::vector<std::string>& material_names,
                                      const ParameterValues& values, const std::vector<int>& fitted,
                                      const Eigen::MatrixXd& covariance) {
  std::vector<FittedCurve> curves;
  for (std::size_t material = 0; material < material_names.size(); ++material) {
    const auto is_of = [&](const CatalogEntry& entry) {
      return entry.group == ParameterGroup::kGsab && entry.material == static_cast<int>(material);
    };
    std::array<Dual, 6> gsab;
    for (std::size_t i = 0; i < catalog.size(); ++i) {
      if (is_of(catalog[i])) gsab[catalog[i].index] = Dual(values[i], catalog[i].index);
    }
    Eigen::MatrixXd of_coordinates = Eigen::MatrixXd::Zero(6, static_cast<Eigen::Index>(fitted.size()));
    for (std::size_t k = 0; k < fitted.size(); ++k) {
      const CatalogEntry& entry = catalog[fitted[k]];
      if (is_of(entry))
        of_coordinates(entry.index, static_cast<Eigen::Index>(k)) = entry.ValueSlope(values[fitted[k]]);
    }
    if (of_coordinates.isZero(0.0)) continue;
    FittedCurve curve;
    curve.material = material_names[material];
    for (int deg = 0; deg <= 90; ++deg) {
      const Dual level_db =
          sim::GsabDb(GsabParameters<Dual>{gsab[0], gsab[1], gsab[2], gsab[3], gsab[4], gsab[5]}, deg);
      const Eigen::VectorXd slope = of_coordinates.transpose() * level_db.v;
      curve.incidence_deg.push_back(deg);
      curve.backscatter_db.push_back(level_db.a);
      curve.sigma_db.push_back(std::sqrt(slope.dot(covariance * slope)));
    }
    curves.push_back(std::move(curve));
  }
  return curves;
}

}  // namespace sonarcal::calib
