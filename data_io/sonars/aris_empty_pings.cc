#include "data_io/sonars/aris_empty_pings.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/sonars/aris_pings.h"
#include "core/types/error.h"

namespace sonarcal::data_io {

ArisEmptyPings::ArisEmptyPings(int ping_mode)
    : ping_of_beam_(ArisPingOfBeam(ping_mode)), pings_(ArisPingsPerFrame(ping_mode)) {}

void ArisEmptyPings::Add(int index, std::span<const std::byte> by_beam) {
  if (pings_.empty()) return;
  const std::size_t beams = ping_of_beam_.size();
  SONARCAL_CHECK(by_beam.size() % beams == 0, "{} samples of {} beams", by_beam.size(), beams);
  std::vector<bool> lit(beams);
  for (std::size_t i = 0; i < by_beam.size(); ++i) {
    if (by_beam[i] == std::byte{0}) continue;
    lit[i % beams] = true;
    bins_held_ = std::max(bins_held_, static_cast<int>(i / beams) + 1);
  }
  std::vector<int> lit_beams(pings_.size());
  for (std::size_t beam = 0; beam < beams; ++beam) lit_beams[ping_of_beam_[beam]] += lit[beam] ? 1 : 0;
  int lit_of_held = 0;
  int held = 0;
  for (std::size_t ping = 0; ping < pings_.size(); ++ping) {
    if (lit_beams[ping] == 0) continue;
    pings_[ping].held = true;
    lit_of_held += lit_beams[ping];
    ++held;
  }
  ++frames_;
  if (2 * lit_of_held <= held * kArisBeamsPerPing || held == static_cast<int>(pings_.size())) return;
  lacking_frames_.push_back(index);
  for (std::size_t ping = 0; ping < pings_.size(); ++ping) {
    if (lit_beams[ping] == 0) pings_[ping].lacking_frames.push_back(index);
  }
}

void ArisEmptyPings::Describe(RecordingInfo& info) const {
  int never_held = 0;
  int sometimes = 0;
  std::vector<int> frames;
  for (const Ping& ping : pings_) {
    if (ping.lacking_frames.empty()) continue;
    if (!ping.held) {
      ++never_held;
      continue;
    }
    ++sometimes;
    frames.insert(frames.end(), ping.lacking_frames.begin(), ping.lacking_frames.end());
  }
  if (never_held > 0) {
    info.notes.push_back(fmt::format(
        "The beams of {} of {} pings are empty (only zeros) in {} of {} frames: {} of {} beams are "
        "marked as not measured.",
        never_held, pings_.size(), lacking_frames_.size(), frames_, never_held * kArisBeamsPerPing,
        ping_of_beam_.size()));
    MarkEmpty(info);
  }
  if (sometimes > 0) {
    std::ranges::sort(frames);
    frames.erase(std::unique(frames.begin(), frames.end()), frames.end());
    info.notes.push_back(fmt::format(
        "The beams of {} of {} pings are empty (only zeros) in {} of {} frames, the first of which is "
        "frame {}; they are not marked, because other frames hold these beams.",
        sometimes, pings_.size(), frames.size(), frames_, frames.front()));
  }
}

void ArisEmptyPings::MarkEmpty(RecordingInfo& info) const {
  const int bins = info.sonar.axes.range_bins;
  const auto beams = static_cast<int>(ping_of_beam_.size());
  Mask valid(bins, beams);
  for (int bin = 0; bin < std::min(bins, bins_held_); ++bin) {
    // ARIS beams are numbered from the right, columns from the left.
    for (int beam = 0; beam < beams; ++beam)
      valid(bin, beams - 1 - beam) = pings_[ping_of_beam_[beam]].held ? 1 : 0;
  }
  if (bins_held_ < bins) {
    info.notes.push_back(fmt::format(
        "No beam of any frame has a sample other than 0 beyond the first {} of {} range bins: the other "
        "bins are marked as not measured.",
        bins_held_, bins));
  }
  info.valid = std::move(valid);
}

}  // namespace sonarcal::data_io
