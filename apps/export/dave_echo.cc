#include "apps/export/dave_echo.h"

#include <fmt/format.h>

#include "apps/export/export_words.h"

namespace sonarcal::exporting {
namespace {

constexpr double kAbsorptionDbPerM = 0.0354;  // fixed in the plugins

}  // namespace

void AccountForDaveEcho(const ExportSource& source, const std::string& bandwidth, ExportAccount& account) {
  if (source.parameters.model != EchoModel::kPaper && source.parameters.receiver.looks == 1.0) {
    account.Exported("receiver.looks", "", "DAVE's speckle is of one look");
  } else {
    account.Approximated("receiver.looks", "", "DAVE's speckle is of one look");
  }
  account.Approximated("pulse.", bandwidth, "the pulse is one bin long, and shaded by a Hamming window");
  const std::string absorption = fmt::format("DAVE's absorption is fixed at {} dB/m, ours is {:.4g} dB/m",
                                             kAbsorptionDbPerM, source.absorption_db_per_m);
  account.NotExpressed("absorption_db_per_m", absorption);
  account.NotExpressed("water.", absorption);
  AccountForTheRest("DAVE", account);
}

}  // namespace sonarcal::exporting
