// Setup functions of the commands of `sonarcal`, in the order of --help.
#pragma once

namespace CLI {
class App;
}

namespace sonarcal::commands {

void SetupReproduce(CLI::App& app);
void SetupScenes(CLI::App& app);
void SetupGallery(CLI::App& app);
void SetupSimulate(CLI::App& app);
void SetupRays(CLI::App& app);
void SetupCompare(CLI::App& app);
void SetupFit(CLI::App& app);
void SetupCalibrate(CLI::App& app);
void SetupJudgeNoise(CLI::App& app);
void SetupLocate(CLI::App& app);
void SetupView(CLI::App& app);
void SetupBatch(CLI::App& app);
void SetupDocs(CLI::App& app);  // hidden
void SetupExplain(CLI::App& app);
void SetupInspect(CLI::App& app);
void SetupConvert(CLI::App& app);
void SetupExport(CLI::App& app);
void SetupPoses(CLI::App& app);
void SetupRecordings(CLI::App& app);
void SetupSonars(CLI::App& app);
void SetupTransfer(CLI::App& app);
void SetupMaterials(CLI::App& app);

}  // namespace sonarcal::commands
