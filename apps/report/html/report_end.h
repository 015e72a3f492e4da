// End of every report: its provenance.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "apps/report/html/html_report.h"

namespace sonarcal::report {

// `provenance`: as in provenance.json (apps/cli/provenance.h).
void EndReport(HtmlReport& report, const nlohmann::ordered_json& provenance);

}  // namespace sonarcal::report
