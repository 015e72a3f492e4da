#include "metrics/segmentation/threshold.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>
#include <vector>

#include <opencv2/imgproc.hpp>

namespace sonarcal::metrics {
namespace {

// Two overlapping bumps of grey levels, as 8-bit values.
std::vector<float> TwoBumps(std::uint64_t seed, int count) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> dark(60.0, 20.0), bright(150.0, 30.0);
  std::vector<float> values;
  for (int i = 0; i < count; ++i) {
    const double value = i % 4 == 0 ? bright(random) : dark(random);
    values.push_back(static_cast<float>(std::round(std::clamp(value, 0.0, 255.0))));
  }
  return values;
}

// Otsu's definition, word for word: every value that occurs is tried.
double ExhaustiveOtsu(const std::vector<float>& values) {
  const std::set<float> candidates(values.begin(), values.end());
  double best = -1.0;
  double threshold = 0.0;
  for (const float candidate : candidates) {
    double below = 0.0, below_sum = 0.0, above = 0.0, above_sum = 0.0;
    for (const float value : values) {
      (value <= candidate ? below : above) += 1.0;
      (value <= candidate ? below_sum : above_sum) += value;
    }
    if (above == 0.0) continue;
    const double w0 = below / (below + above);
    const double w1 = above / (below + above);
    const double distance = above_sum / above - below_sum / below;
    const double variance = w0 * w1 * distance * distance;
    if (variance > best * (1.0 + 1e-12)) {
      best = variance;
      threshold = candidate;
    }
  }
  return threshold;
}

TEST(OtsuTest, AgreesWithTheExhaustiveSearch) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const std::vector<float> values = TwoBumps(seed, 400);
    EXPECT_EQ(OtsuThreshold(values), ExhaustiveOtsu(values)) << "seed " << seed;
  }
}

TEST(OtsuTest, AgreesWithOpenCvOnAnEightBitImage) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const std::vector<float> values = TwoBumps(seed, 5000);
    cv::Mat1b image(1, static_cast<int>(values.size()));
    for (int i = 0; i < image.cols; ++i) image(0, i) = static_cast<std::uint8_t>(values[i]);
    cv::Mat1b binary;
    const double reference = cv::threshold(image, binary, 0.0, 255.0, cv::THRESH_BINARY | cv::THRESH_OTSU);
    EXPECT_EQ(OtsuThreshold(values), reference) << "seed " << seed;
  }
}

TEST(OtsuTest, TwoValuesAreTakenApartAndScalingTheValuesScalesTheThreshold) {
  EXPECT_EQ(OtsuThreshold({3.0f, 3.0f, 3.0f, 9.0f}), 3.0);
  std::vector<float> values = TwoBumps(7, 1000);
  const double threshold = OtsuThreshold(values);
  for (float& value : values) value *= 16.0f;
  EXPECT_EQ(OtsuThreshold(values), 16.0 * threshold);
}

TEST(OtsuTest, ValuesMayBeNegative) {
  EXPECT_EQ(OtsuThreshold({-9.0f, -9.0f, -8.0f, -3.0f, -2.0f}), -8.0);
  EXPECT_EQ(OtsuThreshold({-1.0f, 2.0f, 2.0f}), -1.0);
}

TEST(OtsuTest, OfEquallyGoodThresholdsTheLowestIsTaken) {
  EXPECT_EQ(OtsuThreshold({1.0f, 5.0f, 9.0f}), 1.0);  // 2 x 6^2 either way
}

// Values nearer than the classes: the threshold is the highest value of its class.
TEST(OtsuTest, ValuesOfOneClassStayTogether) {
  EXPECT_EQ(OtsuThreshold({10.0f, 10.01f, 10.005f, 900.0f, 900.02f}), static_cast<double>(10.01f));
}

TEST(OtsuTest, NothingIsAboveTheThresholdOfAConstant) {
  EXPECT_EQ(OtsuThreshold({5.0f, 5.0f}), 5.0);
}

// The threshold by OpenCV. `values` are whole numbers from 0 to 255.
double OpenCvTriangle(const std::vector<float>& values) {
  cv::Mat1b image(1, static_cast<int>(values.size()));
  for (int i = 0; i < image.cols; ++i) image(0, i) = static_cast<std::uint8_t>(values[i]);
  cv::Mat1b binary;
  return cv::threshold(image, binary, 0.0, 255.0, cv::THRESH_BINARY | cv::THRESH_TRIANGLE);
}

