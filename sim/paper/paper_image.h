// The paper's polar image, ray by ray (Park 2024 Eqs. 22-28).
//
// A pixel is I / n_b times the sum of the normalised echoes of the rays that fall in it, each times its
// weight (1 in the paper; by solid angle if RayFanOptions says so), clamped to [0, I], where n_b is the
// number of rays that the ray's own beam was given: the paper divides by the rows of its depth image because
// it thinks of one column an azimuth. (Dividing by the count of the beam the ray came from, rather than of
// the one it lands in, keeps the uneven columns of a pinhole from striping a noisy image.)
//
// With noise, each ray's range and azimuth get a Gaussian error before binning; the errors depend on the seed
// and the ray's index only, and sums are kept in fixed point, so the image is the same on any number of
// threads. expected_paper_image.h gives the mean of that image over all seeds, without sampling.
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

// An echo beyond this many times the display's span counts as that much, so that sums of whole steps have a
// bound.
inline constexpr double kLargestPaperEcho = 0x1p12;

// What the values of such an image mean.
ImageScale PaperScale(const DisplayParameters<double>& display, double full_scale);

// The image of sums of normalised echoes, each over the rays of its beam, in whole steps of which
// `steps_of_one` make full scale.
PolarImage PaperImageOfSums(const Grid<std::int64_t>& sums, double steps_of_one, const PolarAxes& axes,
                            const DisplayParameters<double>& display, double full_scale);

// Values are clamped but not rounded; `QuantiseImage` rounds.
PolarImage RenderPaperImage(const EchoList& echoes, const SonarModel& sonar,
                            const PaperParameters<double>& parameters, double absorption_db_per_m,
                            const PaperImageOptions& options = {});

// Rounds to whole grey levels, as a file with so many bits does.
void QuantiseImage(PolarImage& image);

}  // namespace sonarcal::sim
