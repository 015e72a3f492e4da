// Description of the segmentation in words.
#pragma once

#include <string>

#include "metrics/compare.h"

namespace sonarcal::report {

std::string DetectorText(const metrics::CompareOptions& options, bool real_is_synthetic);

}  // namespace sonarcal::report
