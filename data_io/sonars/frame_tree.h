// Tree of coordinate frames, from the `transforms.yaml` of the DFKI UXO data set:
//
//   setup:
//     - frame_id: "setup/aris"
//       parent_frame_id: "setup/ar3"
//       translation: {x, y, z}       # metres
//       rotation: {x, y, z, w}       # a quaternion
//
// Reads lists of frames under any heading.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "core/types/pose.h"

namespace sonarcal::data_io {

class FrameTree {
 public:
  // Throws DataError with file and line if a value is not a number, a frame is incomplete or occurs twice, or
  // the length of its quaternion differs from 1 by more than 1e-3.
  explicit FrameTree(const std::filesystem::path& file);

  // ancestor_from_frame; nothing if no chain leads from one to the other.
  std::optional<Pose> Find(const std::string& ancestor, const std::string& frame) const;

 private:
  struct Frame {
    std::string parent;
    Pose parent_from_frame;
  };
  std::map<std::string, Frame> frames_;
};

}  // namespace sonarcal::data_io
