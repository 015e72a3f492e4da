#include "apps/workflow/noise/judge_noise.h"

#include <numeric>

#include "apps/workflow/noise/false_alarms.h"
#include "core/types/error.h"
#include "data_io/json/json_reader.h"

namespace sonarcal::workflow {
namespace {

std::vector<double> WeightOf(const FittedNoiseWindow& fitted, const calib::NoiseCells& cells,
                             const RecordingInfo& info) {
  std::vector<double> weight(cells.count(), 1.0);
  for (const auto& [band, beam] : fitted.left_out) {
    if (band >= cells.bands() || beam >= cells.beams()) {
      throw DataError(
          "{}: {} leaves out the cell of band {} and beam {}, but there are {} bands and {} beams, expected "
          "pings of the same geometry, or a --range-min and --range-max to judge without these cells",
          info.source, fitted.file.string(), band, beam, cells.bands(), cells.beams());
    }
    weight[static_cast<std::size_t>(band) * cells.beams() + beam] = 0.0;
  }
  return weight;
}

}  // namespace

FittedNoiseWindow ReadFittedWindow(const std::filesystem::path& params) {
  FittedNoiseWindow fitted;
  const std::filesystem::path file = params.parent_path() / "fit.json";
  if (!std::filesystem::exists(file)) return fitted;
  const data_io::JsonReader json = data_io::JsonReader::FromFile(file);
  const auto speckle = json.Find("speckle");
  const auto window = json.Find("window");
  if (!speckle || !window) return fitted;
  fitted.file = file;
  fitted.speckle = speckle->Word<sim::SpeckleLaw>();
  const std::vector<double> range_m = window->At("range_m").Numbers();
  if (range_m.size() != 2) window->At("range_m").Fail("is not two numbers");
  fitted.window.range_min_m = range_m[0];
  fitted.window.range_max_m = range_m[1];
  if (const auto bins = window->Find("band_bins"))
    fitted.window.band_bins = static_cast<int>(bins->Integer(1, 4096));
  if (const auto cells = window->Find("cells_left_out")) {
    for (const data_io::JsonReader& cell : cells->Items()) {
      const std::vector<double> place = cell.Numbers(data_io::NumberRange::Between(0, 1e6));
      if (place.size() != 2) cell.Fail("is not a band and a beam");
      fitted.left_out.emplace_back(static_cast<int>(place[0]), static_cast<int>(place[1]));
    }
  }
  return fitted;
}

JudgedNoise JudgeNoise(const RecordingSource& recording, const ParameterSet& parameters,
                       const std::vector<int>& frames, const JudgeNoiseOptions& options,
                       FittedNoiseWindow fitted, const Listener& listener) {
  if (options.range_min) fitted.window.range_min_m = options.range_min;
  if (options.range_max) fitted.window.range_max_m = options.range_max;
  if (options.range_min || options.range_max) fitted.left_out.clear();  // its bands are those of the fit
  JudgedNoise judged{.law = {.display = parameters.display,
                             .receiver = parameters.receiver,
                             .speckle = options.speckle.value_or(fitted.speckle)},
                     .judgement = {},
                     .false_alarms = {}};
  const RecordingInfo& info = recording.info();
  const calib::NoiseCells cells = calib::NoiseCellsOf(info, fitted.window);
  std::vector<int> pings = frames;
  if (pings.empty()) {
    pings.resize(static_cast<std::size_t>(recording.frame_count()));
    std::iota(pings.begin(), pings.end(), 0);
  }
  for (const int ping : pings) {
    if (ping >= 0 && ping < recording.frame_count()) continue;
    throw DataError("{}: frame {} is to be judged, but there are frames 0 to {}", info.source, ping,
                    recording.frame_count() - 1);
  }
  judged.judgement =
      calib::JudgeNoise(judged.law, recording, pings, cells, WeightOf(fitted, cells, info), 0.0,
                        [&](int done, int total) { listener.Progress("Judging", done, total); });
  if (options.false_alarms)
    judged.false_alarms = MeasureFalseAlarms(recording, parameters, judged.judgement, listener);
  return judged;
}

}  // namespace sonarcal::workflow
