#include "apps/workflow/task/recording_transfer.h"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <optional>
#include <utility>

#include "apps/workflow/compare.h"
#include "apps/workflow/task/labelled_frames.h"
#include "core/types/error.h"
#include "data_io/scenes/cad_io.h"

namespace sonarcal::workflow {
namespace {

using Recordings = std::vector<const RecordingSource*>;

std::vector<metrics::LabelledFrame> ByScene(const RecordingSource& recording, const std::string& object) {
  const std::optional<std::string>& scene = recording.info().scene_path;
  if (!scene) {
    throw DataError("{}: names no scene, expected one for --object, or --train-masks",
                    recording.info().source);
  }
  return LabelledByScene(recording, data_io::ReadScene(*scene), object);
}

// `object` labels the frames of recordings without masks.
std::vector<metrics::LabelledFrame> Labelled(const Recordings& recordings, const Recordings& masks,
                                             const std::string& object) {
  std::vector<metrics::LabelledFrame> labelled;
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    std::vector<metrics::LabelledFrame> frames =
        masks.empty() ? ByScene(*recordings[i], object) : LabelledByMasks(*recordings[i], *masks[i]);
    std::ranges::move(frames, std::back_inserter(labelled));
  }
  return labelled;
}

// True if both were opened from the same file or folder.
bool AreSame(const RecordingSource& a, const RecordingSource& b) {
  std::error_code error;
  return std::filesystem::equivalent(a.info().source, b.info().source, error);
}

void CheckMasks(const char* option, const Recordings& masks, const Recordings& recordings) {
  if (masks.size() != recordings.size()) {
    throw UsageError("{} names {} recordings, expected {}, one for each recording", option, masks.size(),
                     recordings.size());
  }
  for (std::size_t i = 0; i < masks.size(); ++i) {
    if (AreSame(*masks[i], *recordings[i]))
      throw UsageError(
          "{} names {}, which is the recording itself, expected one that is bright where the object is",
          option, masks[i]->info().source);
  }
}

// No frame is tested by a detector that was trained on it.
void CheckApart(const Recordings& training, const Recordings& test) {
  for (const RecordingSource* trained : training) {
    for (const RecordingSource* tested : test) {
      if (AreSame(*trained, *tested))
        throw UsageError("{} is given for training and for the test, expected other frames to test on",
                         tested->info().source);
    }
  }
}

std::vector<std::string> NamesOf(const Recordings& recordings) {
  std::vector<std::string> names;
  for (const RecordingSource* recording : recordings) names.push_back(RecordingName(recording->info()));
  return names;
}

// Frames with an object, at most kShownTestFrames, evenly spread from the first to the last.
std::vector<int> FramesToShow(const std::vector<metrics::LabelledFrame>& frames) {
  std::vector<int> with_object;
  for (int i = 0; i < static_cast<int>(frames.size()); ++i) {
    if (CountSet(frames[i].object) > 0) with_object.push_back(i);
  }
  return EvenlySpread(with_object, kShownTestFrames);
}

// Test frame by its number among the frames of all recordings.
TestedFrame FrameAt(const Recordings& recordings, const std::vector<metrics::LabelledFrame>& frames,
                    metrics::ShownDetection found) {
  const int frame = found.frame;
  TestedFrame tested{.recording = {},
                     .frame = frame,
                     .image = {},
                     .object = frames[static_cast<std::size_t>(frame)].object,
                     .found = std::move(found)};
  for (const RecordingSource* recording : recordings) {
    if (tested.frame < recording->frame_count()) {
      tested.recording = RecordingName(recording->info());
      tested.image = recording->ReadFrame(tested.frame).image;
      break;
    }
    tested.frame -= recording->frame_count();
  }
  return tested;
}

bool IsSynthetic(const RecordingSource* recording) {
  return recording->info().synthetic;
}

}  // namespace

RecordingTransfer Transfer(const TransferRecordings& recordings, const TransferOptions& options,
                           const Listener& listener) {
  if (recordings.training_masks.empty() == options.object.empty())
    throw UsageError("expected either --train-masks or --object");
  if (options.object.empty()) CheckMasks("--train-masks", recordings.training_masks, recordings.training);
  CheckMasks("--test-masks", recordings.test_masks, recordings.test);
  CheckApart(recordings.training, recordings.test);
  const std::vector<metrics::LabelledFrame> training =
      Labelled(recordings.training, recordings.training_masks, options.object);
  const std::vector<metrics::LabelledFrame> test = Labelled(recordings.test, recordings.test_masks, {});
  RecordingTransfer result{.training = NamesOf(recordings.training),
                           .test = NamesOf(recordings.test),
                           .training_is_synthetic = std::ranges::all_of(recordings.training, IsSynthetic),
                           .test_is_synthetic = std::ranges::any_of(recordings.test, IsSynthetic),
                           .transfer = {},
                           .shown = {}};
  result.transfer = metrics::MeasureTransfer(training, test, FramesToShow(test), [&](int done, int total) {
    listener.Progress("Training", done, total);
  });
  for (metrics::ShownDetection& shown : result.transfer.shown)
    result.shown.push_back(FrameAt(recordings.test, test, std::move(shown)));
  result.transfer.shown.clear();
  return result;
}

}  // namespace sonarcal::workflow
