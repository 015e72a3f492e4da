// A recording: data about sonar, water and scale, and frames that are read one at a time. A recording of any
// length needs constant memory.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/types/image.h"
#include "core/types/mask.h"
#include "core/types/pings.h"
#include "core/types/pose.h"
#include "core/types/sonar_model.h"
#include "core/types/sonar_settings.h"

namespace sonarcal {

struct RecordingInfo {
  std::string source;  // file or folder
  std::string format;  // "sonar-recording/1", "ARIS v5", ...
  SonarModel sonar;    // axes of the first frame
  ImageScale scale;
  SonarSettings settings;  // settings of the first frame
  std::optional<Water> water;
  std::optional<double> source_level_db;
  std::optional<std::string> scene_path;  // absolute, or relative to the working directory
  // Samples that hold a measurement in every frame, range_bins x beam_count; absent: all.
  std::optional<Mask> valid;
  bool synthetic = false;  // made by a simulation; stated wherever the recording is named
  // Properties of beams and display that the recorder states (data_io/README.md explains them for each
  // format).
  std::vector<double> azimuth_psf;      // beam response by offset in beams; offset 0 at index size() / 2
  std::vector<double> beam_taper;       // relative level per beam
  std::optional<double> display_gamma;  // grey value ~ amplitude^display_gamma
  // Other content of the file, for display: (name, value with unit).
  std::vector<std::pair<std::string, std::string>> details;
  // Irregularities found while reading, one sentence each: fields that disagree, invalid data, interpolated
  // samples.
  std::vector<std::string> notes;
};

struct FrameInfo {
  std::string name;  // file name, or "frame 3"
  std::optional<double> time_s;
  std::optional<Pose> world_from_sonar;
  SonarSettings settings = {};
  std::optional<Motion> motion = {};  // of the sonar during the frame
};

struct Frame {
  FrameInfo info;
  PolarImage image;
};

class RecordingSource {
 public:
  virtual ~RecordingSource() = default;

  virtual const RecordingInfo& info() const = 0;
  virtual int frame_count() const = 0;

  // Header of a frame, without its pixels. 0 <= index < frame_count().
  virtual FrameInfo frame_info(int index) const = 0;

  // Reads a frame. Throws DataError if its data are damaged or do not match the header.
  virtual Frame ReadFrame(int index) const = 0;
};

// Recording in memory, for simulations and tests.
class MemoryRecording final : public RecordingSource {
 public:
  MemoryRecording(RecordingInfo info, std::vector<Frame> frames)
      : info_(std::move(info)), frames_(std::move(frames)) {}

  const RecordingInfo& info() const override { return info_; }
  int frame_count() const override { return static_cast<int>(frames_.size()); }
  FrameInfo frame_info(int index) const override { return frames_.at(index).info; }
  Frame ReadFrame(int index) const override { return frames_.at(index); }

 private:
  RecordingInfo info_;
  std::vector<Frame> frames_;
};

}  // namespace sonarcal
