#include "apps/view/view_files.h"

#include <fmt/format.h>

#include <algorithm>

#include <nlohmann/json.hpp>

#include "apps/cli/add_options.h"
#include "apps/workflow/simulate.h"
#include "data_io/json/json_fields.h"
#include "data_io/json/json_writer.h"
#include "data_io/parameters/parameters_io.h"
#include "data_io/pose_io.h"

namespace sonarcal::view {
namespace {

std::string SonarText(const SonarModel& sonar, const Water& water) {
  return data_io::JsonText({{"sonar", data_io::SonarJson(sonar)}, {"water", data_io::WaterJson(water)}});
}

// Quotes text as one word of a shell.
std::string Word(const std::string& text) {
  constexpr std::string_view kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./+,:";
  if (!text.empty() && text.find_first_not_of(kPlain) == std::string::npos) return text;
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

std::string RayWords(const workflow::RayOptions& rays) {
  std::string words;
  for (const std::string& word : cli::OptionWords(rays)) words += " " + word;
  return words;
}

}  // namespace

ViewFiles FilesOf(const ViewSession& session, const ViewState& state, const std::string& folder) {
  const ViewSetup& setup = session.setup();
  ParameterSet parameters = state.parameters;
  const Water water = workflow::ChooseWater(parameters, setup.water).water;
  parameters.water = water;  // makes the water of the file explicit
  ViewFiles files;
  files.text["params.json"] = data_io::JsonText(data_io::ParametersJson(parameters));
  files.text["poses.json"] = data_io::PosesText(session.Poses(state));
  const bool sonar_changed = state.sonar != SonarChanges();
  if (sonar_changed) files.text["sonar.json"] = SonarText(Changed(setup.sonar, state.sonar), water);
  const std::string in = folder.empty() ? "" : folder + "/";
  files.command = fmt::format("sonarcal simulate --scene {}{} --sonar {} --params {} --poses {}{}",
                              Word(setup.scene_path), setup.scene_words,
                              Word(sonar_changed ? in + "sonar.json" : setup.sonar_argument),
                              Word(in + "params.json"), Word(in + "poses.json"), RayWords(setup.rays));
  if (setup.margin_deg) files.command += fmt::format(" --margin {}", *setup.margin_deg);
  if (session.bits() != 8) files.command += fmt::format(" --bits {}", session.bits());
  if (setup.ghost_order != 1) files.command += fmt::format(" --ghost-order {}", setup.ghost_order);
  files.command += state.noise ? fmt::format(" --noise --seed {}", state.seed) : " --expected";
  files.command += fmt::format(" --out {}", Word(in + "sim"));
  return files;
}

}  // namespace sonarcal::view
