#include "apps/report/html/report_end.h"

#include <nlohmann/json.hpp>

namespace sonarcal::report {

void EndReport(HtmlReport& report, const nlohmann::ordered_json& provenance) {
  report.Section("How this was made");
  report.Details("Provenance: version, configuration, hashes of the inputs", provenance.dump(2));
  report.SetFooter("sonarcal " SONARCAL_VERSION);
}

}  // namespace sonarcal::report
