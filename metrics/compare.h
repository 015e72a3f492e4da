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

#include <array>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "core/imaging/fan_image.h"
#include "core/types/image.h"
#include "core/types/mask.h"
#include "core/types/words.h"
#include "metrics/measures/intensity.h"
#include "metrics/measures/level_histograms.h"
#include "metrics/measures/occupancy.h"
#include "metrics/measures/outline.h"
#include "metrics/measures/ssim.h"
#include "metrics/segmentation/object_region.h"
#include "metrics/segmentation/segmentation.h"
#include "metrics/speckle.h"
#include "metrics/threshold_sweep.h"

namespace sonarcal::metrics {

// Where the simulated object is.
enum class SimulatedObject {
  kSameRule,  // what the segmentation finds, as in the real image
  // Every pixel (of the region of interest) that shows more than echo_fraction: for simulations without
  // noise, in which a rule that asks how far an echo stands out of the background finds no background.
  // Neither smoothed nor tidied.
  kEchoes,
};
constexpr auto WordsOf(std::type_identity<SimulatedObject>) {
  return Words<SimulatedObject, 2>{
      {{"same_rule", SimulatedObject::kSameRule}, {"echoes", SimulatedObject::kEchoes}}};
}

struct CompareOptions {
  SegmentationOptions segmentation;
  std::optional<Mask> region;  // where the object may be, range_bins x beam_count; absent: anywhere
  // Set: the object is searched in a box of each frame, and in `region` where that is set too. Who compares
  // the frames gives the boxes.
  std::optional<ObjectSearch> object = {};
  // Samples that hold a measurement in both images, of the same shape; absent: all. Others count nowhere.
  std::optional<Mask> valid;
  FanOptions fan;
  SimulatedObject simulated_object = SimulatedObject::kSameRule;
  double echo_fraction = 0.0;  // kEchoes: of full scale, 0..1; 0: whatever the display shows at all
  // Where set, the real object is looked for within this distance of the simulated one, along range and along
  // the arc (metrics/segmentation/region.h): m, 0..100. Where there is no simulated object, there is no real
  // one. What the image tells of a threshold (its background, Otsu's) it tells from the whole of `region` all
  // the same.
  std::optional<double> region_margin_m = {};
  SweepOptions sweep = {};
  // The mean |difference| that is named "intensity_error"; the others are reported beside it.
  IntensityDomain intensity_domain = IntensityDomain::kUnion;
  double db_tolerance = 0.01;  // dB scales closer than this are the same
  bool keep_masks = false;     // for overlays

  // Throws DataError naming field, value and limit.
  void Check() const;
};

// What is measured in one view (polar or fan), of one frame or of several pooled. metrics/figures.h names the
// figures that follow from it.
struct ViewMetrics {
  Occupancy occupancy;
  OutlineDistance outline;  // of the polar view; nothing in the fan, whose regions are the same
  IntensityError intensity;
  StructuralSimilarity ssim;
  SpeckleMeasures speckle;  // of the polar view; without blocks in the fan
  // By LevelDomain. Distances do not add up: pooled frames have none but those of their pooled levels.
  std::array<LevelDistances, kLevelDomains.size()> distribution;

  ViewMetrics& operator+=(const ViewMetrics& other);
};

struct FrameMasks {
  Mask polar_real;
  Mask polar_simulated;
  Mask fan_real;
  Mask fan_simulated;
};

// Levels of both views, of one frame or of several pooled.
struct FrameLevels {
  LevelHistograms polar;
  LevelHistograms fan;

  FrameLevels& operator+=(const FrameLevels& other);
};

struct FrameMetrics {
  int index = 0;                 // the caller's number for the frame
  std::string name;              // and name, for people
  std::optional<double> time_s;  // of the recorded frame, where the caller knows it
  ViewMetrics polar;
  ViewMetrics fan;
  double threshold_real = 0.0;  // what a pixel's score (metrics/segmentation/scored_image.h) had to be above
  double threshold_simulated = 0.0;
  std::vector<std::string> notes;      // one sentence each
  std::optional<PixelBox> object_box;  // where the object was searched, with CompareOptions::object
  // Polar counts at the settings of CompareOptions::sweep; whoever compares many frames adds them up
  // (metrics/threshold_sweep.h) and lets go of each frame's.
  std::vector<Occupancy> sweep;
  std::optional<FrameMasks> masks;  // where CompareOptions::keep_masks
  // Of pixels; whoever compares many frames pools them (metrics/aggregate.h) and lets go of each frame's.
  std::optional<FrameLevels> levels;
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

  // `box`: of this frame, where the object is searched; null: in the whole region of interest. Throws
  // DataError as described above, or where the region of interest has another shape.
  FrameMetrics Compare(const PolarImage& real, const PolarImage& simulated, const PixelBox* box = nullptr);

 private:
  const FanMap& MapFor(const PolarAxes& axes);

  CompareOptions options_;
  std::optional<FanMap> map_;
};

// For a single pair of frames.
FrameMetrics CompareFrames(const PolarImage& real, const PolarImage& simulated,
                           const CompareOptions& options = {});

}  // namespace sonarcal::metrics
