#include "sim/physics/line_array.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <vector>

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

TEST(LineArray, LimitsOfWidthAndTaperAreTheLastThatAreValid) {
  EXPECT_NO_THROW(MakeLineArray(RadFromDeg(0.0501), 0.5));
  EXPECT_NO_THROW(MakeLineArray(RadFromDeg(59.9), 0.5));
  EXPECT_THROW(MakeLineArray(RadFromDeg(0.0499), 0.5), DataError);
  EXPECT_THROW(MakeLineArray(RadFromDeg(60.1), 0.5), DataError);
  EXPECT_THROW(MakeLineArray(RadFromDeg(1.0), 1.001), DataError);
}

// Even spacing, symmetric about 0, half a wavelength or a little less; shading of the formula, sum 1.
TEST(LineArray, ElementsAreEvenAndShadedByTheTaper) {
  for (const double taper : {0.0, 0.4, 1.0}) {
    const LineArray array = MakeLineArray(RadFromDeg(2.0), taper);
    const int count = static_cast<int>(array.position_wavelengths.size());
    const double spacing = array.position_wavelengths[1] - array.position_wavelengths[0];
    EXPECT_GT(spacing, 0.45);
    double sum = 0.0;
    for (int i = 0; i < count; ++i) {
      EXPECT_NEAR(array.position_wavelengths[i], spacing * (i - 0.5 * (count - 1)), 1e-9);
      const double cosine = std::cos(kPi * array.position_wavelengths[i] / (spacing * count));
      const double middle = std::cos(kPi * array.position_wavelengths[count / 2] / (spacing * count));
      EXPECT_NEAR(array.shading[i] / array.shading[count / 2],
                  (1.0 - taper + taper * cosine * cosine) / (1.0 - taper + taper * middle * middle), 1e-9);
      sum += array.shading[i];
    }
    EXPECT_NEAR(sum, 1.0, 1e-12);
  }
}

// Four equal elements half a wavelength apart: |sin(2 pi s) / (4 sin(pi s / 2))|^2.
TEST(LineArray, PowerOfFourElementsInClosedForm) {
  const LineArray array{.position_wavelengths = {-0.75, -0.25, 0.25, 0.75},
                        .shading = {0.25, 0.25, 0.25, 0.25}};
  for (const double sine : {0.1, 0.3, 0.7}) {
    const double field = std::sin(2.0 * kPi * sine) / (4.0 * std::sin(0.5 * kPi * sine));
    EXPECT_NEAR(array.Power(sine), field * field, 1e-12);
  }
}

// A plane wave from 0.3 rad, with a phase of its own. The elements are not symmetric, so that phases count.
TEST(Beamformer, ABeamIsTheShadedSumInPhaseWithItsCentre) {
  const LineArray array{.position_wavelengths = {-0.4, 0.1, 0.9}, .shading = {0.2, 0.5, 0.3}};
  const PolarAxes axes{
      .range_min_m = 1.0, .range_max_m = 2.0, .range_bins = 1, .beam_azimuth_rad = {-0.2, 0.3}};
  const Beamformer beamformer(array, axes);
  EXPECT_EQ(beamformer.elements(), 3);
  EXPECT_NEAR(beamformer.noise_scale(), 1.0 / std::sqrt(0.04 + 0.25 + 0.09), 1e-12);
  std::vector<std::complex<double>> field;
  for (const double position : array.position_wavelengths) {
    field.push_back(std::polar(2.0, 0.7 + 2.0 * kPi * position * std::sin(0.3)));
  }
  EXPECT_NEAR(std::abs(beamformer.Beam(1, field) - std::polar(2.0, 0.7)), 0.0, 1e-12);
  std::complex<double> expected = 0.0;
  for (int i = 0; i < 3; ++i) {
    expected += array.shading[i] * std::polar(2.0, 0.7 + 2.0 * kPi * array.position_wavelengths[i] *
                                                             (std::sin(0.3) + std::sin(0.2)));
  }
  EXPECT_NEAR(std::abs(beamformer.Beam(0, field) - expected), 0.0, 1e-12);
}

}  // namespace
}  // namespace sonarcal::sim
