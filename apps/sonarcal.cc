#include <CLI/CLI.hpp>

// The program `sonarcal`: one binary, one file a command.
#include "apps/command.h"
#include "apps/commands.h"

int main(int argc, char** argv) {
  CLI::App app("Makes a simulated imaging sonar agree with a real one.");
  sonarcal::SetUpRoot(app);
  sonarcal::SetupReproduce(app);
  sonarcal::SetupScenes(app);
  sonarcal::SetupGallery(app);
  sonarcal::SetupSimulate(app);
  sonarcal::SetupRays(app);
  sonarcal::SetupCompare(app);
  sonarcal::SetupFit(app);
  sonarcal::SetupView(app);
  sonarcal::SetupBatch(app);
  sonarcal::SetupDocs(app);
  sonarcal::SetupExplain(app);
  sonarcal::SetupInspect(app);
  sonarcal::SetupConvert(app);
  sonarcal::SetupExport(app);
  sonarcal::SetupPoses(app);
  sonarcal::SetupRecordings(app);
  sonarcal::SetupSonars(app);
  return sonarcal::RunApp(app, argc, argv);
}