TEST(TriangleTest, AgreesWithOpenCvOnAnEightBitImage) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    std::vector<float> values = TwoBumps(seed, 5000);
    if (seed % 2 == 0) {  // the longer tail below
      for (float& value : values) value = 255.0f - value;
    }
    const double reference = OpenCvTriangle(values);
    EXPECT_NEAR(TriangleThreshold(values, 255.0), reference, 1e-9) << "seed " << seed;
    for (float& value : values) value *= 16.0f;
    EXPECT_NEAR(TriangleThreshold(values, 16.0 * 255.0), 16.0 * reference, 1e-9) << "seed " << seed;
  }
}

// Few values, of which each moves the line: the longer tail on either side, and ends beside 0 and full scale.
TEST(TriangleTest, AgreesWithOpenCvOnSparseHistograms) {
  std::mt19937_64 random(3);
  for (int trial = 0; trial < 300; ++trial) {
    const int first = trial % 4, last = 255 - trial / 4 % 4;
    std::vector<float> values = {static_cast<float>(first), static_cast<float>(last)};
    const int top = 20 + static_cast<int>(random() % 216);
    values.insert(values.end(), 30, static_cast<float>(top));
    for (int i = 0; i < 120; ++i) values.push_back(static_cast<float>(first + random() % (last - first + 1)));
    EXPECT_NEAR(TriangleThreshold(values, 255.0), OpenCvTriangle(values), 1e-9) << "trial " << trial;
  }
}

// Levels piled up at 0 and at full scale, where the histogram has no empty class beside them.
TEST(TriangleTest, AgreesWithOpenCvWhereLevelsReachTheEnds) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    std::vector<float> values = TwoBumps(seed, 5000);
    for (float& value : values) {
      value = std::clamp(seed % 2 == 0 ? 1.7f * value - 70.0f : 290.0f - 1.6f * value, 0.0f, 255.0f);
      value = std::round(value);
    }
    EXPECT_NEAR(TriangleThreshold(values, 255.0), OpenCvTriangle(values), 1e-9) << "seed " << seed;
  }
}

// 100 at 10, then 10 a class to 14, nothing to 20: the corner is where the tail begins.
TEST(TriangleTest, TheCornerOfAnLIsFoundOneClassFurtherOut) {
  std::vector<float> values(100, 10.0f);
  for (const float level : {11.0f, 12.0f, 13.0f, 14.0f, 20.0f}) values.insert(values.end(), 2, level);
  EXPECT_NEAR(TriangleThreshold(values, 255.0), 12.0, 1e-9);
}

TEST(BackgroundTest, RobustStatisticsOfFewValuesEqualThoseByHand) {
  const Background odd = RobustBackground({1.0f, 2.0f, 3.0f, 4.0f, 1000.0f});
  EXPECT_EQ(odd.centre, 3.0);
  EXPECT_NEAR(odd.spread, 1.4826 * 1.0, 1e-9);  // deviations 2, 1, 0, 1, 997
  const Background even = RobustBackground({1.0f, 2.0f, 4.0f, 9.0f});
  EXPECT_EQ(even.centre, 3.0);
  EXPECT_NEAR(even.spread, 1.4826 * 1.5, 1e-9);  // deviations 2, 1, 1, 6
}

TEST(BackgroundTest, PlainStatisticsOfFewValuesEqualThoseByHand) {
  const Background plain = PlainBackground({1.0f, 2.0f, 4.0f, 9.0f});
  EXPECT_EQ(plain.centre, 3.0);
  EXPECT_NEAR(plain.spread, std::sqrt((9.0 + 4.0 + 0.0 + 25.0) / 4.0), 1e-12);  // mean 4
}

TEST(BackgroundTest, BothSpreadsAreTheStandardDeviationOfGaussianNoise) {
  std::mt19937_64 random(5);
  std::normal_distribution<float> noise(40.0f, 3.0f);
  std::vector<float> values(100000);
  for (float& value : values) value = noise(random);
  EXPECT_NEAR(RobustBackground(values).spread, 3.0, 0.05);
  EXPECT_NEAR(PlainBackground(values).spread, 3.0, 0.03);
  EXPECT_NEAR(PlainBackground(values).centre, 40.0, 0.05);
}

TEST(BackgroundTest, AThirdOfOutliersDoesNotMoveTheRobustOneFar) {
  std::mt19937_64 random(6);
  std::normal_distribution<float> noise(40.0f, 3.0f);
  std::vector<float> values(30000);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = i % 3 == 0 ? 250.0f : noise(random);
  EXPECT_NEAR(RobustBackground(values).centre, 42.0, 0.3);  // the 75th percentile of the noise
  EXPECT_LT(RobustBackground(values).spread, 8.0);
  EXPECT_GT(PlainBackground(values).spread, 90.0);
}

}  // namespace
}  // namespace sonarcal::metrics
