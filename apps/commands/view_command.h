// `sonarcal view`: a page on this machine that shows a scene, a sonar in it and what it would see, and
// follows every parameter as it is moved; beside a recording where there is one (docs/guide/view.md).
//
// Written, where asked for by the page: params.json, poses.json, sonar.json where the sonar was changed, and
// provenance.json, into `out`.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "apps/cli/command.h"
#include "apps/cli/scene_option.h"
#include "apps/view/view_session.h"
#include "apps/workflow/comparison_options.h"
#include "apps/workflow/ray_options.h"

namespace sonarcal::commands {

struct ViewOptions {
  cli::CommonOptions common;
  std::filesystem::path scene;
  cli::SceneFormat scene_format;
  std::string sonar;             // name of a preset, or file; empty: that of `real`
  std::filesystem::path params;  // empty: those of apps/commands/scenes_command.h
  std::filesystem::path poses;   // recording, or file of poses; empty: those of `real`, or one of its own
  std::filesystem::path real;    // empty for none
  std::filesystem::path out;     // empty: the page's files can be downloaded, not written
  std::optional<EchoModel> model;
  workflow::RayOptions rays;
  std::optional<double> margin_deg;
  int ghost_order = 1;
  workflow::ComparisonOptions comparison;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor&& visit) {
    visit(OptionInfo{.name = "model",
                     .help = "Image model: paper or acoustic",
                     .by_default = "that of the parameters"},
          self.model);
    workflow::RayOptions::Visit(self.rays, visit);
    workflow::VisitReach(self.ghost_order, self.margin_deg, visit);
    workflow::ComparisonOptions::Visit(self.comparison, visit);
  }
  int port = 8765;  // 0: any free one
  bool open = false;
};

// What the page starts from. Throws UsageError or DataError where the options do not go together.
view::ViewSetup SetUpView(const ViewOptions& options);

// Ends when the user interrupts it.
cli::ExitStatus RunView(const ViewOptions& options);

}  // namespace sonarcal::commands
