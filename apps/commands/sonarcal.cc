#include <CLI/CLI.hpp>

// The program `sonarcal`: one binary, one file per command.
#include "apps/cli/command.h"
#include "apps/commands/commands.h"

int main(int argc, char** argv) {
  CLI::App app("Makes a simulated imaging sonar agree with a real one.");
  sonarcal::cli::SetUpRoot(app);
  sonarcal::commands::SetupReproduce(app);
  sonarcal::commands::SetupScenes(app);
  sonarcal::commands::SetupGallery(app);
  sonarcal::commands::SetupSimulate(app);
  sonarcal::commands::SetupRays(app);
  sonarcal::commands::SetupCompare(app);
  sonarcal::commands::SetupFit(app);
  sonarcal::commands::SetupCalibrate(app);
  sonarcal::commands::SetupJudgeNoise(app);
  sonarcal::commands::SetupLocate(app);
  sonarcal::commands::SetupView(app);
  sonarcal::commands::SetupBatch(app);
  sonarcal::commands::SetupDocs(app);
  sonarcal::commands::SetupExplain(app);
  sonarcal::commands::SetupInspect(app);
  sonarcal::commands::SetupConvert(app);
  sonarcal::commands::SetupExport(app);
  sonarcal::commands::SetupPoses(app);
  sonarcal::commands::SetupRecordings(app);
  sonarcal::commands::SetupSonars(app);
  return sonarcal::cli::RunApp(app, argc, argv);
}
