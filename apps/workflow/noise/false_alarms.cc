#include "apps/workflow/noise/false_alarms.h"

#include <algorithm>
#include <iterator>
#include <memory>

#include "apps/workflow/comparison_options.h"

namespace sonarcal::workflow {
namespace {

// Pixels of the window, without the cells that were left out.
Mask RegionOf(const calib::NoiseJudgement& judged) {
  const calib::NoiseCells& cells = judged.cells;
  Mask region(cells.axes.range_bins, cells.beams());
  for (int bin = cells.first_bin; bin < cells.last_bin; ++bin) {
    const int band = (bin - cells.first_bin) / cells.band_bins;
    for (int beam = 0; beam < cells.beams(); ++beam) {
      const std::size_t cell = static_cast<std::size_t>(band) * cells.beams() + beam;
      region(bin, beam) = judged.weight.empty() || judged.weight[cell] != 0.0 ? 1 : 0;
    }
  }
  return region;
}

}  // namespace

std::vector<metrics::FalseAlarmRate> MeasureFalseAlarms(const RecordingSource& recording,
                                                        const ParameterSet& parameters,
                                                        const calib::NoiseJudgement& judged,
                                                        const Listener& listener) {
  metrics::SegmentationOptions options;
  options.looks = parameters.receiver.looks;
  options.background_law = std::make_shared<metrics::BackgroundLaw>(
      BackgroundLawOf(parameters, recording.info().sonar.axes, "noise law"));
  metrics::FalseAlarmCounter counter(options, {std::begin(kCountedRates), std::end(kCountedRates)});
  const Mask region = RegionOf(judged);
  const int count = static_cast<int>(judged.frames.size());
  for (int i = 0; i < count; ++i) {
    counter.Add(recording.ReadFrame(judged.frames[i]).image, &region);
    listener.Progress("Segmenting", i + 1, count);
  }
  return counter.Rates();
}

}  // namespace sonarcal::workflow
