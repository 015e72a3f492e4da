// Floor of a comparison from a fitted speckle law, for recordings without frames of a static scene: the
// figures that a perfect simulation would reach.
//
// A simulated frame is the mean over speckle. The display law gives the mean power of each of its pixels. A
// power with the fitted number of looks is drawn per pixel, then displayed, clipped and rounded like a
// recording. The speckled sample then replaces the real frame in the comparison. Limit: pixels are
// independent, so the samples lack the speckle cell of beam and pulse. This affects SSIM, and outlines after
// smoothing.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <vector>

#include "core/types/parameters.h"
#include "core/types/recording.h"
#include "metrics/noise_floor.h"

namespace sonarcal::workflow {

// Draws speckled samples of a mean image with the speckle law of `parameters`.
class SpeckleDraw {
 public:
  // `full_scale` > 0 is the largest value of the display. Throws DataError if looks are not positive.
  SpeckleDraw(const ParameterSet& parameters, double full_scale);

  // Returns one sample. The same seed gives the same image on every machine. Clamps `mean` to 0 ..
  // full_scale.
  Grid<float> Draw(const Grid<float>& mean, std::uint64_t seed) const;

 private:
  double full_scale_;
  int levels_;                                  // without level 0
  std::vector<std::vector<float>> cumulative_;  // per mean value: probability of each level or a lower one
};

// Compares at most `max_frames` of `frames`, evenly spread, each with a speckled sample of itself by
// `options`. With CompareOptions::object, searches the object in its box.
metrics::DrawnFloor DrawFloor(const RecordingSource& simulated, const std::vector<int>& frames,
                              const ParameterSet& parameters, const metrics::CompareOptions& options,
                              const std::map<int, metrics::PixelBox>& boxes = {}, int max_frames = 100);

}  // namespace sonarcal::workflow
