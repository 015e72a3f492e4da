#include "sim/physics/recorded_beam.h"

#include <algorithm>
#include <cmath>

#include "core/types/error.h"
#include "core/types/units.h"
#include "sim/physics/beam_pattern.h"

namespace sonarcal::sim {

void RecordedBeamOptions::Check() const {
  const auto positive = [](const char* field, double value) {
    if (!(value > 0.0)) throw DataError("recorded beam: {} is {}, expected a positive one", field, value);
  };
  positive("grey_per_db", grey_per_db);
  positive("peak_grey", peak_grey);
  positive("main_lobe_beams", main_lobe_beams);
}

std::vector<double> AzimuthTableDb(const std::vector<double>& psf, const RecordedBeamOptions& options,
                                   const std::string& what) {
  options.Check();
  const int count = static_cast<int>(psf.size());
  const int middle = count / 2;
  if (psf.empty() || !(psf[middle] > 0.0)) {
    throw DataError("{}: azimuth response is 0 in its middle, expected its peak there", what);
  }
  // Power of the lobe at each offset; 0 where the psf is 0.
  std::vector<double> lobe(2 * middle + 1, 0.0);
  for (int i = 0; i <= 2 * middle; ++i) {
    const double ratio = (i < count ? psf[i] : psf[0]) / psf[middle];
    if (!(ratio >= 0.0 && ratio <= 1.0)) {
      throw DataError("{}: azimuth response is {} at offset {}, expected 0 .. {}, its value in the middle",
                      what, ratio * psf[middle], i - middle, psf[middle]);
    }
    if (ratio > 0.0) lobe[i] = PowerFromDb((ratio - 1.0) * options.peak_grey / options.grey_per_db);
  }
  std::vector<double> table_db(lobe.size());
  for (int i = 0; i <= 2 * middle; ++i) {
    double power = PowerFromDb(kQuietestDb);
    for (int j = 0; j <= 2 * middle; ++j) {
      // Takes the max, not the sum, so that the result equals the psf where the psf gives a level.
      power = std::max(power, lobe[j] * GaussianResponse<double>(i - j, options.main_lobe_beams));
    }
    table_db[i] = lobe[i] > 0.0 ? DbFromPower(lobe[i]) : DbFromPower(power);
  }
  return table_db;
}

BeamParameters RecordedBeam(const RecordingInfo& info, BeamParameters beam,
                            const RecordedBeamOptions& options) {
  if (info.azimuth_psf.empty()) throw DataError("{}: carries no azimuth response of its own", info.source);
  beam.azimuth_pattern = AzimuthPattern::kTable;
  beam.azimuth_table_db = AzimuthTableDb(info.azimuth_psf, options, info.source);
  return beam;
}

}  // namespace sonarcal::sim
