// A comparison with an earlier one, in words for a terminal.
#pragma once

#include <string>

#include "metrics/json/against.h"

namespace sonarcal::report {

// A line for each headline figure, one for the rest, and the notes; ends with a newline.
std::string AgainstText(const metrics::Against& against);

}  // namespace sonarcal::report
