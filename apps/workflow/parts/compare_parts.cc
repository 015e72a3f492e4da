#include "apps/workflow/parts/compare_parts.h"

#include <algorithm>

#include "core/types/error.h"
#include "data_io/files/file_bytes.h"
#include "data_io/open_recording.h"

namespace sonarcal::workflow {
namespace {

// True for a recording of these frames alone, in their order; false for one with the same numbers.
bool HoldsOnly(const RecordingSource& recording, const std::vector<int>& frames) {
  return !frames.empty() && recording.frame_count() == static_cast<int>(frames.size()) &&
         *std::ranges::max_element(frames) >= recording.frame_count();
}

}  // namespace

void PartialRecording::Add(std::unique_ptr<RecordingSource> part, const std::vector<int>& frames) {
  const bool holds_only = HoldsOnly(*part, frames);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const int at = holds_only ? static_cast<int>(i) : frames[i];
    if (at >= part->frame_count()) {
      throw DataError("{}: has {} frames, expected {}, those of a part of {}", part->info().source,
                      part->frame_count(), frames.size(), whole_.info().source);
    }
    frames_[frames[i]] = {part.get(), at};
  }
  parts_.push_back(std::move(part));
}

FrameInfo PartialRecording::frame_info(int index) const {
  const auto found = frames_.find(index);
  if (found == frames_.end()) return whole_.frame_info(index);
  return found->second.first->frame_info(found->second.second);
}

Frame PartialRecording::ReadFrame(int index) const {
  const auto found = frames_.find(index);
  if (found == frames_.end()) throw DataError("{}: has no frame {}", info().source, index);
  return found->second.first->ReadFrame(found->second.second);
}

std::unique_ptr<RecordingSource> WithNumbersOf(const RecordingSource& real,
                                               std::unique_ptr<RecordingSource> simulated,
                                               const std::vector<int>& asked) {
  if (!HoldsOnly(*simulated, asked)) return simulated;
  auto partial = std::make_unique<PartialRecording>(real);
  partial->Add(std::move(simulated), asked);
  return partial;
}

std::vector<metrics::ComparisonPart> ReadParts(const std::vector<std::filesystem::path>& folders) {
  constexpr std::size_t kMaxBytes = 1UL << 32U;
  std::vector<metrics::ComparisonPart> parts;
  for (const std::filesystem::path& folder : folders) {
    const std::filesystem::path file = folder / kPartFile;
    parts.push_back(metrics::ParseComparisonPart(data_io::ReadFileBytes(file, kMaxBytes), file.string()));
  }
  return parts;
}

std::unique_ptr<RecordingSource> SimulatedOfParts(const RecordingSource& real,
                                                  const std::vector<metrics::ComparisonPart>& parts) {
  auto all = std::make_unique<PartialRecording>(real);
  for (const metrics::ComparisonPart& part : parts) {
    std::vector<int> frames;
    for (const metrics::FrameMetrics& frame : part.frames) frames.push_back(frame.index);
    if (!frames.empty()) all->Add(data_io::OpenRecording(part.simulated), frames);
  }
  return all;
}

void CheckWhole(const RecordingSource& real, const metrics::ComparisonPart& merged) {
  int expected = 0;
  for (const metrics::FrameMetrics& frame : merged.frames) {
    if (frame.index != expected) break;
    ++expected;
  }
  if (expected < real.frame_count())
    throw DataError("frame {} of {} is in no part, expected every frame in one", expected,
                    real.info().source);
}

}  // namespace sonarcal::workflow
