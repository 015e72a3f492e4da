// Gain of the receiver that a frame's header states.
#pragma once

#include <fmt/format.h>

#include <optional>

#include "core/types/recording.h"
#include "data_io/json/recording_limits.h"

namespace sonarcal::data_io {

// Absent if recording.json cannot hold it.
inline std::optional<double> HeaderGainDb(double gain_db) {
  return kRecordedLevelDb.Contains(gain_db) ? std::optional(gain_db) : std::nullopt;
}

// Adds a note if the gain was left out.
inline void NoteHeaderGain(double gain_db, RecordingInfo& info) {
  if (!HeaderGainDb(gain_db))
    info.notes.push_back(fmt::format("Receiver gain {} dB is impossible and was omitted.", gain_db));
}

}  // namespace sonarcal::data_io
