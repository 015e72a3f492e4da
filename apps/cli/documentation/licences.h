// Text of `sonarcal --licenses`: version, licence, notices of parts made by others, and a table of the
// libraries that this build uses. cmake/SonarcalBillOfMaterials.cmake embeds LICENSE, THIRD_PARTY_NOTICES.md
// and the table.
#pragma once

#include <string>

namespace sonarcal::cli {

std::string LicenceText();  // without a line break at the end

}  // namespace sonarcal::cli
