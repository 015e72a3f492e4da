// Setup functions of the commands of `sonarcal`, in the order of --help.
#pragma once

namespace CLI {
class App;
}

namespace sonarcal::commands {

void SetupReproduce(CLI::App& app);   // apps/commands/reproduce_command.h
void SetupScenes(CLI::App& app);      // apps/commands/scenes_command.h
void SetupGallery(CLI::App& app);     // apps/commands/gallery_command.h
void SetupSimulate(CLI::App& app);    // apps/commands/simulate_command.h
void SetupRays(CLI::App& app);        // apps/commands/rays_command.h
void SetupCompare(CLI::App& app);     // apps/commands/compare_command.h
void SetupFit(CLI::App& app);         // apps/commands/fit_command.h
void SetupView(CLI::App& app);        // apps/commands/view_command.h
void SetupBatch(CLI::App& app);       // apps/commands/batch_command.h
void SetupDocs(CLI::App& app);        // hidden: apps/commands/documentation_command.cc
void SetupExplain(CLI::App& app);     // apps/commands/explain_command.h
void SetupInspect(CLI::App& app);     // apps/commands/inspect_command.h
void SetupConvert(CLI::App& app);     // apps/commands/convert_command.h
void SetupExport(CLI::App& app);      // apps/commands/export_command.h
void SetupPoses(CLI::App& app);       // apps/commands/poses_command.h
void SetupRecordings(CLI::App& app);  // apps/commands/recordings_command.h
void SetupSonars(CLI::App& app);      // apps/commands/sonars_command.h

}  // namespace sonarcal::commands
