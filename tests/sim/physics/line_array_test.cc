#include "sim/physics/line_array.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/types/error.h"
#include "core/types/units.h"
#include "sim/physics/beam_pattern.h"

namespace sonarcal::sim {
namespace {

TEST(LineArray, HasTheBeamWidthAskedFor) {
  for (const double width_deg : {0.3, 1.0, 14.0}) {
    for (const double taper : {0.0, 0.6, 1.0}) {
      const LineArray array = MakeLineArray(RadFromDeg(width_deg), taper);
      EXPECT_NEAR(array.Power(0.0), 1.0, 1e-12);
      EXPECT_NEAR(array.Power(std::sin(RadFromDeg(0.5 * width_deg))), 0.5, 1e-9);
      EXPECT_LE(array.position_wavelengths[1] - array.position_wavelengths[0], 0.505);
    }
  }
  EXPECT_THROW(MakeLineArray(0.0, 1.0), DataError);
  EXPECT_THROW(MakeLineArray(0.02, -0.1), DataError);
}

// Elements half a wavelength apart against the continuous aperture of the acoustic model: near the axis the
// same, in the side lobes to (pi v / n)^2 / 6 of the level.
TEST(LineArray, IsTheAperturesPattern) {
  for (const double taper : {0.0, 1.0}) {
    const LineArray array = MakeLineArray(RadFromDeg(1.0), taper);
    const AzimuthResponse<double> aperture(
        {.pattern = AzimuthPattern::kAperture, .width_rad = RadFromDeg(1.0), .taper = taper});
    for (int step = 0; step < 500; ++step) {
      const double azimuth = 0.0003 * step;
      EXPECT_NEAR(array.Power(std::sin(azimuth)), aperture.Power(azimuth, 0.0), 5e-4) << azimuth;
    }
  }
}

}  // namespace
}  // namespace sonarcal::sim
