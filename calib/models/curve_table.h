// Tables of a backscatter curve at incidence nodes with its derivatives by A to F, kCurveStride values per
// node, as sim/gathered/pixel_echoes.h sums them.
#pragma once

#include <ceres/jet.h>

#include <vector>

#include "core/types/parameters.h"
#include "sim/gathered/pixel_echoes.h"

namespace sonarcal::calib {

using CurveDual = ceres::Jet<double, sim::kCurveTerms - 1>;

inline GsabParameters<CurveDual> WithDerivatives(const GsabParameters<double>& g) {
  return {CurveDual(g.a, 0), CurveDual(g.b_deg, 1), CurveDual(g.c, 2),
          CurveDual(g.d, 3), CurveDual(g.e, 4),     CurveDual(g.f_deg, 5)};
}

// Appends a node. `spare` fills the rest of its values.
inline void AppendNode(const CurveDual& value, std::vector<double>& table, double spare = 0.0) {
  table.push_back(value.a);
  table.insert(table.end(), value.v.begin(), value.v.end());
  table.resize(table.size() + sim::kCurveStride - sim::kCurveTerms, spare);
}

}  // namespace sonarcal::calib
