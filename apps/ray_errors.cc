#include "apps/ray_errors.h"

#include <algorithm>
#include <cmath>

#include "data_io/parameters_io.h"
#include "data_io/types/error.h"
#include "sim/paper_frame.h"

namespace sonarcal {
namespace {

constexpr double kShareWithinOne = 0.999;
constexpr double kLitGrey = 0.5;

RayGridSize AsCast(const RayGridSize& grid, const SonarModel& sonar, Sampling sampling) {
  if (sampling == Sampling::kFrustum) return grid;
  const int beams = sonar.axes.beam_count();
  return {(grid.cols + beams - 1) / beams * beams, grid.rows};
}

RayError ErrorOf(std::vector<double>& errors, int lit, int lit_within_one) {
  RayError error;
  const auto within = [](double value) { return value <= 1.0; };
  const auto count = static_cast<double>(errors.size());
  error.within_one = static_cast<double>(std::count_if(errors.begin(), errors.end(), within)) / count;
  error.within_one_lit = lit > 0 ? static_cast<double>(lit_within_one) / lit : 1.0;
  error.max_grey = *std::max_element(errors.begin(), errors.end());
  const auto at = errors.begin() + static_cast<std::ptrdiff_t>(std::ceil(kShareWithinOne * count)) - 1;
  std::nth_element(errors.begin(), at, errors.end());
  error.p999_grey = *at;
  return error;
}

std::vector<RayGridSize> GridsOf(const RayErrorOptions& options, Sampling sampling, const SonarModel& sonar) {
  return options.grids.empty() ? DefaultGrids(sampling, sonar) : options.grids;
}

}  // namespace

std::vector<RayGridSize> DefaultGrids(Sampling sampling, const SonarModel& sonar) {
  if (sampling == Sampling::kFrustum) {
    return {{750, 600}, {1500, 600}, {1500, 1200}, {1500, 2400}, {3000, 2400}, {3000, 4800}};
  }
  const int beams = sonar.axes.beam_count();
  return {{beams, 400},      {2 * beams, 400},  {beams, 800},      {beams, 1200},
          {2 * beams, 800},  {beams, 1600},     {2 * beams, 1200}, {beams, 2400},
          {2 * beams, 1600}, {beams, 3200},     {2 * beams, 2400}, {beams, 4800},
          {4 * beams, 1600}, {2 * beams, 3200}, {4 * beams, 2400}, {2 * beams, 4800}};
}

int RayErrorImages(const SonarModel& sonar, std::size_t poses, const RayErrorOptions& options) {
  std::size_t images = 0;
  for (const Sampling sampling : options.samplings)
    images += poses * (1 + GridsOf(options, sampling, sonar).size());
  return static_cast<int>(images);
}

std::vector<RayError> MeasureRayErrors(const RayCaster& caster, const SonarModel& sonar,
                                       const ParameterSet& parameters, const SimulationOptions& simulation,
                                       const std::vector<Pose>& poses, const RayErrorOptions& options,
                                       const std::function<void()>& progress) {
  if (parameters.model != EchoModel::kPaper) {
    throw DataError("errors against rays are those of the paper's model, but the parameters name '{}'",
                    ToString(parameters.model));
  }
  if (poses.empty()) throw DataError("no poses to measure errors against rays at");
  const double side = std::sqrt(options.denser);
  const RayGridSize dense = {static_cast<int>(std::lround(options.dense.cols * side)),
                             static_cast<int>(std::lround(options.dense.rows * side))};
  const double db_a_grey = (parameters.display.db_max - parameters.display.db_min) / simulation.full_scale();
  const PaperParameters<double> paper = PaperParametersFor(parameters, caster.material_names());
  const double absorption_db_per_m =
      AbsorptionDbPerM(simulation.absorption, sonar.frequency_hz, simulation.water);
  std::vector<RayError> measured;
  for (const Sampling sampling : options.samplings) {
    const std::vector<RayGridSize> grids = GridsOf(options, sampling, sonar);
    struct Errors {
      std::vector<double> grey;
      int lit = 0;
      int lit_within_one = 0;
    };
    std::vector<Errors> errors(grids.size());
    for (const Pose& pose : poses) {
      const auto render_by = [&](const RayGridSize& grid) {
        const RayFan fan(sonar, {.sampling = sampling, .cols = grid.cols, .rows = grid.rows});
        const PolarImage image = RenderPaperFrame(caster, fan, pose, sonar, paper, absorption_db_per_m,
                                                  {.full_scale = simulation.full_scale(), .noise_seed = {}});
        if (progress) progress();
        return image.value;
      };
      const Grid<float> truth = render_by(dense);
      for (std::size_t i = 0; i < grids.size(); ++i) {
        const Grid<float> image = render_by(grids[i]);
        for (std::size_t pixel = 0; pixel < truth.size(); ++pixel) {
          const double expected = truth.values()[pixel];
          const double shown = image.values()[pixel];
          const double error = std::abs(shown - expected);
          errors[i].grey.push_back(error);
          if (std::max(expected, shown) < kLitGrey) continue;
          ++errors[i].lit;
          errors[i].lit_within_one += error <= 1.0 ? 1 : 0;
        }
      }
    }
    const RayGridSize dense_cast = AsCast(dense, sonar, sampling);
    for (std::size_t i = 0; i < grids.size(); ++i) {
      RayError error = ErrorOf(errors[i].grey, errors[i].lit, errors[i].lit_within_one);
      error.sampling = sampling;
      error.grid = AsCast(grids[i], sonar, sampling);
      error.denser =
          static_cast<double>(dense_cast.cols) * dense_cast.rows / static_cast<double>(error.rays());
      error.p999_db = error.p999_grey * db_a_grey;
      measured.push_back(error);
    }
  }
  return measured;
}

std::optional<RayError> FewestRays(const std::vector<RayError>& errors, Sampling sampling) {
  std::optional<RayError> fewest;
  for (const RayError& error : errors) {
    if (error.sampling != sampling || error.within_one < kShareWithinOne) continue;
    if (!fewest || error.rays() < fewest->rays()) fewest = error;
  }
  return fewest;
}

}  // namespace sonarcal
