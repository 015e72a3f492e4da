// Beam directions of an ARIS.
//
// The values are the beam centres of the ARIS File SDK's `beam-width-metrics` (Copyright (c) 2015 Sound
// Metrics, MIT licence: THIRD_PARTY_NOTICES.md), averaged over several lenses of each type. Degrees, in the
// order of the ARIS' own beam numbers, strictly ascending. Beams are NOT evenly spaced.
//
// Sign: the SDK numbers beams from right to left ("beam 0 is the right-most beam") and gives beam 0 the most
// negative centre, so its angle increases to the LEFT. Azimuths in this project increase to the right:
// azimuth = -centre, and column 0, the leftmost, is the LAST ARIS beam.
//
// To add a lens or model: add its table to the .cc and its case to ArisBeamCentresDeg.
#pragma once

#include <span>
#include <vector>

namespace sonarcal {

// Value of the header field TheSystemType.
enum class ArisSystem { kAris1800 = 0, kAris3000 = 1, kAris1200 = 2 };

// Header field LargeLens: the telephoto lens halves the horizontal field of view.
enum class ArisLens { kStandard, kTelephoto };

// Beam centres by ARIS beam number; empty if the SDK has no table for the combination.
std::span<const double> ArisBeamCentresDeg(ArisSystem system, int beam_count, ArisLens lens);

// Beam centres as azimuths of a polar image's columns, left to right: negated and in reverse order.
std::vector<double> ArisAzimuthsRad(std::span<const double> centres_deg);

}  // namespace sonarcal
