#include "core/sonars/aris_pings.h"

#include <array>

#include "core/types/error.h"

namespace sonarcal {
namespace {

// Position of each channel among the beams of its ping.
constexpr std::array<std::size_t, kArisBeamsPerPing> kBeamOfChannel = {10, 2, 14, 6, 8, 0, 12, 4,
                                                                       11, 3, 15, 7, 9, 1, 13, 5};

}  // namespace

int ArisPingsPerFrame(int ping_mode) {
  switch (ping_mode) {
    case 1:
      return 3;
    case 3:
      return 6;
    case 6:
      return 4;
    case 9:
      return 8;
    default:
      return 0;
  }
}

std::vector<int> ArisPingOfBeam(int ping_mode) {
  const int pings = ArisPingsPerFrame(ping_mode);
  std::vector<int> ping_of_beam;
  for (int beam = 0; beam < pings * kArisBeamsPerPing; ++beam) ping_of_beam.push_back(beam % pings);
  return ping_of_beam;
}

std::vector<std::byte> ArisSamplesByBeam(std::span<const std::byte> sent, int ping_mode) {
  const auto pings = static_cast<std::size_t>(ArisPingsPerFrame(ping_mode));
  SONARCAL_CHECK(pings > 0, "ping mode {}: its sending order is not known", ping_mode);
  const std::size_t beams = pings * kArisBeamsPerPing;
  SONARCAL_CHECK(sent.size() % beams == 0, "{} samples of {} beams", sent.size(), beams);
  const std::size_t samples = sent.size() / beams;
  std::vector<std::byte> by_beam(sent.size());
  auto next = sent.begin();
  for (std::size_t ping = 0; ping < pings; ++ping) {
    for (std::size_t sample = 0; sample < samples; ++sample) {
      for (const std::size_t beam : kBeamOfChannel) by_beam[sample * beams + beam * pings + ping] = *next++;
    }
  }
  return by_beam;
}

}  // namespace sonarcal
