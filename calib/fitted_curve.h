// A fitted backscatter curve with its uncertainty. The single values A .. F do not show it, because they
// trade off against each other.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calib/models/frame_model.h"

namespace sonarcal::calib {

// Half the width of a 95 % interval, in standard errors.
inline constexpr double kSigmasOf95 = 1.96;

struct FittedCurve {
  std::string material;
  std::vector<double> incidence_deg;
  std::vector<double> backscatter_db;
  std::vector<double> sigma_db;  // by linear propagation; +-kSigmasOf95 of it is a 95 % band
  // False where more than kOpenShare of the variance of the priors is left: they pull the curve, and the band
  // is right only as far as they are.
  std::vector<bool> determined = {};
  std::vector<double> truth_db = {};  // for simulated recordings; empty: unknown
};

// Returns the curves of the materials that `fitted` catalog entries belong to, for every degree of 0 .. 90.
// `covariance` is that of the coordinates of these entries, in their order.
std::vector<FittedCurve> FittedCurves(const std::vector<CatalogEntry>& catalog,
                                      const std::vector<std::string>& material_names,
                                      const ParameterValues& values, const std::vector<int>& fitted,
                                      const Eigen::MatrixXd& covariance);

}  // namespace sonarcal::calib
