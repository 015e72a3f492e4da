// Pings of an ARIS frame.
//
// An ARIS receives 16 beams at a time. With N pings per frame, ping p receives the beams p, p + N, p + 2 N,
// ..., so neighbouring beams belong to different pings, one cycle period apart. The sonar sends samples
// ping by ping, sample by sample, the 16 channels in the order of its multiplexer. Files hold them by
// sample and beam, unless the header field ReorderedSamples is 0.
//
// Source: the manufacturer's ARIS Integration SDK, common/code/Reordering (MIT licence). It knows the
// sending order of the ping modes 1, 3, 6 and 9, which are those that the sonars use.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace sonarcal {

inline constexpr int kArisBeamsPerPing = 16;

// Number of pings per frame; 0 if `ping_mode` is none of 1, 3, 6 and 9.
int ArisPingsPerFrame(int ping_mode);

// Index of the ping that received each beam, by ARIS beam number (beam 0 is the rightmost); empty if the ping
// mode is none of those.
std::vector<int> ArisPingOfBeam(int ping_mode);

// Samples of a frame by sample and ARIS beam number, from samples in the order in which the sonar sends them.
// `ping_mode` is one of those above, and the size of `sent` a multiple of the number of beams.
std::vector<std::byte> ArisSamplesByBeam(std::span<const std::byte> sent, int ping_mode);

}  // namespace sonarcal
