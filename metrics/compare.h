// One simulated frame against one real frame. Who made the images does not matter here: real against real
// gives the noise floor.
//
// The object is looked for once, in the polar image, where the smoothing has its meaning in bins and beams;
// the fan's object regions are those, scan-converted (nearest). Fan pixels weigh an echo by its area, polar
// pixels by its angle, so the two views' figures differ. Polar figures are the first ones reported: nothing
// was interpolated.
//
// Only like is compared with like. A DataError says which field decides where the two frames differ in
// quantity, full scale, dB scale (where both state one) or geometry. Only grey images (display values) are
// compared: a level in dB is displayed first, so that "full scale" means something.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "data_io/fan_image.h"
#include "data_io/types/image.h"
#include "data_io/types/mask.h"
#include "metrics/intensity.h"
#include "metrics/occupancy.h"
#include "metrics/segmentation.h"

namespace sonarcal {

struct CompareOptions {
  SegmentationOptions segmentation;
  std::optional<Mask> region;  // where the object may be, range_bins x beam_count; absent: anywhere
  // Samples that hold a measurement in both images, of the same shape; absent: all. Others count nowhere.
  std::optional<Mask> valid;
  FanOptions fan;
  // The mean |difference| that is named "intensity_error"; the others are reported beside it.
  IntensityDomain intensity_domain = IntensityDomain::kUnion;
  double db_tolerance = 0.01;  // dB scales closer than this are the same
  bool keep_masks = false;     // for overlays

  // Throws DataError naming field, value and limit.
  void Check() const;
};

// What is measured in one view (polar or fan), of one frame or of several pooled.
struct ViewMetrics {
  Occupancy occupancy;
  IntensityError intensity;

  ViewMetrics& operator+=(const ViewMetrics& other);
};

struct FrameMasks {
  Mask polar_real;
  Mask polar_simulated;
  Mask fan_real;
  Mask fan_simulated;
};

struct FrameMetrics {
  int index = 0;     // the caller's number for the frame
  std::string name;  // and name, for people
  ViewMetrics polar;
  ViewMetrics fan;
  double threshold_real = 0.0;  // grey level above which a (smoothed) pixel was object
  double threshold_simulated = 0.0;
  std::vector<std::string> notes;   // one sentence each
  std::optional<FrameMasks> masks;  // where CompareOptions::keep_masks
};

// The dB between 0 and full scale, where the scale states them.
std::optional<double> DbSpan(const ImageScale& scale);

// Throws DataError where the two do not measure the same thing in the same way. `notes` (when given) receives
// a sentence where only one of the two states its dB scale.
void CheckComparable(const PolarImage& real, const PolarImage& simulated, double db_tolerance,
                     std::vector<std::string>* notes = nullptr);

// Compares frame after frame and keeps the fan's geometry from one to the next.
class FrameComparer {
 public:
  explicit FrameComparer(CompareOptions options);

  const CompareOptions& options() const { return options_; }

  // Throws DataError as described above, or where the region of interest has another shape.
  FrameMetrics Compare(const PolarImage& real, const PolarImage& simulated);

 private:
  const FanMap& MapFor(const PolarAxes& axes);

  CompareOptions options_;
  std::optional<FanMap> map_;
};

// For a single pair of frames.
FrameMetrics CompareFrames(const PolarImage& real, const PolarImage& simulated,
                           const CompareOptions& options = {});

}  // namespace sonarcal
