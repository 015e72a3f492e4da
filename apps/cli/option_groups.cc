#include "apps/cli/option_groups.h"

#include <algorithm>
#include <map>

#include <CLI/CLI.hpp>

#include "apps/cli/add_options.h"
#include "apps/workflow/comparison_options.h"
#include "apps/workflow/rays/ray_options.h"

namespace sonarcal::cli {
namespace {

constexpr const char* kInput = "Input";
constexpr const char* kOutput = "Output";
constexpr const char* kOptions = "Options";
constexpr const char* kRays = "Rays";
constexpr const char* kComparison = "Segmentation and comparison";
constexpr const char* kEveryCommand = "Every command";

// Group of each option that several commands share, by its long name.
const std::map<std::string, std::string>& Groups() {
  static const std::map<std::string, std::string> kGroups = [] {
    std::map<std::string, std::string> by_name;
    const auto add = [&](const char* group, std::initializer_list<const char*> names) {
      for (const char* name : names) by_name[name] = group;
    };
    const auto add_struct = [&](const char* group, auto options) {
      decltype(options)::Visit(options, [&](const OptionInfo& info, const auto&) {
        by_name[OptionFlag(info.name).substr(2)] = group;
      });
    };
    add_struct(kComparison, workflow::ComparisonOptions{});
    add_struct(kRays, workflow::RayOptions{});
    add(kInput,
        {"real",        "sim",    "scene",        "scene-unit", "scene-up",         "sonar",
         "params",      "poses",  "recording",    "recordings", "background",       "target",
         "topic",       "mirror", "sample-order", "plan",       "picture-geometry", "images",
         "camera",      "mount",  "markers",      "port",       "trajectory",       "trajectory-format",
         "pose-topic",  "frames", "known",        "frame",      "pose-frames",      "train",
         "train-masks", "test",   "test-masks"});
    add(kOutput, {"out", "force", "resume", "fan", "depth", "bits", "pictures", "sweep-csv"});
    add(kEveryCommand, {"help", "json", "quiet", "verbose", "log", "options"});
    return by_name;
  }();
  return kGroups;
}

}  // namespace

void GroupOptions(CLI::App& command) {
  for (CLI::Option* option : command.get_options([](const CLI::Option*) { return true; })) {
    if (option->get_positional() || option->get_lnames().empty() || option->get_group().empty()) continue;
    const auto group = Groups().find(option->get_lnames().front());
    option->group(group == Groups().end() ? kOptions : group->second);
  }
}

const std::vector<std::string>& OptionGroups() {
  static const std::vector<std::string> kGroups = {kInput, kOutput,     kOptions,
                                                   kRays,  kComparison, kEveryCommand};
  return kGroups;
}

}  // namespace sonarcal::cli
