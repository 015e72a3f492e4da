#include "apps/sonars_command.h"

#include <fmt/format.h>

#include <memory>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "apps/commands.h"
#include "core/types/units.h"
#include "data_io/json/json_fields.h"
#include "sim/scenes/sonar_presets.h"

namespace sonarcal {
namespace {

using Json = nlohmann::ordered_json;

// From the outer edge of the first beam to that of the last.
double FieldDeg(const PolarAxes& axes) {
  const std::vector<double> edges_rad = axes.BeamEdgesRad();
  return DegFromRad(edges_rad.back() - edges_rad.front());
}

Json ToJson(const SonarPreset& preset) {
  return {{"name", preset.name},
          {"sonar", SonarJson(preset.sonar)},
          {"water", WaterJson(preset.water)},
          {"field_of_view_deg", FieldDeg(preset.sonar.axes)},
          {"azimuth_beam_width_is", ToString(preset.azimuth_width)},
          {"elevation_beam_width_is", ToString(preset.elevation_width)},
          {"source", preset.source},
          {"assumed", preset.assumed}};
}

std::string Text(const SonarPreset& preset) {
  const SonarModel& sonar = preset.sonar;
  const PolarAxes& axes = sonar.axes;
  std::string text = fmt::format("{}\n", preset.name);
  const auto add = [&](const char* label, const std::string& value) {
    text += fmt::format("  {:<10} {}\n", label, value);
  };
  add("sonar", sonar.name);
  add("beams", fmt::format("{} over {:.1f} degrees, formed by {}", axes.beam_count(), FieldDeg(axes),
                           sonar.beam_forming == BeamForming::kLens ? "a lens" : "an array"));
  add("azimuth", fmt::format("{:.2g} degrees per beam: {}", sonar.azimuth_beam_width_deg,
                             ToString(preset.azimuth_width)));
  add("elevation",
      fmt::format("{:g} degrees: {}", sonar.elevation_beam_width_deg, ToString(preset.elevation_width)));
  add("range", fmt::format("{:g}..{:g} m in {} bins of {:.3g} mm", axes.range_min_m, axes.range_max_m,
                           axes.range_bins, 1e3 * axes.range_bin_m()));
  add("source", std::string(preset.source));
  add("assumed", std::string(preset.assumed));
  return text;
}

}  // namespace

ExitStatus RunSonars(const SonarsOptions& options) {
  Json sonars = Json::array();
  std::string text;
  for (const SonarPreset& preset : SonarPresets()) {
    sonars.push_back(ToJson(preset));
    text += (text.empty() ? "" : "\n") + Text(preset);
  }
  if (options.common.json) {
    PrintJson({{"sonars", sonars}});
  } else {
    PrintResult(text);
  }
  return ExitStatus::kDone;
}

void SetupSonars(CLI::App& app) {
  auto options = std::make_shared<SonarsOptions>();
  CLI::App* command =
      AddCommand(app, "sonars", "Lists the sonars known by name: figures, their sources, what is assumed");
  OnRun(command, options->common, [options] { return RunSonars(*options); });
}

}  // namespace sonarcal
