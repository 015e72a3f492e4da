// A recording: what is known of sonar, water and scale, and frames that are read one at a time, so that a
// recording of any length is walked through in constant memory.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/types/image.h"
#include "core/types/mask.h"
#include "core/types/pose.h"
#include "core/types/sonar_model.h"
#include "core/types/sonar_settings.h"

namespace sonarcal {

struct RecordingInfo {
  std::string source;  // file or folder it was read from
  std::string format;  // "sonar-recording/1", "ARIS v5", ...
  SonarModel sonar;    // axes of the first frame
  ImageScale scale;
  SonarSettings settings;  // of the first frame
  std::optional<Water> water;
  std::optional<double> source_level_db;
  std::optional<std::string> scene_path;  // absolute, or relative to the working directory
  // Samples that hold a measurement, in every frame, range_bins x beam_count; absent: all do.
  std::optional<Mask> valid;
  bool synthetic = false;  // made by a simulation: said wherever the recording is named
  // What the recorder says of its own beams and display, where it says it (data_io/README.md has the meaning
  // for each format).
  std::vector<double> azimuth_psf;      // beam response by offset in beams; offset 0 at index size() / 2
  std::vector<double> beam_taper;       // level of each column, relative
  std::optional<double> display_gamma;  // grey value ~ amplitude^display_gamma
  // Whatever else the file says, for people: (name, value with unit).
  std::vector<std::pair<std::string, std::string>> details;
  // Quirks met while reading, one sentence each: fields that disagree, garbage, interpolated samples.
  std::vector<std::string> notes;
};

struct FrameInfo {
  std::string name;  // file name, or "frame 3"
  std::optional<double> time_s;
  std::optional<Pose> world_from_sonar;
  SonarSettings settings = {};
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

  // Reads a frame. Throws DataError where its data are damaged or do not fit the header.
  virtual Frame ReadFrame(int index) const = 0;
};

// A recording held in memory: what a simulation makes, and what tests use.
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
