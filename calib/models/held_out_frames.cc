#include "calib/models/held_out_frames.h"

#include <algorithm>
#include <functional>
#include <map>
#include <string>

#include "core/types/error.h"
#include "data_io/files/hash.h"

namespace sonarcal::calib {
namespace {

// Returns an empty text for a frame of one grey level.
std::string DigestOfPixels(const Grid<float>& image) {
  const auto values = image.values();
  if (std::adjacent_find(values.begin(), values.end(), std::not_equal_to<>()) == values.end()) return {};
  return data_io::Sha256({reinterpret_cast<const char*>(values.data()), values.size_bytes()});
}

}  // namespace

void CheckHeldOut(const RecordingSource& recording, const FrameSplit& split) {
  if (split.held_out.empty()) return;
  std::map<std::string, int> used;
  for (const int index : split.used)
    used.emplace(DigestOfPixels(recording.ReadFrame(index).image.value), index);
  for (const int index : split.held_out) {
    const std::string digest = DigestOfPixels(recording.ReadFrame(index).image.value);
    const auto same = used.find(digest);
    if (digest.empty() || same == used.end()) continue;
    throw DataError(
        "{}: the held-out frame {} is the same picture as frame {}, which is fitted, expected frames that "
        "the fit does not see; leave one of the two out",
        recording.info().source, index, same->second);
  }
}

}  // namespace sonarcal::calib
