// Where the beams of an ARIS look.
//
// The numbers are the beam centres of the ARIS File SDK's `beam-width-metrics` (Copyright (c) 2015 Sound
// Metrics, MIT licence: THIRD_PARTY_NOTICES.md), averages over several lenses of each type. Degrees, in the
// order of the ARIS' own beam numbers, strictly increasing; from one beam to the next they are NOT evenly
// spaced.
//
// Which way they turn: the SDK numbers beams from right to left ("beam 0 is the right-most beam") and gives
// beam 0 the most negative centre. So its angle grows to the LEFT, while an azimuth of ours grows to the
// right: azimuth = -centre, and our column 0, the leftmost, is the LAST ARIS beam.
//
// Another lens or model: add its table to the .cc and its case to ArisBeamCentresDeg.
#pragma once

#include <span>
#include <vector>

namespace sonarcal::data_io {

// The value of the header field TheSystemType.
enum class ArisSystem { kAris1800 = 0, kAris3000 = 1, kAris1200 = 2 };

// The header field LargeLens: the telephoto lens halves the horizontal field of view.
enum class ArisLens { kStandard, kTelephoto };

// Beam centres by ARIS beam number; empty where the SDK has no table for the combination.
std::span<const double> ArisBeamCentresDeg(ArisSystem system, int beam_count, ArisLens lens);

// The same directions as azimuths of a polar image's columns, left to right: negated and in reverse order.
std::vector<double> ArisAzimuthsRad(std::span<const double> centres_deg);

}  // namespace sonarcal::data_io
