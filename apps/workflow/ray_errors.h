// What too few rays cost: images of the paper's model at a series of ray counts against one of very many
// rays.
//
// Rays are summed as they are cast, so that memory does not grow with their number (sim/paper/paper_frame.h).
// Each sampling has a dense image of its own, so that an error is one of the number of rays and of nothing
// else; how far the two dense images are apart is told besides.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "apps/workflow/ray_options.h"
#include "sim/simulator.h"

namespace sonarcal::workflow {

// Of images, over all pixels of all poses.
struct ImageError {
  double p999_grey = 0.0;  // 99.9th percentile of the absolute error
  double max_grey = 0.0;
  double p999_db = 0.0;         // of the level displayed: grey levels x (db_max - db_min) / full scale
  double within_one = 0.0;      // share of pixels at most one grey level off
  double within_one_lit = 0.0;  // of those that are lit in either image (half a grey level or more)
};

// A number of rays, and the errors of its images.
struct RayError : ImageError {
  sim::Sampling sampling = sim::Sampling::kFrustum;
  RayGridSize grid;     // as cast: whole columns a beam
  double denser = 0.0;  // rays of the dense image over its own

  std::int64_t rays() const { return static_cast<std::int64_t>(grid.cols) * grid.rows; }
};

struct RayErrors {
  std::vector<RayError> counts;
  std::optional<ImageError> between;  // the dense images of two samplings, where both were asked for
};

struct RayErrorOptions {
  std::vector<sim::Sampling> samplings = {sim::Sampling::kFrustum, sim::Sampling::kBeams};
  std::vector<RayGridSize> grids = {};  // empty: DefaultGrids of each sampling
  RayGridSize dense = {1500, 1200};     // the dense image has `denser` times these rays
  double denser = 64.0;
  sim::RayWeight weight = sim::RayWeight::kEven;
};

// The counts that are tried unless others are named: about a quarter to eight times the paper's rays, of
// `beams` from a thirtieth. `beams` are staggered, as the paper's model casts them.
std::vector<RayGridSize> DefaultGrids(sim::Sampling sampling, const SonarModel& sonar);

// Of `simulation` absorption, water and bits count. `progress` is told after each image, of `RayErrorImages`
// in all. Throws DataError where parameters are not those of the paper's model, or there is no pose.
RayErrors MeasureRayErrors(const sim::RayCaster& caster, const SonarModel& sonar,
                           const ParameterSet& parameters, const sim::SimulationOptions& simulation,
                           const std::vector<Pose>& poses, const RayErrorOptions& options,
                           const std::function<void()>& progress = {});
int RayErrorImages(const SonarModel& sonar, std::size_t poses, const RayErrorOptions& options);

// A display of so many dB whose top is the brightest echo that the rays of `grid` meet from the poses: none
// is worth more than full scale. Throws DataError where they meet nothing.
DisplayParameters<double> DisplayUpToBrightest(const sim::RayCaster& caster, const SonarModel& sonar,
                                               const ParameterSet& parameters,
                                               const sim::SimulationOptions& simulation,
                                               const std::vector<Pose>& poses, const RayGridSize& grid,
                                               double span_db);

// The fewest rays of a sampling that leave the error at most one grey level in 99.9 % of the pixels.
std::optional<RayError> FewestRays(const std::vector<RayError>& errors, sim::Sampling sampling);

}  // namespace sonarcal::workflow
