// Thresholds from a sample of pixel values. A pixel above the threshold (not equal to it) is object.
#pragma once

#include <vector>

namespace sonarcal::metrics {

// Otsu 1979, "A threshold selection method from gray-level histograms": the threshold t that maximises
//   w0(t) w1(t) (m1(t) - m0(t))^2,
// with w and m the share and mean of the values <= t and of those > t; the lowest of equal maxima. Exact if
// different values are at least 1/4095 of the sample's span apart (any 8-bit image, and most 12-bit ones).
// Otherwise thresholds lie at the borders of 4096 classes, whose true means are used. `values` must be finite
// and not empty. If all are equal, returns that value, so nothing is above it.
double OtsuThreshold(const std::vector<float>& values);

// Zack, Rogers & Latt 1977, "Automatic measurement of sister chromatid exchange frequency": draws a line from
// the top of the histogram to the end of its longer tail. The threshold is one class beyond the point where
// the histogram lies farthest below the line. The histogram has 256 classes over 0..full_scale, so on 8-bit
// images this is OpenCV's THRESH_TRIANGLE. `values` must be finite, within 0..full_scale and not empty.
double TriangleThreshold(const std::vector<float>& values, double full_scale);

// Centre and spread of a sample that is mostly background: median and 1.4826 x median absolute deviation,
// which is the standard deviation for Gaussian values. `values` must not be empty.
struct Background {
  double centre = 0.0;
  double spread = 0.0;
};
Background RobustBackground(std::vector<float> values);

// Median and standard deviation, for a sample that is background only.
Background PlainBackground(std::vector<float> values);

}  // namespace sonarcal::metrics
