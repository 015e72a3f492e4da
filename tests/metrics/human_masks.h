// Fan pictures of objects in a water tank that people outlined (recordings/aris3000_watertank): folders
// Images, Masks (pixels of classes: 0 background, 1 to 10 objects, 11 wall) and BoxAnnotations, a file of
// each with one name.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/types/image.h"
#include "core/types/mask.h"

namespace sonarcal::testing {

struct HumanMask {
  std::string name;
  int number = 0;    // the last in the name
  PolarImage image;  // 128 beams, two picture pixels a range bin; ranges in hundreds of pixels, as metres are
                     // not recorded
  Mask box;          // polar: within the annotated boxes, wider by 10 picture pixels on each side

  // All of the picture's pixels within the fan.
  std::vector<int> polar_index;      // of the polar pixel each lies in
  std::vector<std::uint8_t> object;  // of classes 1 to 10
  std::vector<std::uint8_t> in_box;
};

// In the order of their numbers. Throws DataError where a file is absent or damaged, or shows no fan.
std::vector<HumanMask> ReadHumanMasks(const std::filesystem::path& folder);

struct Agreement {
  double iou = 0.0;
  double precision = 0.0;  // 0 where nothing was found
  double recall = 0.0;
};

// Of a region found in the polar image with the people's, over picture pixels; in the box, or everywhere.
Agreement Agree(const HumanMask& picture, const Mask& found, bool in_box);

}  // namespace sonarcal::testing
