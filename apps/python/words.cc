#include "apps/python/words.h"

#include <algorithm>

#include <CLI/CLI.hpp>

#include "core/types/error.h"

namespace sonarcal::python {

void ParseWords(CLI::App& command, const std::vector<std::string>& words) {
  for (CLI::Option* option : command.get_options()) option->required(false);
  std::vector<std::string> last_first(words.rbegin(), words.rend());  // as CLI11 takes them
  try {
    command.parse(last_first);
  } catch (const CLI::ParseError& error) {
    throw UsageError("{}", error.what());
  }
}

}  // namespace sonarcal::python
