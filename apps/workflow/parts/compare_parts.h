// Comparison of a long recording in parts: ranges of frames that several programs compare, and the merge of
// what they measured (metrics/json/comparison_part.h).
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/types/recording.h"
#include "metrics/json/comparison_part.h"

namespace sonarcal::workflow {

// Recordings that show some frames each, as one recording with the numbers of a longer one. Frames that none
// of them shows have the time and pose of the longer recording, and cannot be read.
class PartialRecording final : public RecordingSource {
 public:
  // `whole` must outlive this.
  explicit PartialRecording(const RecordingSource& whole) : whole_(whole) {}

  // Adds a recording with these frames: of them alone, in their order, or with the same numbers. Throws
  // DataError if it is too short.
  void Add(std::unique_ptr<RecordingSource> part, const std::vector<int>& frames);

  // After Add.
  const RecordingInfo& info() const override { return parts_.front()->info(); }
  int frame_count() const override { return whole_.frame_count(); }
  FrameInfo frame_info(int index) const override;
  Frame ReadFrame(int index) const override;

 private:
  const RecordingSource& whole_;
  std::vector<std::unique_ptr<RecordingSource>> parts_;
  std::map<int, std::pair<const RecordingSource*, int>> frames_;  // by number: a part and the number there
};

// Returns `simulated` with the frame numbers of `real`: as it is, or, if it holds just the frames `asked` and
// some of their numbers are beyond it, as a PartialRecording.
std::unique_ptr<RecordingSource> WithNumbersOf(const RecordingSource& real,
                                               std::unique_ptr<RecordingSource> simulated,
                                               const std::vector<int>& asked);

inline constexpr const char* kPartFile = "part.bin";

// Reads the parts in these folders, with the path of each simulated recording.
std::vector<metrics::ComparisonPart> ReadParts(const std::vector<std::filesystem::path>& folders);

// Opens the simulated recordings of parts as one.
std::unique_ptr<RecordingSource> SimulatedOfParts(const RecordingSource& real,
                                                  const std::vector<metrics::ComparisonPart>& parts);

// Throws DataError, naming a frame, unless the frames are all those of the recording.
void CheckWhole(const RecordingSource& real, const metrics::ComparisonPart& merged);

}  // namespace sonarcal::workflow
