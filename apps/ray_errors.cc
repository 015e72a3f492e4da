#include "apps/ray_errors.h"

#include <algorithm>
#include <cmath>

#include "data_io/parameters_io.h"
#include "data_io/types/error.h"

namespace sonarcal {
namespace {

constexpr double kShareWithinOne = 0.999;
constexpr double kLitGrey = 0.5;

// Beams [first, last) of a sonar, with a neighbour on either side where there is one, so that the edges of
// those beams stay where they are.
struct BeamBlock {
  SonarModel sonar;
  int guards_left = 0;
};

BeamBlock BlockOf(const SonarModel& sonar, int first, int last) {
  const std::vector<double>& azimuth_rad = sonar.axes.beam_azimuth_rad;
  const int from = std::max(0, first - 1);
  // An outer edge mirrors the inner one, which a beam alone does not have.
  const int to = std::min(sonar.axes.beam_count(), last + 1);
  BeamBlock block{sonar, first - from};
  block.sonar.axes.beam_azimuth_rad.assign(azimuth_rad.begin() + from, azimuth_rad.begin() + to);
  return block;
}

// Columns of a block, as many to the tangent (frustum) or to the beam as the whole fan has.
int ColumnsOf(const BeamBlock& block, const SonarModel& sonar, const RayGridSize& grid, Sampling sampling) {
  const int beams = sonar.axes.beam_count();
  const int block_beams = block.sonar.axes.beam_count();
  if (sampling == Sampling::kBeams) return (grid.cols + beams - 1) / beams * block_beams;
  const auto width = [](const std::vector<double>& edges_rad) {
    return std::tan(edges_rad.back()) - std::tan(edges_rad.front());
  };
  const double part = width(block.sonar.axes.BeamEdgesRad()) / width(sonar.axes.BeamEdgesRad());
  return std::max(1, static_cast<int>(std::lround(part * grid.cols)));
}

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

Grid<float> RenderInBlocks(const RayCaster& caster, const SonarModel& sonar, const ParameterSet& parameters,
                           const SimulationOptions& options, const RayGridSize& grid, const Pose& pose,
                           std::int64_t rays_a_block) {
  const int beams = sonar.axes.beam_count();
  const PaperParameters<double> paper = PaperParametersFor(parameters, caster.material_names());
  const double absorption_db_per_m = AbsorptionDbPerM(options.absorption, sonar.frequency_hz, options.water);
  const std::int64_t rays = static_cast<std::int64_t>(grid.cols) * grid.rows;
  const int blocks =
      static_cast<int>(std::clamp<std::int64_t>(rays / rays_a_block, 1, std::max(1, beams / 2)));
  Grid<float> image(sonar.axes.range_bins, beams);
  for (int i = 0; i < blocks; ++i) {
    const int first = beams * i / blocks;
    const int last = beams * (i + 1) / blocks;
    const BeamBlock block = BlockOf(sonar, first, last);
    RayFanOptions fan_options = options.fan;
    fan_options.cols = ColumnsOf(block, sonar, grid, fan_options.sampling);
    fan_options.rows = grid.rows;
    const RayFan fan(block.sonar, fan_options);
    const EchoList echoes = Trace(caster, fan, pose, block.sonar.axes, options.trace);
    const PolarImage part = RenderPaperImage(echoes, block.sonar, paper, absorption_db_per_m,
                                             {.full_scale = options.full_scale(), .noise_seed = {}});
    for (int bin = 0; bin < image.rows(); ++bin) {
      for (int beam = first; beam < last; ++beam)
        image(bin, beam) = part.value(bin, beam - first + block.guards_left);
    }
  }
  return image;
}

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
  std::vector<RayError> measured;
  for (const Sampling sampling : options.samplings) {
    SimulationOptions render = simulation;
    render.fan.sampling = sampling;
    const std::vector<RayGridSize> grids = GridsOf(options, sampling, sonar);
    struct Errors {
      std::vector<double> grey;
      int lit = 0;
      int lit_within_one = 0;
    };
    std::vector<Errors> errors(grids.size());
    for (const Pose& pose : poses) {
      const auto render_by = [&](const RayGridSize& grid) {
        Grid<float> image = RenderInBlocks(caster, sonar, parameters, render, grid, pose);
        if (progress) progress();
        return image;
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
