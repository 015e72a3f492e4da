// Compares one simulated frame with one real frame. Any two images can be compared: real against real gives
// the noise floor.
//
// The object is searched once, in the polar image, where the smoothing is in bins and beams. The fan's object
// regions are scan-converted from it (nearest neighbour). A fan weights an echo by its area, a polar image by
// its angle, so the figures of the two views differ. Polar figures are reported first, because nothing is
// interpolated.
//
// Throws DataError, naming the field, if the two frames differ in quantity, full scale, dB scale (if both
// state one) or geometry. Only grey images (display values) are compared; a level in dB must be displayed
// first, so that full scale is defined.
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
#include "metrics/measures/echoes.h"
#include "metrics/measures/intensity.h"
#include "metrics/measures/level_histograms.h"
#include "metrics/measures/occupancy.h"
#include "metrics/measures/outline.h"
#include "metrics/measures/ssim.h"
#include "metrics/measures/texture.h"
#include "metrics/segmentation/object_region.h"
#include "metrics/segmentation/segmentation.h"
#include "metrics/speckle.h"
#include "metrics/threshold_sweep.h"

namespace sonarcal::metrics {

// Source of the simulated object region.
enum class SimulatedObject {
  kSameRule,  // segmentation, as for the real image
  // Every pixel of the region of interest above echo_fraction, without smoothing and tidying. For simulations
  // without noise: a rule that needs a background finds none in them.
  kEchoes,
};
constexpr auto WordsOf(std::type_identity<SimulatedObject>) {
  return Words<SimulatedObject, 2>{
      {{"same_rule", SimulatedObject::kSameRule}, {"echoes", SimulatedObject::kEchoes}}};
}

struct CompareOptions {
  SegmentationOptions segmentation;
  std::optional<Mask> region;  // region in which the object may be, range_bins x beam_count; absent: anywhere
  // If set, the object is searched in a box of each frame, and within `region` if that is set too. The caller
  // provides the boxes.
  std::optional<ObjectSearch> object = {};
  // Samples that hold a measurement in both images, of the same shape; absent: all. Others are ignored.
  std::optional<Mask> valid;
  FanOptions fan;
  SimulatedObject simulated_object = SimulatedObject::kSameRule;
  double echo_fraction = 0.0;  // kEchoes: fraction of full scale, 0..1; 0: every displayed echo
  // If set, the real object is searched within this distance of the simulated one, along range and along the
  // arc (metrics/segmentation/region.h): m, 0..100. Without a simulated object there is no real one.
  // Thresholds that depend on the image (its background, Otsu's) still use the whole `region`.
  std::optional<double> region_margin_m = {};
  SweepOptions sweep = {};
  // Domain of the mean |difference| that is named "intensity_error". The other domains are reported beside
  // it.
  IntensityDomain intensity_domain = IntensityDomain::kUnion;
  double db_tolerance = 0.01;  // dB scales closer than this are equal
  bool keep_masks = false;     // for overlays

  // Throws DataError that names the field, its value and the limit.
  void Check() const;
};

// Measurements of one view (polar or fan), of one frame or of several pooled. metrics/figures.h names the
// figures computed from them.
struct ViewMetrics {
  Occupancy occupancy;
  OutlineDistance outline;  // polar view only; the fan has the same regions
  IntensityError intensity;
  StructuralSimilarity ssim;
  EchoCounts echoes;
  TextureMeasures texture;
  SpeckleMeasures speckle;  // polar view only; without blocks in the fan
  // By LevelDomain. Distances do not add up: pooled frames have only those of their pooled levels.
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
  int index = 0;                 // frame number, chosen by the caller
  std::string name;              // frame name for display
  std::optional<double> time_s;  // time of the recorded frame, if known
  ViewMetrics polar;
  ViewMetrics fan;
  double threshold_real = 0.0;  // limit of the pixels' scores (metrics/segmentation/scored_image.h)
  double threshold_simulated = 0.0;
  std::vector<std::string> notes;      // one sentence each
  std::optional<PixelBox> object_box;  // search box of the object, with CompareOptions::object
  // Polar counts at the settings of CompareOptions::sweep. Callers with many frames add them up
  // (metrics/threshold_sweep.h) and discard each frame's.
  std::vector<Occupancy> sweep;
  std::optional<FrameMasks> masks;  // if CompareOptions::keep_masks
  // Histograms of pixel levels. Callers with many frames pool them (metrics/aggregate.h) and discard each
  // frame's.
  std::optional<FrameLevels> levels;
};

// dB between 0 and full scale, if the scale states them.
std::optional<double> DbSpan(const ImageScale& scale);

// Throws DataError if the images do not measure the same quantity in the same way. Adds a sentence to
// `notes`, if given, when only one of them states its dB scale.
void CheckComparable(const PolarImage& real, const PolarImage& simulated, double db_tolerance,
                     std::vector<std::string>* notes = nullptr);

// Compares frame after frame and reuses the fan's geometry.
class FrameComparer {
 public:
  explicit FrameComparer(CompareOptions options);

  const CompareOptions& options() const { return options_; }

  // `box`: search box of the object in this frame; null: the whole region of interest. Throws DataError as
  // described above, or if the region of interest has another shape.
  FrameMetrics Compare(const PolarImage& real, const PolarImage& simulated, const PixelBox* box = nullptr);

 private:
  const FanMap& MapFor(const PolarAxes& axes);

  CompareOptions options_;
  std::optional<FanMap> map_;
};

// Compares a single pair of frames.
FrameMetrics CompareFrames(const PolarImage& real, const PolarImage& simulated,
                           const CompareOptions& options = {});

}  // namespace sonarcal::metrics
