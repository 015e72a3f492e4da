#include "calib/fit_starts.h"

#include <algorithm>
#include <array>

#include "calib/problem_builder.h"
#include "core/types/units.h"
#include "sim/physics/gsab.h"

namespace sonarcal::calib {
namespace {

// Narrow, medium and wide peaks: A, B, C, D, E, F.
constexpr std::array<std::array<double, 6>, kStartShapeCount> kStartShapes = {
    {{100.0, 2.0, 1.0, 1.0, 10.0, 10.0}, {30.0, 5.0, 1.0, 1.5, 5.0, 16.0}, {10.0, 8.0, 1.0, 2.0, 3.0, 30.0}}};

}  // namespace

int FindEntry(const std::vector<CatalogEntry>& catalog, const std::string& name) {
  for (std::size_t i = 0; i < catalog.size(); ++i) {
    if (catalog[i].name == name) return static_cast<int>(i);
  }
  return -1;
}

void MoveInsideBounds(const std::vector<CatalogEntry>& catalog, const std::vector<bool>& free,
                      ParameterValues& values) {
  for (std::size_t i = 0; i < catalog.size(); ++i) {
    if (free[i]) values[i] = std::clamp(values[i], catalog[i].lower, catalog[i].upper);
  }
}

ParameterValues SearchLevel(const FrameModel& model, const std::vector<CatalogEntry>& catalog,
                            const std::vector<bool>& free, const ParameterValues& start) {
  // Ignores materials that no frame shows: they are not determined, and nothing depends on them.
  bool amplitudes_free = true;
  for (std::size_t i = 0; i < catalog.size(); ++i) {
    if (IsAmplitude(catalog[i]) && model.ShowsMaterial(catalog[i].material))
      amplitudes_free = amplitudes_free && free[i];
  }
  const int db_min = FindEntry(catalog, "display.db_min");
  const int db_max = FindEntry(catalog, "display.db_max");
  const bool span_free = db_max >= 0 && free[db_max];
  if (!span_free && !amplitudes_free) return start;
  ParameterValues best = start;
  double best_cost = CostAt(model, start, 1);
  const auto try_level = [&](double span_db, double offset_db) {
    ParameterValues trial = start;
    if (span_free) trial[db_max] = trial[db_min] + span_db;
    for (std::size_t i = 0; i < catalog.size(); ++i) {
      if (IsAmplitude(catalog[i]) && free[i]) trial[i] *= PowerFromDb(offset_db);
    }
    const double cost = CostAt(model, trial, 1);
    if (cost < best_cost) {
      best_cost = cost;
      best = trial;
    }
  };
  std::vector<double> spans = {span_free ? start[db_max] - start[db_min] : 0.0};
  if (span_free) spans.insert(spans.end(), {1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0});
  for (const double span_db : spans) {
    for (int tens = -6; tens <= 6; ++tens) {
      const double offset_db = 10.0 * tens;
      if (amplitudes_free || offset_db == 0.0) try_level(span_db, offset_db);
    }
  }
  MoveInsideBounds(catalog, free, best);
  return best;
}

std::array<double, 6> StartCurve(int shape) {
  return kStartShapes[(shape - 1) % kStartShapes.size()];
}

std::array<double, 6> AtLevelOf(const std::array<double, 6>& level, std::array<double, 6> curve) {
  constexpr double kObliqueDeg = 30.0;
  const auto power_of = [](const std::array<double, 6>& c) {
    return sim::GsabPower(GsabParameters<double>{c[0], c[1], c[2], c[3], c[4], c[5]}, kObliqueDeg);
  };
  const double factor = power_of(level) / power_of(curve);
  for (const int amplitude : {0, 2, 4}) curve[amplitude] *= factor;
  return curve;
}

ParameterValues WithCurveShape(const std::vector<CatalogEntry>& catalog, const std::vector<bool>& free,
                               const ParameterValues& start, const ParameterValues& level, int shape_number) {
  ParameterValues values = start;
  std::array<double, 6> curve{};
  for (std::size_t i = 0; i < catalog.size(); ++i) {
    const CatalogEntry& entry = catalog[i];
    if (entry.group != ParameterGroup::kGsab) continue;
    if (entry.index == 0) {
      std::array<double, 6> of_level{};
      std::copy_n(level.begin() + static_cast<std::ptrdiff_t>(i), of_level.size(), of_level.begin());
      curve = AtLevelOf(of_level, StartCurve(shape_number));
    }
    if (free[i]) values[i] = std::clamp(curve[entry.index], entry.lower, entry.upper);
  }
  return values;
}

}  // namespace sonarcal::calib
