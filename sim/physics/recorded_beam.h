// Azimuth response that a recording contains for its own sonar, converted to parameters of the acoustic
// model.
//
// DIDSON's `psf` is an image of a point: grey values by offset in beams, with sum 1, so only their ratios
// have a meaning. Its display has 3.98 grey levels per dB. With psf_k / psf_0 = grey_k / grey_0, the lobe k
// lies
//   (1 - psf_k / psf_0) peak_grey / grey_per_db
// dB below the peak. For a peak of 212 grey levels, the lobes at 8, 16, 24, 32 beams lie 91, 115, 130, 139
// grey levels below it; strong surface returns show 88, 116, 131, 140.
//
// A psf of 0 means that nothing was displayed there, not that nothing arrived. Between its lobes the table
// therefore contains Gaussian flanks around each lobe, of `main_lobe_beams` half-power width, down to
// kQuietestDb. The recording does not contain this width; the default of one beam spacing is an assumption.
#pragma once

#include <string>
#include <vector>

#include "core/types/parameters.h"
#include "core/types/recording.h"

namespace sonarcal::sim {

struct RecordedBeamOptions {
  double grey_per_db = 3.98;     // grey levels per dB of the display that recorded psf
  double peak_grey = 212.0;      // grey level of psf_0
  double main_lobe_beams = 1.0;  // half-power width of every lobe, in beams

  // Throws DataError that names the field, its value and the limit.
  void Check() const;
};

inline constexpr double kQuietestDb = -120.0;

// Power response in dB at -n..n beams, with max 0: 2 n + 1 values. A psf with an even number of values lacks
// its last offset, which is copied from the other end. Throws DataError, naming `what`, for a psf that is
// empty, negative, or has no positive middle.
std::vector<double> AzimuthTableDb(const std::vector<double>& psf, const RecordedBeamOptions& options,
                                   const std::string& what);

// `beam` with the recording's own table as its azimuth pattern. Throws DataError if the recording has none.
BeamParameters RecordedBeam(const RecordingInfo& info, BeamParameters beam = {},
                            const RecordedBeamOptions& options = {});

}  // namespace sonarcal::sim
