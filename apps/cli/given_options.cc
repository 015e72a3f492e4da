#include "apps/cli/given_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include <CLI/CLI.hpp>

#include "core/types/error.h"

namespace sonarcal::cli {
namespace {

bool Holds(const OptionNames& names, const CLI::Option& option) {
  return std::any_of(names.begin(), names.end(),
                     [&](std::string_view name) { return option.check_name(std::string(name)); });
}

template <typename Condition>
void RefuseWhere(const CLI::App& command, std::string_view why, Condition is_refused) {
  for (const CLI::Option* option : command.get_options()) {
    if (option->count() > 0 && is_refused(*option))
      throw UsageError("{} has no effect {}", option->get_name(), why);
  }
}

}  // namespace

bool IsGiven(const CLI::App& command, std::string_view name) {
  return command.count(std::string(name)) > 0;
}

void RefuseGiven(const CLI::App& command, const OptionNames& names, std::string_view why) {
  RefuseWhere(command, why, [&](const CLI::Option& option) { return Holds(names, option); });
}

void RefuseGivenExcept(const CLI::App& command, const OptionNames& names, std::string_view why) {
  static const OptionNames kOfEveryCommand = {"--json",    "--quiet", "--verbose", "--log",
                                              "--options", "--force", "--help"};
  RefuseWhere(command, why, [&](const CLI::Option& option) {
    return !Holds(names, option) && !Holds(kOfEveryCommand, option);
  });
}

void RefuseUnusedSegmentation(const CLI::App& command, const workflow::ComparisonOptions& options) {
  using Method = metrics::SegmentationMethod;
  const Method method = options.Rule().method;
  const bool is_cfar = method == Method::kCaCfar || method == Method::kOsCfar;
  const bool has_rate = is_cfar || method == Method::kLikelihoodRatio;
  const bool has_ring = is_cfar || method == Method::kLocalContrast;
  const std::string why = fmt::format("with --segmentation {}", ToString(method));
  const auto refuse_unless = [&](bool is_used, const OptionNames& names) {
    if (!is_used) RefuseGiven(command, names, why);
  };
  refuse_unless(method == Method::kBackgroundSigma, {"--sigma-count"});
  refuse_unless(method == Method::kFixedThreshold, {"--threshold"});
  refuse_unless(method == Method::kLocalContrast, {"--contrast", "--contrast-db"});
  refuse_unless(has_rate, {"--false-alarm-rate", "--cell", "--background-params"});
  refuse_unless(has_ring, {"--guard", "--training"});
  refuse_unless(is_cfar, {"--looks", "--cfar-domain"});
  refuse_unless(method == Method::kOsCfar, {"--os-quantile"});
  refuse_unless(!has_rate, {"--blur"});
  if (options.simulated_object != metrics::SimulatedObject::kEchoes)
    RefuseGiven(command, {"--echo-level"}, "without --simulated-object echoes");
  if (options.object.empty()) RefuseGiven(command, {"--object-margin"}, "without --object");
}

void RefuseSceneFormatAlone(const CLI::App& command) {
  if (!IsGiven(command, "--scene")) RefuseGiven(command, {"--scene-unit", "--scene-up"}, "without --scene");
}

}  // namespace sonarcal::cli
