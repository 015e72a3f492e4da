// The azimuth response that a recording carries of its own sonar, as parameters of the acoustic model.
//
// DIDSON's `psf` is an image of a point: grey values by offset in beams, of sum 1, so that only their ratios
// mean anything. On its display, 3.98 grey a dB, the ratio psf_k / psf_0 = grey_k / grey_0 puts the lobe k
//   (1 - psf_k / psf_0) peak_grey / grey_per_db
// dB below the peak. With a peak of 212 grey the lobes at 8, 16, 24, 32 beams come 91, 115, 130, 139 grey
// below it; strong surface returns show 88, 116, 131, 140.
//
// A psf of 0 says that nothing was shown there, not that nothing arrived: between its lobes the table has the
// flanks of a Gaussian main lobe of `main_lobe_beams` half-power width, one about each lobe, down to
// kQuietestDb. The width is not recorded and is a guess (one beam spacing) where nothing better is known.
#pragma once

#include <string>
#include <vector>

#include "core/types/parameters.h"
#include "core/types/recording.h"

namespace sonarcal::sim {

struct RecordedBeamOptions {
  double grey_per_db = 3.98;     // of the display that psf was seen through
  double peak_grey = 212.0;      // that psf_0 stands for
  double main_lobe_beams = 1.0;  // half-power width of every lobe, in beams

  // Throws DataError naming field, value and limit.
  void Check() const;
};

inline constexpr double kQuietestDb = -120.0;

// Power response in dB at -n..n beams, highest 0: 2 n + 1 values. A psf of an even number of values lacks its
// last offset, which is taken from the other end. Throws DataError for a psf that is empty, negative or
// without a positive middle, naming `what`.
std::vector<double> AzimuthTableDb(const std::vector<double>& psf, const RecordedBeamOptions& options,
                                   const std::string& what);

// `beam` with the recording's own table as its azimuth pattern. Throws DataError where it has none.
BeamParameters RecordedBeam(const RecordingInfo& info, BeamParameters beam = {},
                            const RecordedBeamOptions& options = {});

}  // namespace sonarcal::sim
