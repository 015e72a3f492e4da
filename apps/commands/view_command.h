// `sonarcal view`: serves a page on this machine that shows a scene, a sonar in it and its simulated image,
// and follows every parameter change. Shows a recording beside it, if given (docs/guide/view.md).
//
// Writes on request of the page into `out`: params.json, poses.json, sonar.json if the sonar was changed, and
// provenance.json.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "apps/cli/command.h"
#include "apps/cli/scene_option.h"
#include "apps/view/view_session.h"
#include "apps/workflow/comparison_options.h"
#include "apps/workflow/materials/material_options.h"
#include "apps/workflow/rays/ray_options.h"

namespace sonarcal::commands {

struct ViewOptions {
  cli::CommonOptions common;
  std::filesystem::path scene;
  cli::SceneFormat scene_format;
  std::string sonar;             // name of a preset, or file; empty: that of `real`
  std::filesystem::path params;  // empty: those of apps/commands/scenes_command.h
  std::filesystem::path poses;   // recording, or file of poses; empty: those of `real`, or a default pose
  std::filesystem::path real;    // empty for none
  std::filesystem::path out;     // empty: the page offers its files for download only
  std::optional<EchoModel> model;
  workflow::RayOptions rays;
  std::optional<double> margin_deg;
  int ghost_order = 1;
  workflow::ComparisonOptions comparison;
  workflow::MaterialOptions materials;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor&& visit) {
    visit(OptionInfo{.name = "model",
                     .help = "Image model: paper or acoustic",
                     .by_default = "that of the parameters"},
          self.model);
    workflow::RayOptions::Visit(self.rays, visit);
    workflow::VisitReach(self.ghost_order, self.margin_deg, visit);
    workflow::ComparisonOptions::Visit(self.comparison, visit);
    workflow::MaterialOptions::Visit(self.materials, visit);
  }
  int port = 8765;  // 0: any free port
  bool open = false;
};

// Returns the initial state of the page. Throws UsageError or DataError if the options do not fit together.
view::ViewSetup SetUpView(const ViewOptions& options);

// Runs until the user interrupts it.
cli::ExitStatus RunView(const ViewOptions& options);

}  // namespace sonarcal::commands
