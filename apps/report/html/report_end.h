// How every report ends: where it comes from.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "apps/report/html/html_report.h"

namespace sonarcal::report {

// `provenance` is that of provenance.json (apps/cli/provenance.h).
void EndReport(HtmlReport& report, const nlohmann::ordered_json& provenance);

}  // namespace sonarcal::report
