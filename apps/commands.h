// The commands of `sonarcal`, each described to the command line by its Setup function. In the order of
// --help.
#pragma once

namespace CLI {
class App;
}

namespace sonarcal {

void SetupReproduce(CLI::App& app);   // apps/reproduce_command.h
void SetupScenes(CLI::App& app);      // apps/scenes_command.h
void SetupGallery(CLI::App& app);     // apps/gallery_command.h
void SetupSimulate(CLI::App& app);    // apps/simulate_command.h
void SetupRays(CLI::App& app);        // apps/rays_command.h
void SetupCompare(CLI::App& app);     // apps/compare_command.h
void SetupFit(CLI::App& app);         // apps/fit_command.h
void SetupView(CLI::App& app);        // apps/view_command.h
void SetupBatch(CLI::App& app);       // apps/batch_command.h
void SetupDocs(CLI::App& app);        // hidden: apps/documentation_command.cc
void SetupExplain(CLI::App& app);     // apps/explain_command.h
void SetupInspect(CLI::App& app);     // apps/inspect_command.h
void SetupConvert(CLI::App& app);     // apps/convert_command.h
void SetupExport(CLI::App& app);      // apps/export_command.h
void SetupPoses(CLI::App& app);       // apps/poses_command.h
void SetupRecordings(CLI::App& app);  // apps/recordings_command.h
void SetupSonars(CLI::App& app);      // apps/sonars_command.h

}  // namespace sonarcal
