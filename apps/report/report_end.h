// How every report ends: where it comes from.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "apps/report/html_report.h"

namespace sonarcal {

// `provenance` is that of provenance.json (apps/provenance.h).
void EndReport(HtmlReport& report, const nlohmann::ordered_json& provenance);

}  // namespace sonarcal
