// Detector that learns from labelled frames which pixels belong to an object: a random forest (Breiman,
// Machine Learning 45(1), 2001; OpenCV's RTrees) on local features of the polar image.
//
// Features of a pixel, fractions of full scale: its value above the median of the frame, box means of 3, 9
// and 27 pixels against the median and against each other, and the standard deviation in boxes of 9 and 27
// pixels. They do not depend on an offset of the display, but on its gain. They are read in bins and beams:
// frames for training and test should have cells of similar size.
#pragma once

#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "core/types/image.h"
#include "core/types/mask.h"

namespace sonarcal::metrics {

struct LabelledFrame {
  Grid<float> value;  // range_bins x beam_count
  double full_scale = 255.0;
  Mask object;  // same shape
  std::optional<double> time_s = {};
};

inline constexpr int kPixelFeatures = 7;

// Features of all pixels: one row per pixel, row by row. `value` must not be empty, full_scale > 0.
Grid<float> PixelFeatures(const Grid<float>& value, double full_scale);

class PixelDetector {
 public:
  // Draws at most 400 object pixels and 400 others of each frame. The same frames give the same detector.
  // Throws DataError if the frames have no object pixel or only object pixels; `use` says what they are for:
  // "training" or "test".
  PixelDetector(const std::vector<const LabelledFrame*>& frames, std::string_view use);
  ~PixelDetector();
  PixelDetector(const PixelDetector&) = delete;
  PixelDetector& operator=(const PixelDetector&) = delete;
  PixelDetector(PixelDetector&&) noexcept;
  PixelDetector& operator=(PixelDetector&&) noexcept;

  // Score of each pixel, 0 .. 1: mean share of objects in the leaves. No probability, because objects are
  // drawn more often than they occur.
  Grid<float> Score(const LabelledFrame& frame) const;

 private:
  struct Forest;
  std::unique_ptr<Forest> forest_;
};

}  // namespace sonarcal::metrics
