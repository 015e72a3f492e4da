// Grey samples of a sensor_msgs/Image or CompressedImage.
#pragma once

#include <string>

#include "core/types/image.h"
#include "data_io/ros/ros_messages.h"

namespace sonarcal::data_io {

struct RosPicture {
  Grid<float> value;          // row 0 is the picture's top row
  double full_scale = 255.0;  // 255 or 65535
};

// Encodings mono8, 8UC1, mono16 and 16UC1. Throws DataError, beginning with `where`, for any other, or if
// sizes are inconsistent.
RosPicture PictureOf(const RosImage& image, const std::string& where);

// Grey PNG of 8 or 16 bits, or grey JPEG, detected by its bytes, because `format` is free text. Sizes are
// checked before decoding.
RosPicture PictureOf(const RosCompressedImage& image, const std::string& where);

}  // namespace sonarcal::data_io
