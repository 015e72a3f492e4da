// Recordings as people look at them: fan pictures, 8 bits of grey, one PNG a frame or a video. Beside them
// stands their geometry (data_io/pictures/picture_geometry.h), so that they can be read back.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "core/imaging/fan_image.h"
#include "core/types/recording.h"

namespace sonarcal::data_io {

// Draws frames that all have the recording's axes and scale. Full scale is 255; what is no grey value has no
// brightness, and is refused by DataError. Pictures have an even number of rows and columns, as videos need,
// the last ones black where the fan has an odd number.
class FanPainter {
 public:
  FanPainter(const RecordingInfo& info, const FanOptions& options);

  int rows() const { return rows_; }
  int cols() const { return cols_; }
  Grid<std::uint8_t> Paint(const Frame& frame) const;

  // sonar-picture-geometry/1 of these pictures. Beams are taken for even, and the fan reaches as far to
  // either side as the recording's does to the farther one.
  std::string GeometryJson() const;

 private:
  RecordingInfo info_;
  FanMap map_;
  int rows_;
  int cols_;
};

// fan_0000.png, fan_0001.png, ... and geometry.json in a folder that is there.
void WriteFanPngs(const RecordingSource& recording, const FanPainter& painter,
                  const std::filesystem::path& folder,
                  const std::function<void(int frames_done)>& progress = {});

// A video by FFmpeg, through OpenCV: MPEG-4 Part 2 in the container that the file's name tells (.mp4, .avi).
// It is not lossless. Throws DataError where the file cannot be written.
void WriteFanVideo(const RecordingSource& recording, const FanPainter& painter, double frames_per_s,
                   const std::filesystem::path& file,
                   const std::function<void(int frames_done)>& progress = {});

// Frames a second as recorded, by the median of the intervals; 0 where fewer than two frames have a time, or
// times do not rise.
double RecordedFramesPerS(const RecordingSource& recording);

}  // namespace sonarcal::data_io
