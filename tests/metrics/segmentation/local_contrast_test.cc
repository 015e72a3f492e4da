#include "metrics/segmentation/local_contrast.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "metrics/segmentation/segmentation.h"
#include "tests/metrics/metrics_testing.h"

namespace sonarcal::metrics {
namespace {

using ::testing::HasSubstr;

// The ring of each pixel gathered by itself.
TEST(LocalContrastTest, AgreesWithTheRingGatheredPixelByPixel) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<float> any(0.0f, 255.0f);
  Grid<float> value(20, 15);
  for (float& v : value.values()) v = any(random);
  Mask valid(20, 15, 1);
  for (int row = 0; row < 20; ++row) valid(row, row % 15) = 0;
  const TrainingShape ring = {2, 1, 3, 4};
  const Grid<float> contrast = LocalContrast(value, ring, &valid);
  for (int row = 0; row < 20; ++row) {
    for (int col = 0; col < 15; ++col) {
      double sum = 0.0;
      int count = 0;
      for (int r = std::max(0, row - 5); r <= std::min(19, row + 5); ++r) {
        for (int c = std::max(0, col - 5); c <= std::min(14, col + 5); ++c) {
          if (std::abs(r - row) <= 2 && std::abs(c - col) <= 1) continue;
          if (!valid(r, c)) continue;
          sum += value(r, c);
          ++count;
        }
      }
      ASSERT_NEAR(contrast(row, col), valid(row, col) ? value(row, col) - sum / count : 0.0, 1e-3);
    }
  }
}

TEST(LocalContrastTest, WithoutARingThereIsNoContrast) {
  const Grid<float> contrast = LocalContrast(Grid<float>(3, 3, 9.0f), {5, 5, 1, 1});
  for (const float value : contrast.values()) EXPECT_EQ(value, 0.0f);
}

// A block on a ground that rises as much, over the image, as the block stands out.
TEST(LocalContrastTest, FindsABlockOnASlopeWhereNoSingleThresholdDoes) {
  Grid<float> value(120, 60);
  Mask block(120, 60);
  for (int row = 0; row < 120; ++row) {
    for (int col = 0; col < 60; ++col) {
      const bool inside = row >= 50 && row < 60 && col >= 25 && col < 33;
      block(row, col) = inside;
      value(row, col) = static_cast<float>(row) + (inside ? 60.0f : 0.0f);
    }
  }
  SegmentationOptions options;
  options.method = SegmentationMethod::kLocalContrast;
  options.blur_rows = options.blur_cols = 0.0;
  options.contrast = 0.12;
  EXPECT_EQ(Segment(value, 255.0, options).object, block);
  options.method = SegmentationMethod::kOtsu;
  EXPECT_NE(Segment(value, 255.0, options).object, block);
}

TEST(LocalContrastTest, DecibelNeedTheScale) {
  PolarImage image{testing::SmallAxes(60, 40), {}, Grid<float>(60, 40, 10.0f)};
  image.value(30, 20) = 10.0f + 255.0f / 80.0f * 6.0f;  // 6 dB
  SegmentationOptions options;
  options.method = SegmentationMethod::kLocalContrast;
  options.blur_rows = options.blur_cols = 0.0;
  options.contrast_db = 5.9;
  try {
    Segment(image, options);
    FAIL();
  } catch (const DataError& error) {
    EXPECT_THAT(error.what(), HasSubstr("5.9 dB, but the image does not state its dB scale"));
  }
  image.scale.db_min = -30.0;
  image.scale.db_max = 50.0;
  EXPECT_EQ(CountSet(Segment(image, options).object), 1);
  options.contrast_db = 6.1;
  EXPECT_EQ(CountSet(Segment(image, options).object), 0);
}

}  // namespace
}  // namespace sonarcal::metrics
