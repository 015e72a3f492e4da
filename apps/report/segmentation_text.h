// How the object was found, in words.
#pragma once

#include <string>

#include "metrics/compare.h"

namespace sonarcal {

std::string DetectorText(const CompareOptions& options);

}  // namespace sonarcal
