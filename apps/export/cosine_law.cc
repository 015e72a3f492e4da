#include "apps/export/cosine_law.h"

#include <algorithm>
#include <cmath>

#include "core/types/units.h"
#include "sim/physics/gsab.h"

namespace sonarcal::exporting {

CosineLaw FitCosineLaw(const GsabParameters<double>& gsab, double exponent) {
  const auto excess_db = [&](double degree) {
    return sim::GsabDb(gsab, degree) - exponent * DbFromPower(std::cos(RadFromDeg(degree)));
  };
  const int angles = static_cast<int>(kCosineLawMaxDeg) + 1;
  double sum_db = 0.0;
  for (int degree = 0; degree < angles; ++degree) sum_db += excess_db(degree);
  const double mean_db = sum_db / angles;
  CosineLaw law{.coefficient = PowerFromDb(mean_db), .exponent = exponent};
  for (int degree = 0; degree < angles; ++degree) {
    law.worst_db = std::max(law.worst_db, std::abs(excess_db(degree) - mean_db));
  }
  return law;
}

}  // namespace sonarcal::exporting
