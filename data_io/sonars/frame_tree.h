// Coordinate frames that hang on each other, from the `transforms.yaml` of the DFKI UXO data set:
//
//   setup:
//     - frame_id: "setup/aris"
//       parent_frame_id: "setup/ar3"
//       translation: {x, y, z}       # metres
//       rotation: {x, y, z, w}       # a quaternion
//
// Lists of frames under any heading are read.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "core/types/pose.h"

namespace sonarcal::data_io {

class FrameTree {
 public:
  // Throws DataError with file and line where a value is no number, a frame lacks a part, stands twice, or
  // its quaternion is not of unit length to 1e-3.
  explicit FrameTree(const std::filesystem::path& file);

  // ancestor_from_frame; nothing where no chain leads up from one to the other.
  std::optional<Pose> Find(const std::string& ancestor, const std::string& frame) const;

 private:
  struct Frame {
    std::string parent;
    Pose parent_from_frame;
  };
  std::map<std::string, Frame> frames_;
};

}  // namespace sonarcal::data_io
