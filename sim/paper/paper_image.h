// Polar image of the paper's model, ray by ray (Park 2024 Eqs. 22-28).
//
// A pixel is I / n_b times the sum of the normalised echoes of its rays, clamped to [0, I]. Each echo is
// multiplied by its ray's weight (1 in the paper; by solid angle if RayFanOptions says so). n_b is the number
// of rays of the beam that the ray belongs to. The paper divides by the rows of its depth image because it
// assumes one column per azimuth. Dividing by the count of the ray's own beam, not of the beam in which it
// lands, avoids stripes in a noisy image, because a pinhole's columns are uneven.
//
// With noise, each ray's range and azimuth get a Gaussian error before binning. The errors depend only on the
// seed and the ray's index, and sums are kept in fixed point, so the image is the same on any number of
// threads. expected_paper_image.h computes the mean of that image over all seeds without sampling.
#pragma once

#include <cstdint>
#include <optional>

#include "sim/physics/paper_echo.h"
#include "sim/rays/trace.h"

namespace sonarcal::sim {

struct PaperImageOptions {
  double full_scale = 255.0;                // I: 255 for 8 bits, 4095 for 12
  std::optional<std::uint64_t> noise_seed;  // absent: no range and azimuth errors
};

// Upper limit of an echo, in units of the display's span. It bounds the fixed-point sums.
inline constexpr double kLargestPaperEcho = 0x1p12;

// Image of sums of normalised echoes, each divided by the rays of its beam, in fixed-point steps.
// `steps_of_one` steps are full scale.
PolarImage PaperImageOfSums(const Grid<std::int64_t>& sums, double steps_of_one, const PolarAxes& axes,
                            const DisplayParameters<double>& display, double full_scale);

// Values are clamped but not rounded; `QuantiseImage` rounds.
PolarImage RenderPaperImage(const EchoList& echoes, const SonarModel& sonar,
                            const PaperParameters<double>& parameters, double absorption_db_per_m,
                            const PaperImageOptions& options = {});

// Rounds to whole grey levels, like a file with that number of bits.
void QuantiseImage(PolarImage& image);

}  // namespace sonarcal::sim
