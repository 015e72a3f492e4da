// Layout of --help: one line an option, its value's name or unit beside it, its default at the end.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace sonarcal::cli {

class HelpFormatter : public CLI::Formatter {
 public:
  HelpFormatter();

 protected:
  std::string make_option(const CLI::Option* option, bool is_positional) const override;
  std::string make_option_name(const CLI::Option* option, bool is_positional) const override;
  std::string make_usage(const CLI::App* app, std::string name) const override;
  // CLI11 says "[At least 1 of the following options are required]" of a required subcommand.
  std::string make_description(const CLI::App* app) const override;
};

}  // namespace sonarcal::cli
