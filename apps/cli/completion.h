// Completion for shells, made from the commands themselves: names of commands, options of each, and the words
// of options that take one of a few; file names elsewhere.
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace sonarcal::cli {

std::string BashCompletion(const CLI::App& root);  // for /usr/share/bash-completion/completions/sonarcal
std::string ZshCompletion(const CLI::App& root);   // for /usr/share/zsh/vendor-completions/_sonarcal
std::string FishCompletion(const CLI::App& root);  // for /usr/share/fish/vendor_completions.d/sonarcal.fish

}  // namespace sonarcal::cli
