// Judges a noise law on pings without targets, without fitting it again (calib/noise/noise_judgement.h).
//
//   const FittedNoiseWindow window = ReadFittedWindow("noise/params.json");
//   const JudgedNoise judged = JudgeNoise(*recording, ReadParameters("noise/params.json"), {}, {}, window);
#pragma once

#include <filesystem>
#include <optional>
#include <utility>
#include <vector>

#include "apps/workflow/listener.h"
#include "calib/noise/noise_judgement.h"
#include "core/types/option.h"
#include "core/types/parameters.h"
#include "core/types/recording.h"
#include "metrics/false_alarms.h"
#include "sim/physics/speckle.h"

namespace sonarcal::workflow {

struct JudgeNoiseOptions {
  std::optional<double> range_min = {};
  std::optional<double> range_max = {};
  std::optional<sim::SpeckleLaw> speckle = {};
  bool false_alarms = false;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor&& visit) {
    visit(
        OptionInfo{
            .name = "range_min", .help = "Nearest range used", .unit = "m", .by_default = "that of the fit"},
        self.range_min);
    visit(
        OptionInfo{
            .name = "range_max", .help = "Farthest range used", .unit = "m", .by_default = "that of the fit"},
        self.range_max);
    visit(OptionInfo{.name = "speckle",
                     .help = "Speckle law",
                     .by_default = "that of the fit, without fit.json gamma"},
          self.speckle);
    visit(OptionInfo{.name = "false_alarms",
                     .help = "Also measures the share of pixels that each segmentation method takes for "
                             "object, beside the rate that it states"},
          self.false_alarms);
  }
};

// Part of the images that the fit of a law used, and its speckle law.
struct FittedNoiseWindow {
  std::filesystem::path file = {};  // fit.json; empty: there is none
  sim::SpeckleLaw speckle = sim::SpeckleLaw::kGamma;
  calib::NoiseWindow window = {};
  std::vector<std::pair<int, int>> left_out = {};  // cells: band, beam
};

// Reads fit.json beside the parameters, if it is that of a noise law.
FittedNoiseWindow ReadFittedWindow(const std::filesystem::path& params);

struct JudgedNoise {
  calib::NoiseLaw law;
  calib::NoiseJudgement judgement;
  std::vector<metrics::FalseAlarmRate> false_alarms = {};  // empty without the option
};

// `frames`: empty for all. Throws DataError if law, window and recording do not fit together.
JudgedNoise JudgeNoise(const RecordingSource& recording, const ParameterSet& parameters,
                       const std::vector<int>& frames = {}, const JudgeNoiseOptions& options = {},
                       FittedNoiseWindow fitted = {}, const Listener& listener = {});

}  // namespace sonarcal::workflow
