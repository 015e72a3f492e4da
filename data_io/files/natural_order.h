// Natural order of names: "frame_2" comes before "frame_10".
#pragma once

#include <string>

namespace sonarcal::data_io {

// True for 0 .. 9, in every locale.
bool IsDigit(char c);

bool NaturalLess(const std::string& a, const std::string& b);

}  // namespace sonarcal::data_io
