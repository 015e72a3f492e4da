// Shell completion, generated from the commands: their names, their options, and the words of options with a
// few values. Other values complete as file names.
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
