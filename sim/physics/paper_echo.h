// Echo of one ray in the paper's model (Park 2024 Eqs. 11 and 21): its level in dB, scaled to 0..1 between
// the display's limits. Not clamped: only the sum over a pixel's rays is (Eqs. 22-24).
#pragma once

#include <vector>

#include "core/types/parameters.h"
#include "sim/physics/gsab.h"
#include "sim/physics/propagation.h"

namespace sonarcal::sim {

// All parameters of the paper's image, with materials in the order of the scene's material names.
template <typename T>
struct PaperParameters {
  T source_level_db = T(0.0);
  DisplayParameters<T> display;
  std::vector<GsabParameters<T>> materials;
  JitterParameters<T> jitter;
  double noise_level_db = 0.0;
  double array_gain_db = 0.0;

  bool operator==(const PaperParameters&) const = default;
};

// s = (SNR - dB_min) / (dB_max - dB_min). Affine in loss and target strength: the mean of s over rays is s at
// the mean loss and the mean target strength. A pixel can therefore be shaded from a histogram.
template <typename T>
T NormalisedPaperEcho(const PaperParameters<T>& p, const T& two_way_loss_db, const T& target_strength_db) {
  const T snr_db = SonarEquationDb(p.source_level_db, two_way_loss_db, target_strength_db, p.noise_level_db,
                                   p.array_gain_db);
  return (snr_db - p.display.db_min) / (p.display.db_max - p.display.db_min);
}

// Parameters for the materials of a scene. Throws DataError if a material has none.
inline PaperParameters<double> PaperParametersFor(const ParameterSet& parameters,
                                                  const std::vector<std::string>& material_names) {
  PaperParameters<double> paper;
  paper.source_level_db = parameters.source_level_db;
  paper.display = parameters.display;
  paper.jitter = parameters.jitter;
  paper.noise_level_db = parameters.noise_level_db;
  paper.array_gain_db = parameters.array_gain_db;
  for (const std::string& name : material_names) paper.materials.push_back(parameters.Material(name).gsab);
  return paper;
}

}  // namespace sonarcal::sim
