// Errors of too few rays: compares images of the paper's model at several ray counts with an image of very
// many rays.
//
// Rays are summed while they are cast, so memory does not grow with their number (sim/paper/paper_frame.h).
// Each sampling has its own dense image, so an error depends only on the number of rays. The difference
// between the two dense images is reported separately.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "apps/workflow/rays/ray_options.h"
#include "sim/simulator.h"

namespace sonarcal::workflow {

// Errors over all pixels of all poses.
struct ImageError {
  double p999_grey = 0.0;  // 99.9th percentile of the absolute error
  double max_grey = 0.0;
  double p999_db = 0.0;     // of the displayed level: grey levels x (db_max - db_min) / full scale
  double within_one = 0.0;  // share of pixels with an error of at most one grey level
  // as above, of pixels that are lit in either image (half a grey level or more)
  double within_one_lit = 0.0;
};

// A number of rays and the errors of its images.
struct RayError : ImageError {
  sim::Sampling sampling = sim::Sampling::kFrustum;
  RayGridSize grid;     // as cast: whole columns per beam
  double denser = 0.0;  // number of rays in the dense image, divided by its own

  std::int64_t rays() const { return static_cast<std::int64_t>(grid.cols) * grid.rows; }
};

struct RayErrors {
  std::vector<RayError> counts;
  std::optional<ImageError> between;  // difference of the two dense images; absent for one sampling
};

struct RayErrorOptions {
  std::vector<sim::Sampling> samplings = {sim::Sampling::kFrustum, sim::Sampling::kBeams};
  std::vector<RayGridSize> grids = {};  // empty: DefaultGrids of each sampling
  RayGridSize dense = {1500, 1200};     // base grid; the dense image has `denser` times its rays
  double denser = 64.0;
  sim::RayWeight weight = sim::RayWeight::kEven;
};

// Returns the default ray counts: about 1/4 to 8 times the paper's number. `beams` begin at 1/30 of it and
// are staggered as the paper's model casts them.
std::vector<RayGridSize> DefaultGrids(sim::Sampling sampling, const SonarModel& sonar);

// Reads absorption, water and bits from `simulation`. Calls `progress` after each of the `RayErrorImages`
// images. Throws DataError if the parameters are not those of the paper's model or if there is no pose.
RayErrors MeasureRayErrors(const sim::RayCaster& caster, const SonarModel& sonar,
                           const ParameterSet& parameters, const sim::SimulationOptions& simulation,
                           const std::vector<Pose>& poses, const RayErrorOptions& options,
                           const std::function<void()>& progress = {});
int RayErrorImages(const SonarModel& sonar, std::size_t poses, const RayErrorOptions& options);

// Returns a display with a span of `span_db` whose top is the brightest echo that the rays of `grid` meet
// from the poses, so that no echo exceeds full scale. Throws DataError if they meet nothing.
DisplayParameters<double> DisplayUpToBrightest(const sim::RayCaster& caster, const SonarModel& sonar,
                                               const ParameterSet& parameters,
                                               const sim::SimulationOptions& simulation,
                                               const std::vector<Pose>& poses, const RayGridSize& grid,
                                               double span_db);

// Returns the smallest number of rays of a sampling whose error is at most one grey level in 99.9 % of the
// pixels.
std::optional<RayError> MinRays(const std::vector<RayError>& errors, sim::Sampling sampling);

}  // namespace sonarcal::workflow
