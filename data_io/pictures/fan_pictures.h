// Recordings as pictures for viewing: fan pictures with 8 bits of grey, one PNG per frame or a video. Their
// geometry is stored with them (data_io/pictures/picture_geometry.h), so they can be read back, within the
// limits that GeometryJson names.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "core/imaging/fan_image.h"
#include "core/types/recording.h"

namespace sonarcal::data_io {

// Draws frames with the recording's axes and scale. Full scale is 255. Throws DataError if the quantity is
// not grey, because it has no brightness. Pictures have an even number of rows and columns, as videos
// require; the last ones are black if the fan has an odd number.
class FanPainter {
 public:
  FanPainter(const RecordingInfo& info, const FanOptions& options);

  int rows() const { return rows_; }
  int cols() const { return cols_; }
  Grid<std::uint8_t> Paint(const Frame& frame) const;

  // sonar-picture-geometry/1 of these pictures. Assumes evenly spaced beams and a symmetrical fan, whose half
  // angle is the larger one of the recording. The reader refuses a half angle outside 0.5..89 degrees, and
  // more than 16384 beams or range bins.
  std::string GeometryJson() const;

 private:
  RecordingInfo info_;
  FanMap map_;
  int rows_;
  int cols_;
};

// Writes fan_0000.png, fan_0001.png, ... and geometry.json into an existing folder.
void WriteFanPngs(const RecordingSource& recording, const FanPainter& painter,
                  const std::filesystem::path& folder,
                  const std::function<void(int frames_done)>& progress = {});

// Writes a video by FFmpeg through OpenCV: MPEG-4 Part 2, in the container given by the file extension (.mp4,
// .avi). Not lossless. Throws DataError if the file cannot be written.
void WriteFanVideo(const RecordingSource& recording, const FanPainter& painter, double frames_per_s,
                   const std::filesystem::path& file,
                   const std::function<void(int frames_done)>& progress = {});

// Recorded frames per second: the reciprocal of the median interval between neighbouring frames. 0 if no two
// neighbours have a time, or times do not increase.
double RecordedFramesPerS(const RecordingSource& recording);

}  // namespace sonarcal::data_io
