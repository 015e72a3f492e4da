#include "apps/commands/fitting/recorded_display.h"

#include <string>

#include "apps/workflow/fit.h"
#include "core/types/error.h"
#include "data_io/parameters/parameters_io.h"

namespace sonarcal::commands {

ParameterSet ParametersWithDisplay(const FitCommandOptions& options, const RecordingInfo& info) {
  ParameterSet parameters;
  parameters.model = EchoModel::kAcoustic;
  if (!options.params.empty()) parameters = data_io::ReadParameters(options.params);
  if (options.params.empty() && !(info.scale.db_min && info.scale.db_max)) {
    throw DataError("{}: the recording states no levels db_min and db_max, expected --params with a display",
                    info.source);
  }
  if (const std::string note = workflow::TakeDisplay(info.scale, parameters); !note.empty())
    cli::PrintNote(options.common, note);
  return parameters;
}

}  // namespace sonarcal::commands
