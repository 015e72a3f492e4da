// The long form of coverage_test.cc: prints a table as Markdown. scripts/coverage.sh runs it.
//
//   coverage_study [NAME=VALUE ...]   speckle=independent|grained sets= seed= beam_deg= pulse_bins= views=
//                                     scatter= starts= block_bins= block_beams= from=truth|readme
//                                     curves=small|tank test_others=0|1
#include <fmt/format.h>

#include <cstdlib>
#include <functional>
#include <map>
#include <string>

#include "tests/calib/coverage.h"

namespace sonarcal::testing {
namespace {

int Run(int argc, char** argv) {
  CoverageOptions options;
  options.fit.starts = 1;
  options.fit.threads = 1;
  const std::map<std::string, std::function<void(const std::string&)>> settings = {
      {"speckle",
       [&](const auto& v) { options.speckle = v == "grained" ? Speckle::kGrained : Speckle::kIndependent; }},
      {"sets", [&](const auto& v) { options.data_sets = std::stoi(v); }},
      {"seed", [&](const auto& v) { options.seed = std::stoull(v); }},
      {"beam_deg", [&](const auto& v) { options.beam_width_deg = std::stod(v); }},
      {"pulse_bins", [&](const auto& v) { options.pulse_bins = std::stod(v); }},
      {"views", [&](const auto& v) { options.views = std::stoi(v); }},
      {"scatter", [&](const auto& v) { options.prior_scatter = std::stod(v); }},
      {"starts", [&](const auto& v) { options.fit.starts = std::stoi(v); }},
      {"from", [&](const auto& v) { options.start = v == "readme" ? Start::kReadme : Start::kAboutTruth; }},
      {"curves", [&](const auto& v) { options.tank_curves = v == "tank"; }},
      {"test_others", [&](const auto& v) { options.fit.test_others = v != "0"; }},
      {"block_bins", [&](const auto& v) { options.fit.block_bins = std::stoi(v); }},
      {"block_beams", [&](const auto& v) { options.fit.block_beams = std::stoi(v); }}};
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    const std::size_t equals = argument.find('=');
    const auto setting = settings.find(argument.substr(0, equals));
    if (equals == std::string::npos || setting == settings.end()) {
      fmt::print(stderr, "coverage_study: unknown argument '{}', expected NAME=VALUE\n", argument);
      return 2;
    }
    setting->second(argument.substr(equals + 1));
  }
  const CoverageTable table = StudyCoverage(options);
  fmt::print(
      "{}\nFits without a solution: {} of {}. Mean square of all errors over the bound: {:.3f}. Of the "
      "curves' values from 5 to 80 degrees, {:.1f} % are within their 95 % bands.\n",
      Markdown(table), table.failed, table.data_sets, table.variance_over_bound,
      100.0 * table.curves_covered_95);
  return 0;
}

}  // namespace
}  // namespace sonarcal::testing

int main(int argc, char** argv) {
  return sonarcal::testing::Run(argc, argv);
}
