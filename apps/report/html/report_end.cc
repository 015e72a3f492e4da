#include "apps/report/html/report_end.h"

#include <nlohmann/json.hpp>

#include "data_io/json/json_writer.h"

namespace sonarcal::report {

void EndReport(HtmlReport& report, const nlohmann::ordered_json& provenance) {
  report.Section("How this was made");
  report.Details("Provenance: version, configuration, hashes of the inputs", data_io::JsonText(provenance));
  report.SetFooter("sonarcal " SONARCAL_VERSION);
}

}  // namespace sonarcal::report
