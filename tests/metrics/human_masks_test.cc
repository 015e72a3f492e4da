#include "tests/metrics/human_masks.h"

#include <gtest/gtest.h>

#include "metrics/segmentation/segmentation.h"
#include "tests/support/recordings.h"

namespace sonarcal::metrics {
namespace {

using testing::Agree;
using testing::Agreement;
using testing::HumanMask;

// Mean IoU over every second picture, from the `half`-th on.
double MeanIou(const std::vector<HumanMask>& pictures, const SegmentationOptions& options, std::size_t half,
               bool in_box) {
  double sum = 0.0;
  int count = 0;
  for (std::size_t i = half; i < pictures.size(); i += 2, ++count) {
    const HumanMask& picture = pictures[i];
    const Mask found = Segment(picture.image, options, in_box ? &picture.box : nullptr).object;
    sum += Agree(picture, found, in_box).iou;
  }
  return sum / count;
}

TEST(HumanMasksTest, EveryOutlineAgreesWithItself) {
  SONARCAL_NEEDS_RECORDING(folder, "aris3000_watertank");
  const std::vector<HumanMask> pictures = testing::ReadHumanMasks(folder);
  ASSERT_EQ(pictures.size(), 31U);
  for (const HumanMask& picture : pictures) {
    Mask of_people(picture.image.value.rows(), picture.image.value.cols());
    for (std::size_t i = 0; i < picture.polar_index.size(); ++i) {
      if (picture.object[i]) of_people.values()[picture.polar_index[i]] = 1;
    }
    // But for what polar pixels are coarser than the picture's.
    const Agreement everywhere = Agree(picture, of_people, false);
    EXPECT_EQ(everywhere.recall, 1.0) << picture.name;
    EXPECT_GT(everywhere.precision, 0.75) << picture.name;
    EXPECT_EQ(Agree(picture, of_people, true).recall, 1.0) << picture.name;
    EXPECT_EQ(Agree(picture, Mask(of_people.rows(), of_people.cols()), false).iou, 0.0);
  }
}

// Settings that scripts/segmentation.sh chose on the other half of the pictures.
TEST(HumanMasksTest, LocalContrastFindsTheObjectsThatPeopleOutlined) {
  SONARCAL_NEEDS_RECORDING(folder, "aris3000_watertank");
  const std::vector<HumanMask> pictures = testing::ReadHumanMasks(folder);
  SegmentationOptions options;
  options.method = SegmentationMethod::kLocalContrast;
  options.contrast = 0.08;
  options.guard_rows = options.guard_cols = 7;
  options.training_rows = options.training_cols = 4;
  options.blur_rows = options.blur_cols = 1.0;
  options.open_rows = options.open_cols = 3;
  options.close_rows = options.close_cols = 15;
  options.largest_component_only = false;
  options.fill = RegionFill::kHull;
  EXPECT_GT(MeanIou(pictures, options, 1, true), 0.43);

  options.contrast = 0.25;
  options.guard_rows = options.guard_cols = 3;
  options.training_rows = options.training_cols = 20;
  options.blur_rows = options.blur_cols = 0.5;
  options.open_rows = options.open_cols = 0;
  options.close_rows = options.close_cols = 11;
  options.max_rows = options.max_cols = 50;
  options.largest_component_only = true;
  EXPECT_GT(MeanIou(pictures, options, 1, false), 0.25);
}

}  // namespace
}  // namespace sonarcal::metrics
