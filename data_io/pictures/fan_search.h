// Finds the fan in pictures of a viewer, among text, scales and panels.
//
// A pixel is lit if it differs from the background. The background is the colour of most of the picture's
// border, or black. In pictures that were compressed with losses a channel must differ by more than 24 grey
// levels. So it must in other pictures if the outline is clearer then. Pixels that are lit in any of up to 32
// frames count.
//
// Two kinds of parts are left out as overlay, in pictures of up to 16 million pixels. One is small parts that
// are the same in all frames, such as range labels in a video, if most lit pixels change. The other is parts
// beside, below or beyond the fan, if the outline without them is clearer, or if it is as clear and they are
// as low as text.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/types/mask.h"
#include "core/types/rgb_image.h"
#include "data_io/pictures/fan_geometry.h"
#include "data_io/pictures/picture_frames.h"

namespace sonarcal::data_io {

class FanSearch {
 public:
  // Reads up to 32 frames of `pictures`, which must outlive this object. Throws DataError if one cannot be
  // read, or if they differ in size.
  explicit FanSearch(const PictureFrames& pictures);

  // Absent if there is no fan.
  const std::optional<FanGeometry>& fan() const { return fan_; }
  // Fractions of the outline that are lit in any of the frames.
  const FanVisibility& visibility() const { return visibility_; }

  // Lit pixels of a frame, without overlay. Throws DataError if its size differs.
  Mask LitPixels(int index) const;

 private:
  struct Differences;

  // Takes the fan of this tolerance if there is none yet, or if its outline is as visible as required.
  void TryTolerance(int tolerance, const Differences& differences, double min_visibility);

  const PictureFrames& pictures_;
  std::array<std::uint8_t, 3> background_ = {0, 0, 0};
  int tolerance_ = 0;  // grey levels from the background up to which a pixel is not lit
  Mask overlay_;       // pixels that are not of the fan
  std::optional<FanGeometry> fan_;
  FanVisibility visibility_;
};

// Up to `max_count` frames, evenly spread.
std::vector<int> EvenlySpreadFrames(const PictureFrames& pictures, int max_count);

// Throws DataError that names the sizes.
[[noreturn]] void FailOfPictureSize(int rows, int cols, int first_rows, int first_cols,
                                    const std::string& name);

}  // namespace sonarcal::data_io
