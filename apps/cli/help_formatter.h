// Layout of --help: options in the groups of apps/cli/option_groups.h, one line per option, with the name or
// unit of its value beside it and its default at the end.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace sonarcal::cli {

class HelpFormatter : public CLI::Formatter {
 public:
  HelpFormatter();

  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override;

 protected:
  std::string make_option(const CLI::Option* option, bool is_positional) const override;
  std::string make_option_name(const CLI::Option* option, bool is_positional) const override;
  std::string make_usage(const CLI::App* app, std::string name) const override;
  // Without the text of CLI11 for a required subcommand, "[At least 1 of the following options are
  // required]".
  std::string make_description(const CLI::App* app) const override;
};

}  // namespace sonarcal::cli
