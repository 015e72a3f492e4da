#include "calib/acoustic_fit.h"

#include <algorithm>
#include <utility>

#include "data_io/types/error.h"
#include "data_io/types/units.h"

namespace sonarcal {

std::vector<std::string> AcousticFreeByDefault() {
  return {"materials", "receiver.noise_db"};
}

double NoiseStartDb(const std::vector<AcousticFrame>& frames, double looks) {
  constexpr double kDarkest = 0.2;
  std::vector<double> powers;
  for (const AcousticFrame& frame : frames) {
    for (const RecordedPower& recorded : frame.recorded) powers.push_back(recorded.power);
  }
  if (powers.empty()) throw DataError("fit: no pixels");
  const auto at = powers.begin() + static_cast<std::ptrdiff_t>(kDarkest * static_cast<double>(powers.size()));
  std::nth_element(powers.begin(), at, powers.end());
  // Were all of them noise, the darkest fifth of exponential power would end at -ln(0.8) of its mean; of more
  // looks, nearer to it.
  const double of_mean = looks > 2.0 ? 1.0 : -std::log1p(-kDarkest);
  return DbFromPower(*at / of_mean);
}

FitResult FitAcousticModel(const std::vector<AcousticFrame>& frames, const SonarModel& sonar,
                           double absorption_db_per_m, const std::vector<std::string>& material_names,
                           const ParameterSet& initial, const FitConfig& config, const FitOptions& options) {
  std::vector<CatalogEntry> catalog = BuildAcousticCatalog(material_names, sonar);
  const std::vector<bool> free = ApplyFitConfig(config, catalog);
  bool response_is_fixed = true;
  for (std::size_t i = 0; i < catalog.size(); ++i) {
    const bool of_response =
        catalog[i].group == ParameterGroup::kBeam || catalog[i].group == ParameterGroup::kPulse;
    if (free[i] && of_response) response_is_fixed = false;
  }
  const AcousticFrameModel model(frames, sonar, absorption_db_per_m, material_names, initial,
                                 response_is_fixed);
  ModelFit fit = Fit(model, model.Values(initial), config, options);
  return {.parameters = model.Parameters(fit.values), .report = std::move(fit.report), .usable = fit.usable};
}

}  // namespace sonarcal
