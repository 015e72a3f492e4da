// The floor of a comparison, drawn from a fitted speckle law, for a recording that holds no frames of one
// still scene: what the figures would be if the simulation were the truth.
//
// A simulated frame shows the mean over speckle. The power behind each of its pixels follows from the display
// law; powers of the fitted number of looks are drawn about it, pixel by pixel, and displayed, clipped and
// rounded as a recording is. The drawn frame then stands in the part of the real one. Pixels are drawn one by
// one: the grain of beam and pulse is not in it, which matters to SSIM and to outlines after smoothing.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <vector>

#include "core/types/parameters.h"
#include "core/types/recording.h"
#include "metrics/noise_floor.h"

namespace sonarcal::workflow {

// Grey levels that the speckle of a law makes of a mean image.
class SpeckleDraw {
 public:
  // `full_scale` > 0 is the display's largest value. Throws DataError for looks that are not positive.
  SpeckleDraw(const ParameterSet& parameters, double full_scale);

  // One draw; the same seed gives the same image on every machine. Values of `mean` beyond 0 .. full_scale
  // count as those.
  Grid<float> Draw(const Grid<float>& mean, std::uint64_t seed) const;

 private:
  double full_scale_;
  int levels_;                                  // but for level 0
  std::vector<std::vector<float>> cumulative_;  // by mean value: chance of at most each level
};

// At most `max_frames` of `frames`, evenly spread; each compared with its draw by `options`, with
// CompareOptions::object in its box.
metrics::DrawnFloor DrawFloor(const RecordingSource& simulated, const std::vector<int>& frames,
                              const ParameterSet& parameters, const metrics::CompareOptions& options,
                              const std::map<int, metrics::PixelBox>& boxes = {}, int max_frames = 100);

}  // namespace sonarcal::workflow
