// Comparison with an earlier one, as text for a terminal.
#pragma once

#include <string>

#include "metrics/json/against.h"

namespace sonarcal::report {

// Returns one line per headline figure, one for the rest, and the notes; ends with a newline.
std::string AgainstText(const metrics::Against& against);

}  // namespace sonarcal::report
