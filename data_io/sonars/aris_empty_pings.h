// Pings of an ARIS recording that hold no samples, for example because packets were lost or the recorder
// failed.
//
// A frame lacks a ping if all samples of the ping's 16 beams are exactly 0, while more than half of the
// beams of the other pings hold a sample that is not 0. The beams of a ping are spread evenly over the fan.
// A scene that is dark, or lit in some directions only, therefore darkens the beams of all pings alike and
// lacks none.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/types/recording.h"

namespace sonarcal::data_io {

class ArisEmptyPings {
 public:
  // `ping_mode` of the file. Of a mode whose pings are not known, no ping is ever missed.
  explicit ArisEmptyPings(int ping_mode);

  // Samples of frame `index`, by sample and ARIS beam number.
  void Add(int index, std::span<const std::byte> by_beam);

  // True if a frame lacks a ping.
  bool any() const { return !lacking_frames_.empty(); }

  // Adds a note on the pings that frames lack. Beams of pings that no frame holds are marked as not
  // measured in info.valid, and so are the bins beyond the last sample that is not 0. All frames must have
  // been added.
  void Describe(RecordingInfo& info) const;

 private:
  struct Ping {
    bool held = false;                // a beam of it has a sample that is not 0 in any frame
    std::vector<int> lacking_frames;  // frames that lack it
  };

  void MarkEmpty(RecordingInfo& info) const;

  std::vector<int> ping_of_beam_;
  std::vector<Ping> pings_;
  std::vector<int> lacking_frames_;  // frames that lack any ping
  int bins_held_ = 0;                // bins up to the last one with a sample that is not 0 in any frame
  int frames_ = 0;
};

}  // namespace sonarcal::data_io
