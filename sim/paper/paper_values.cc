#include "sim/paper/paper_values.h"

#include <cmath>

#include "core/types/units.h"

namespace sonarcal::sim {

ParameterSet PaperValues(const SonarModel& sonar, const std::vector<std::string>& material_names) {
  ParameterSet values;
  values.source_level_db = kPaperSourceLevelDb;
  values.display = PaperDisplay();
  // GSAB: the defaults are those of Table 4
  for (const std::string& name : material_names) values.materials[name];
  // Rounds to a tenth of a millimetre: the P900-45's bin is 2.54 cm, and its window is not a whole number of
  // bins.
  values.jitter.sigma_range_m = std::round(0.5e4 * sonar.axes.range_bin_m()) * 1e-4;
  const double beam_deg = sonar.azimuth_beam_width_deg > 0.0 ? sonar.azimuth_beam_width_deg
                                                             : DegFromRad(sonar.axes.beam_spacing_rad());
  values.jitter.sigma_azimuth_deg = 0.5 * beam_deg;
  values.jitter.reference_frequency_hz = sonar.frequency_hz;
  return values;
}

}  // namespace sonarcal::sim
