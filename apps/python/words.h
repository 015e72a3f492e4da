// The options of a command from the words of its command line, so that Python knows the same options, with
// the same defaults and the same sentences for mistakes.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace sonarcal::python {

// `words` such as "--bits=12" or "--noise". Nothing is required. Throws UsageError for what the command would
// refuse.
void ParseWords(CLI::App& command, const std::vector<std::string>& words);

}  // namespace sonarcal::python
