#include "calib/mirror_start.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/types/parameter_table.h"
#include "core/types/units.h"

namespace sonarcal::calib {
namespace {

constexpr const char* kTransmitEnd = "beam.transmit_end_deg";

bool Names(const std::optional<std::vector<std::string>>& patterns, const std::string& name) {
  return patterns && std::find(patterns->begin(), patterns->end(), name) != patterns->end();
}

}  // namespace

std::vector<std::string> MirrorsFreeByDefault(const ParameterSet& initial,
                                              const std::vector<std::string>& material_names) {
  const bool any = std::any_of(material_names.begin(), material_names.end(),
                               [&](const std::string& name) { return initial.mirrors.contains(name); });
  if (!any) return {};
  std::vector<std::string> free = {"mirrors"};
  if (!(initial.beam.transmit_end_deg > 0.0)) free.emplace_back(kTransmitEnd);
  return free;
}

ParameterSet WithMirrorStart(ParameterSet initial, const FitConfig& config,
                             const std::vector<std::string>& material_names, const SonarModel& sonar) {
  for (const std::string& material : material_names) {
    if (Names(config.free, fmt::format("mirror.{}.loss_db", material)))
      initial.mirrors.try_emplace(material, MirrorParameters{.loss_db = kStartLossDb});
  }
  BeamParameters& beam = initial.beam;
  if (beam.transmit_end_deg > 0.0 || !Names(config.free, kTransmitEnd)) return initial;
  const double edge_deg = DegFromRad(sonar.axes.OuterEdgeRad());
  double max_deg = 0.0;
  VisitParameters(beam, [&](const ParameterInfo& info, const auto&) {
    if (info.key == "transmit_end_deg") max_deg = info.max;
  });
  beam.transmit_even_deg = std::min(edge_deg, max_deg);
  beam.transmit_end_deg = std::min(edge_deg + kStartTransmitDeg, max_deg);
  return initial;
}

}  // namespace sonarcal::calib
