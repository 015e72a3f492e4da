// Names in the order in which people count: "frame_2" before "frame_10".
#pragma once

#include <string>

namespace sonarcal::data_io {

bool NaturalLess(const std::string& a, const std::string& b);

}  // namespace sonarcal::data_io
