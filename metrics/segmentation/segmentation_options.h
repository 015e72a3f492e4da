// How an object is told from background: the methods, their settings and their names. What the steps are and
// what they do: metrics/segmentation/segmentation.h.
#pragma once

#include <memory>
#include <optional>
#include <string_view>
#include <type_traits>

#include "core/types/words.h"
#include "metrics/segmentation/background_law.h"

namespace sonarcal::metrics {

enum class SegmentationMethod {
  // Threshold = background median + sigma_count standard deviations of the (smoothed) background, and at
  // least min_contrast above the median, so that a simulated image without noise has an object too.
  kBackgroundSigma,
  // Otsu 1979: the threshold that maximises the variance between the two classes, over the valid pixels of
  // the region. Meant for images in which object and background fill comparable areas.
  kOtsu,
  // threshold_fraction of full scale.
  kFixedThreshold,
  // Zack, Rogers & Latt 1977 (metrics/segmentation/threshold.h), over the valid pixels of the region: where
  // the histogram
  // bends most. Meant for objects that fill little of the image.
  kTriangle,
  // A pixel against the mean of the ring around it, `contrast` or more above it
  // (metrics/segmentation/local_contrast.h).
  kLocalContrast,
  // Cell-averaging and ordered-statistic CFAR (metrics/segmentation/cfar.h): a cell against training cells
  // around it,
  // at a stated rate of false alarms. Polar images only.
  kCaCfar,
  kOsCfar,
  // A cell against the law of the background that was fitted to pings without targets
  // (metrics/segmentation/likelihood_ratio.h), at a stated rate of false alarms. Polar images only.
  kLikelihoodRatio,
};
constexpr auto WordsOf(std::type_identity<SegmentationMethod>) {
  return Words<SegmentationMethod, 8>{{{"background_sigma", SegmentationMethod::kBackgroundSigma},
                                       {"otsu", SegmentationMethod::kOtsu},
                                       {"fixed_threshold", SegmentationMethod::kFixedThreshold},
                                       {"triangle", SegmentationMethod::kTriangle},
                                       {"local_contrast", SegmentationMethod::kLocalContrast},
                                       {"ca_cfar", SegmentationMethod::kCaCfar},
                                       {"os_cfar", SegmentationMethod::kOsCfar},
                                       {"likelihood_ratio", SegmentationMethod::kLikelihoodRatio}}};
}

// Whether the method's setting is a rate of false alarms: kCaCfar, kOsCfar, kLikelihoodRatio.
bool StatesFalseAlarmRate(SegmentationMethod method);

// Where kBackgroundSigma learns what background is.
enum class BackgroundSample {
  kRobust,         // median and 1.4826 x median absolute deviation over the valid pixels of the region, of
                   // which the object must fill less than half
  kOutsideRegion,  // median and standard deviation over the valid pixels outside the region
};
constexpr auto WordsOf(std::type_identity<BackgroundSample>) {
  return Words<BackgroundSample, 2>{
      {{"robust", BackgroundSample::kRobust}, {"outside_region", BackgroundSample::kOutsideRegion}}};
}

// What CFAR tests: received power where the display is known, else grey levels, whose law is then taken for
// that of a logarithm of unknown slope.
enum class CfarDomain {
  kAuto,  // kPower where the image states its dB scale, else kGrey
  kPower,
  kGrey,
};
constexpr auto WordsOf(std::type_identity<CfarDomain>) {
  return Words<CfarDomain, 3>{
      {{"auto", CfarDomain::kAuto}, {"power", CfarDomain::kPower}, {"grey", CfarDomain::kGrey}}};
}

// What becomes of each region found.
enum class RegionFill {
  kNone,
  kHoles,  // background that the region encloses belongs to it
  kHull,   // its convex hull: for objects of which a sonar shows the edges alone
};
constexpr auto WordsOf(std::type_identity<RegionFill>) {
  return Words<RegionFill, 3>{
      {{"none", RegionFill::kNone}, {"holes", RegionFill::kHoles}, {"hull", RegionFill::kHull}}};
}

struct SegmentationOptions {
  SegmentationMethod method = SegmentationMethod::kBackgroundSigma;

  BackgroundSample background = BackgroundSample::kRobust;  // kBackgroundSigma
  double sigma_count = 4.0;                                 // kBackgroundSigma; > 0
  double min_contrast = 1.0 / 255.0;                        // kBackgroundSigma; fraction of full scale, 0..1
  double threshold_fraction = 0.25;                         // kFixedThreshold; 0..1

  int median_px = 0;       // side of the median window: 0 (none), 3 or 5
  double blur_rows = 2.0;  // standard deviation of the Gaussian along rows (range bins); 0: none
  double blur_cols = 1.0;  // and along columns (beams)

  int open_rows = 0;    // height of the opening's rectangle; 0 or 1: none
  int open_cols = 0;    // and width
  int close_rows = 7;   // height of the closing's rectangle; 0 or 1: none
  int close_cols = 3;   // and width
  int min_area_px = 0;  // components with fewer pixels are dropped
  int max_rows = 0;  // and those that reach over more rows: walls, where an object's size is known; 0: none
  int max_cols = 0;  // or columns
  bool largest_component_only = true;
  RegionFill fill = RegionFill::kNone;

  // kLocalContrast: above the ring's mean, in parts of full scale, 0..1; or, where set, in dB, 0..200, for
  // images that state their dB scale.
  double contrast = 0.1;
  std::optional<double> contrast_db = {};

  // kLocalContrast, kCaCfar, kOsCfar: cells on each side of the tested one that are left out, and beyond
  // these the cells learnt from. Guard cells keep an object's own echoes out: half its size or more.
  int guard_rows = 12;     // range bins, 0..1000
  int guard_cols = 8;      // beams
  int training_rows = 24;  // range bins, 0..1000; not both 0
  int training_cols = 12;  // beams

  // kCaCfar, kOsCfar, kLikelihoodRatio: chance that a cell of nothing but background is called object.
  double false_alarm_rate = 1e-3;  // more than 0, less than 1
  int cell_rows = 1;               // the tested cell: the mean of so many pixels, odd
  int cell_cols = 1;
  // kCaCfar, kOsCfar: looks in a pixel, 0.5..1000; kLikelihoodRatio takes its law's.
  double looks = 1.0;
  double os_quantile = 0.75;  // kOsCfar: of the training cells, 0.01..0.99
  CfarDomain cfar_domain = CfarDomain::kAuto;

  std::shared_ptr<const BackgroundLaw> background_law = {};  // kLikelihoodRatio needs one

  // Throws DataError naming field, value and limit.
  void Check() const;
};

}  // namespace sonarcal::metrics
