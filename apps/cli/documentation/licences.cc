#include "apps/cli/documentation/licences.h"

#include <fmt/format.h>

#include "apps/cli/documentation/licence_texts.h"

namespace sonarcal::cli {
namespace {

std::string LibraryTable() {
  constexpr UsedLibrary kHead = {"library", "version", "use", "licence"};
  UsedLibrary widest = kHead;
  const auto keep_longer = [](std::string_view& kept, std::string_view cell) {
    if (cell.size() > kept.size()) kept = cell;
  };
  for (const UsedLibrary& library : kUsedLibraries) {
    keep_longer(widest.name, library.name);
    keep_longer(widest.version, library.version);
    keep_longer(widest.use, library.use);
  }
  std::string table;
  const auto add_row = [&](const UsedLibrary& row) {
    table += fmt::format("\n{:{}}  {:{}}  {:{}}  {}", row.name, widest.name.size(), row.version,
                         widest.version.size(), row.use, widest.use.size(), row.licence);
  };
  add_row(kHead);
  for (const UsedLibrary& library : kUsedLibraries) add_row(library);
  return table;
}

}  // namespace

std::string LicenceText() {
  return fmt::format("sonarcal {}\n\n{}\n{}\nLibraries of this build\n{}", SONARCAL_VERSION, kLicence,
                     kNotices, LibraryTable());
}

}  // namespace sonarcal::cli
