#include "apps/convert_command.h"

#include <memory>
#include <utility>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "apps/commands.h"
#include "apps/frame_range.h"
#include "apps/progress.h"
#include "apps/provenance.h"
#include "apps/run_output.h"
#include "data_io/open_recording.h"
#include "data_io/recording_io.h"

namespace sonarcal {

ExitStatus RunConvert(const ConvertOptions& options) {
  std::unique_ptr<RecordingSource> recording = OpenRecording(options.file);
  const FrameRange range = ParseFrameRange(options.frames, recording->frame_count());
  const FrameRangeView chosen(std::move(recording), range);

  RunOutput output(options.out);
  Progress progress("Converting", chosen.frame_count(), options.common);
  WriteRecording(chosen, output.directory(),
                 {.progress = [&](int frames_done, int) { progress.Update(frames_done); }});
  WriteProvenance(output.staging(), {.command = "convert",
                                     .configuration = {{"file", options.file.string()},
                                                       {"out", options.out.string()},
                                                       {"first_frame", range.begin},
                                                       {"frames", range.count()}},
                                     .inputs = {options.file}});
  output.Commit();

  if (options.common.json) {
    PrintJson({{"recording", output.final_path().string()}, {"frames", range.count()}});
  } else {
    PrintResult(fmt::format("{}: {} {}\n", options.out.string(), range.count(),
                            range.count() == 1 ? "frame" : "frames"));
  }
  return ExitStatus::kDone;
}

void SetupConvert(CLI::App& app) {
  auto options = std::make_shared<ConvertOptions>();
  CLI::App* command =
      AddCommand(app, "convert", "Writes any recording that can be read as a recording folder");
  command->add_option("FILE", options->file, "Recording folder, or file of a sonar's native format")
      ->required();
  command->add_option("--out", options->out, "Recording folder to write")->type_name("DIR")->required();
  command
      ->add_option("--frames", options->frames,
                   "Frames to take: from A, counted from 0, up to but without B; all if not given")
      ->type_name("A:B");
  OnRun(command, options->common, [options] { return RunConvert(*options); });
}

}  // namespace sonarcal
