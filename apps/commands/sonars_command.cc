// `sonarcal sonars`: lists the presets of --sonar (sim/scenes/sonar_presets.h) with their sources.
#include <fmt/format.h>

#include <memory>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "apps/cli/command.h"
#include "apps/commands/commands.h"
#include "core/types/units.h"
#include "data_io/json/json_fields.h"
#include "sim/scenes/sonar_presets.h"

namespace sonarcal::commands {
namespace {

struct SonarsOptions {
  cli::CommonOptions common;
};

using Json = nlohmann::ordered_json;

Json ToJson(const sim::SonarPreset& preset) {
  return {{"name", preset.name},
          {"sonar", data_io::SonarJson(preset.sonar)},
          {"water", data_io::WaterJson(preset.water)},
          {"field_of_view_deg", DegFromRad(preset.sonar.axes.field_of_view_rad())},
          {"azimuth_beam_width_is", Describe(preset.azimuth_width)},
          {"elevation_beam_width_is", Describe(preset.elevation_width)},
          {"source", preset.source},
          {"assumed", preset.assumed}};
}

std::string Text(const sim::SonarPreset& preset) {
  const SonarModel& sonar = preset.sonar;
  const PolarAxes& axes = sonar.axes;
  std::string text = fmt::format("{}\n", preset.name);
  const auto add = [&](const char* label, const std::string& value) {
    text += fmt::format("  {:<10} {}\n", label, value);
  };
  add("sonar", sonar.name);
  add("beams", fmt::format("{} over {:.1f} degrees, formed by {}", axes.beam_count(),
                           DegFromRad(axes.field_of_view_rad()),
                           sonar.beam_forming == BeamForming::kLens ? "a lens" : "an array"));
  add("azimuth", fmt::format("{:.2g} degrees per beam: {}", sonar.azimuth_beam_width_deg,
                             Describe(preset.azimuth_width)));
  add("elevation",
      fmt::format("{:g} degrees: {}", sonar.elevation_beam_width_deg, Describe(preset.elevation_width)));
  add("range", fmt::format("{:g}..{:g} m in {} bins of {:.3g} mm", axes.range_min_m, axes.range_max_m,
                           axes.range_bins, 1e3 * axes.range_bin_m()));
  add("source", std::string(preset.source));
  add("assumed", std::string(preset.assumed));
  return text;
}

}  // namespace

cli::ExitStatus RunSonars(const SonarsOptions& options) {
  Json sonars = Json::array();
  std::string text;
  for (const sim::SonarPreset& preset : sim::SonarPresets()) {
    sonars.push_back(ToJson(preset));
    text += (text.empty() ? "" : "\n") + Text(preset);
  }
  if (options.common.json) {
    cli::PrintJson({{"sonars", sonars}});
  } else {
    cli::PrintResult(text);
  }
  return cli::ExitStatus::kDone;
}

void SetupSonars(CLI::App& app) {
  auto options = std::make_shared<SonarsOptions>();
  CLI::App* command = cli::AddCommand(app, "sonars", "Lists the sonars known by name, for --sonar");
  cli::OnRun(command, options->common, [options] { return RunSonars(*options); });
}

}  // namespace sonarcal::commands
