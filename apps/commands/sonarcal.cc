// The program `sonarcal`: one binary, one file per command.
#include <cstdlib>

#include <CLI/CLI.hpp>

#include "apps/cli/command.h"
#include "apps/commands/commands.h"
#include "apps/commands/examples.h"
#include "apps/workflow/kept_memory.h"

int main(int argc, char** argv) {
  using namespace sonarcal::commands;  // NOLINT(google-build-using-namespace)
  sonarcal::workflow::KeepFreedMemory();
  setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", 0);  // no lines of FFmpeg beside the program's own message
  CLI::App app("Makes a simulated imaging sonar agree with a real one.");
  sonarcal::cli::SetUpRoot(app);
  const auto add = [&](const char* group, const std::vector<void (*)(CLI::App&)>& setups) {
    sonarcal::cli::AddCommands(app, group, setups);
  };
  add("Start here", {SetupScenes, SetupSimulate, SetupCompare, SetupFit, SetupReproduce});
  add("Calibrate", {SetupCalibrate, SetupLocate, SetupPoses, SetupExplain, SetupJudgeNoise, SetupTransfer});
  add("Look at data",
      {SetupInspect, SetupView, SetupGallery, SetupRays, SetupSonars, SetupMaterials, SetupRecordings});
  add("Exchange and automate", {SetupConvert, SetupExport, SetupBatch, SetupDocs});
  AddExamples(app);
  return sonarcal::cli::RunApp(app, argc, argv);
}
