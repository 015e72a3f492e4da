// Segmentation methods, their settings and names. metrics/segmentation/segmentation.h describes the steps.
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
  // least min_contrast above the median. A simulated image without noise then has an object too.
  kBackgroundSigma,
  // Otsu 1979: the threshold that maximises the variance between the two classes, over the valid pixels of
  // the region. For images in which object and background fill comparable areas.
  kOtsu,
  // threshold_fraction of full scale.
  kFixedThreshold,
  // Zack, Rogers & Latt 1977 (metrics/segmentation/threshold.h), over the valid pixels of the region: the
  // threshold where the histogram bends most. For objects that fill a small part of the image.
  kTriangle,
  // Pixels at least `contrast` above the mean of the ring around them
  // (metrics/segmentation/local_contrast.h).
  kLocalContrast,
  // Cell-averaging and ordered-statistic CFAR (metrics/segmentation/cfar.h): compares a cell with training
  // cells around it, at a given false-alarm rate. Polar images only.
  kCaCfar,
  kOsCfar,
  // Compares a cell with the background distribution fitted to pings without targets
  // (metrics/segmentation/likelihood_ratio.h), at a given false-alarm rate. Polar images only.
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

// True if the method's setting is a false-alarm rate: kCaCfar, kOsCfar, kLikelihoodRatio.
bool StatesFalseAlarmRate(SegmentationMethod method);

// Sample from which kBackgroundSigma estimates the background.
enum class BackgroundSample {
  // median and 1.4826 x median absolute deviation over the valid pixels of the region; the object must fill
  // less than half of them
  kRobust,
  kOutsideRegion,  // median and standard deviation over the valid pixels outside the region
};
constexpr auto WordsOf(std::type_identity<BackgroundSample>) {
  return Words<BackgroundSample, 2>{
      {{"robust", BackgroundSample::kRobust}, {"outside_region", BackgroundSample::kOutsideRegion}}};
}

// Quantity that CFAR tests: received power if the display is known, otherwise grey levels, which are assumed
// to be a logarithm of unknown slope.
enum class CfarDomain {
  kAuto,  // kPower if the image states its dB scale, otherwise kGrey
  kPower,
  kGrey,
};
constexpr auto WordsOf(std::type_identity<CfarDomain>) {
  return Words<CfarDomain, 3>{
      {{"auto", CfarDomain::kAuto}, {"power", CfarDomain::kPower}, {"grey", CfarDomain::kGrey}}};
}

// Filling of each region found.
enum class RegionFill {
  kNone,
  kHoles,  // background enclosed by the region
  kHull,   // convex hull: for objects of which a sonar shows only the edges
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
  double blur_cols = 1.0;  // standard deviation along columns (beams)

  int open_rows = 0;    // height of the opening's rectangle; 0 or 1: none
  int open_cols = 0;    // width of the opening's rectangle
  int close_rows = 7;   // height of the closing's rectangle; 0 or 1: none
  int close_cols = 3;   // width of the closing's rectangle
  int min_area_px = 0;  // removes components with fewer pixels
  int max_rows = 0;     // removes components with more rows, e.g. walls if an object's size is known; 0: none
  int max_cols = 0;     // removes components with more columns; 0: none
  bool largest_component_only = true;
  RegionFill fill = RegionFill::kNone;

  // kLocalContrast: contrast above the ring's mean as a fraction of full scale, 0..1; or, if set, in dB,
  // 0..200, for images that state their dB scale.
  double contrast = 0.1;
  std::optional<double> contrast_db = {};

  // kLocalContrast, kCaCfar, kOsCfar: guard cells on each side of the tested one, and training cells beyond
  // them. Guard cells exclude the object's own echoes: use half the object's size or more.
  int guard_rows = 12;     // range bins, 0..1000
  int guard_cols = 8;      // beams
  int training_rows = 24;  // range bins, 0..1000; not both 0
  int training_cols = 12;  // beams

  // kCaCfar, kOsCfar, kLikelihoodRatio: probability that a background cell is called object.
  double false_alarm_rate = 1e-3;  // more than 0, less than 1
  int cell_rows = 1;               // size of the tested cell, whose mean is used; odd
  int cell_cols = 1;
  // kCaCfar, kOsCfar: looks per pixel, kMinLooks..kMaxLooks. kLikelihoodRatio uses those of its law.
  double looks = 1.0;
  double os_quantile = 0.75;  // kOsCfar: quantile of the training cells, 0.01..0.99
  CfarDomain cfar_domain = CfarDomain::kAuto;

  std::shared_ptr<const BackgroundLaw> background_law = {};  // required by kLikelihoodRatio

  // Throws DataError that names the field, its value and the limit.
  void Check() const;
};

}  // namespace sonarcal::metrics
