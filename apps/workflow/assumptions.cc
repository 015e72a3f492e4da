#include "apps/workflow/assumptions.h"

#include <fmt/format.h>

namespace sonarcal::workflow {

std::optional<std::string> AssumeFrequency(SonarModel& sonar) {
  if (sonar.frequency_hz > 0.0) return std::nullopt;
  sonar.frequency_hz = kAssumedFrequencyHz;
  return fmt::format("the recording states no frequency: {:g} MHz is assumed for the absorption",
                     kAssumedFrequencyHz / 1e6);
}

std::vector<AssumedWidth> AssumeWidths(const SonarModel& sonar, BeamParameters& beam) {
  std::vector<AssumedWidth> assumed;
  const auto assume = [&](std::string_view name, double stated_deg, double assumed_deg, double& width_deg) {
    if (width_deg > 0.0 || stated_deg > 0.0) return;
    width_deg = assumed_deg;
    assumed.push_back({name, assumed_deg});
  };
  if (beam.azimuth_pattern != AzimuthPattern::kTable)
    assume("beam.azimuth_width_deg", sonar.azimuth_beam_width_deg, kAssumedAzimuthWidthDeg,
           beam.azimuth_width_deg);
  assume("beam.elevation_width_deg", sonar.elevation_beam_width_deg, kAssumedElevationWidthDeg,
         beam.elevation_width_deg);
  return assumed;
}

std::vector<std::string> AssumeMissing(const ImageScale& scale, bool find_display, SonarModel& sonar,
                                       ParameterSet& parameters) {
  std::vector<std::string> sentences;
  if (const auto sentence = AssumeFrequency(sonar)) sentences.push_back(*sentence);
  if (parameters.model != EchoModel::kAcoustic) return sentences;
  for (const AssumedWidth& width : AssumeWidths(sonar, parameters.beam)) {
    sentences.push_back(fmt::format(
        "neither the recording nor the parameters state {}: {:g} degrees are assumed, give the width "
        "in the parameters or free it",
        width.name, width.deg));
  }
  const DisplayParameters<double>& display = parameters.display;
  if (!find_display && !(scale.db_min && scale.db_max) && !scale.db_span &&
      display.law != DisplayLaw::kPower) {
    sentences.push_back(fmt::format(
        "the recording states no dB scale: the display of the parameters ({:g} .. {:g} dB) is taken "
        "for it, --free display finds one from the background",
        display.db_min, display.db_max));
  }
  return sentences;
}

}  // namespace sonarcal::workflow
