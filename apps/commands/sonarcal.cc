// The program `sonarcal`: one binary, one file per command.
#include <CLI/CLI.hpp>

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include "apps/cli/command.h"
#include "apps/commands/commands.h"
#include "apps/commands/examples.h"

namespace {

// Images of one size are made and freed for every frame. Memory that goes back to the system each time, to be
// cleared when it comes again, took a fifth of the processor time of simulating a long recording.
void KeepFreedMemory() {
#ifdef __GLIBC__
  constexpr int kMiB = 1 << 20;
  mallopt(M_MMAP_THRESHOLD, 256 * kMiB);
  mallopt(M_TRIM_THRESHOLD, 512 * kMiB);
#endif
}

}  // namespace

int main(int argc, char** argv) {
  using namespace sonarcal::commands;  // NOLINT(google-build-using-namespace)
  KeepFreedMemory();
  CLI::App app("Makes a simulated imaging sonar agree with a real one.");
  sonarcal::cli::SetUpRoot(app);
  const auto add = [&](const char* group, const std::vector<void (*)(CLI::App&)>& setups) {
    sonarcal::cli::AddCommands(app, group, setups);
  };
  add("Start here", {SetupScenes, SetupSimulate, SetupCompare, SetupFit, SetupReproduce});
  add("Calibrate", {SetupCalibrate, SetupLocate, SetupPoses, SetupExplain, SetupJudgeNoise});
  add("Look at data", {SetupInspect, SetupView, SetupGallery, SetupRays, SetupSonars, SetupRecordings});
  add("Exchange and automate", {SetupConvert, SetupExport, SetupBatch, SetupDocs});
  AddExamples(app);
  return sonarcal::cli::RunApp(app, argc, argv);
}
