#include "apps/workflow/rays/ray_errors.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/math/statistics.h"
#include "core/types/error.h"
#include "core/types/units.h"
#include "data_io/parameters/parameters_io.h"
#include "sim/paper/paper_frame.h"

namespace sonarcal::workflow {
namespace {

constexpr double kShareWithinOne = 0.999;
constexpr double kLitGrey = 0.5;

RayGridSize AsCast(const RayGridSize& grid, const SonarModel& sonar, sim::Sampling sampling) {
  if (sampling == sim::Sampling::kFrustum) return grid;
  const int beams = sonar.axes.beam_count();
  return {(grid.cols + beams - 1) / beams * beams, grid.rows};
}

// Absolute differences of images, collected pose by pose.
class Differences {
 public:
  void Add(const Grid<float>& image, const Grid<float>& truth) {
    for (std::size_t pixel = 0; pixel < truth.size(); ++pixel) {
      const double expected = truth.values()[pixel];
      const double shown = image.values()[pixel];
      const double error = std::abs(shown - expected);
      grey_.push_back(error);
      if (std::max(expected, shown) < kLitGrey) continue;
      ++lit_;
      lit_within_one_ += error <= 1.0 ? 1 : 0;
    }
  }

  ImageError Summary(double db_a_grey) {
    ImageError error;
    const auto within = [](double value) { return value <= 1.0; };
    const auto count = static_cast<double>(grey_.size());
    error.within_one = static_cast<double>(std::count_if(grey_.begin(), grey_.end(), within)) / count;
    error.within_one_lit = lit_ > 0 ? static_cast<double>(lit_within_one_) / lit_ : 1.0;
    error.max_grey = *std::max_element(grey_.begin(), grey_.end());
    error.p999_grey = UpperQuantile(grey_, kShareWithinOne);
    error.p999_db = error.p999_grey * db_a_grey;
    return error;
  }

 private:
  std::vector<double> grey_;
  int lit_ = 0;
  int lit_within_one_ = 0;
};

std::vector<RayGridSize> GridsOf(const RayErrorOptions& options, sim::Sampling sampling,
                                 const SonarModel& sonar) {
  return options.grids.empty() ? DefaultGrids(sampling, sonar) : options.grids;
}

}  // namespace

std::vector<RayGridSize> DefaultGrids(sim::Sampling sampling, const SonarModel& sonar) {
  if (sampling == sim::Sampling::kFrustum) {
    return {{750, 600}, {1500, 600}, {1500, 1200}, {1500, 2400}, {3000, 2400}, {3000, 4800}};
  }
  const int beams = sonar.axes.beam_count();
  return {{beams, 200},      {beams, 300},      {beams, 400},     {2 * beams, 200},
          {2 * beams, 250},  {2 * beams, 330},  {2 * beams, 400}, {4 * beams, 330},
          {2 * beams, 1200}, {4 * beams, 1200}, {4 * beams, 2400}};
}

int RayErrorImages(const SonarModel& sonar, std::size_t poses, const RayErrorOptions& options) {
  std::size_t images = 0;
  for (const sim::Sampling sampling : options.samplings)
    images += poses * (1 + GridsOf(options, sampling, sonar).size());
  return static_cast<int>(images);
}

RayErrors MeasureRayErrors(const sim::RayCaster& caster, const SonarModel& sonar,
                           const ParameterSet& parameters, const sim::SimulationOptions& simulation,
                           const std::vector<Pose>& poses, const RayErrorOptions& options,
                           const std::function<void()>& progress) {
  if (parameters.model != EchoModel::kPaper) {
    throw DataError("ray errors are measured with the paper's model, but the parameters name '{}'",
                    ToString(parameters.model));
  }
  if (poses.empty()) throw DataError("no poses to measure ray errors at");
  const double side = std::sqrt(options.denser);
  const RayGridSize dense = {static_cast<int>(std::lround(options.dense.cols * side)),
                             static_cast<int>(std::lround(options.dense.rows * side))};
  const double db_a_grey = (parameters.display.db_max - parameters.display.db_min) / simulation.full_scale();
  const sim::PaperParameters<double> paper = sim::PaperParametersFor(parameters, caster.material_names());
  const double absorption_db_per_m =
      sim::AbsorptionDbPerM(simulation.absorption, sonar.frequency_hz, simulation.water);
  RayErrors measured;
  std::vector<Grid<float>> first_truths;
  for (const sim::Sampling sampling : options.samplings) {
    const std::vector<RayGridSize> grids = GridsOf(options, sampling, sonar);
    std::vector<Differences> errors(grids.size());
    std::vector<Grid<float>> truths;
    for (const Pose& pose : poses) {
      const auto render_by = [&](const RayGridSize& grid) {
        const sim::RayFan fan(sonar, {.sampling = sampling,
                                      .cols = grid.cols,
                                      .rows = grid.rows,
                                      .weight = options.weight,
                                      .stagger = sampling == sim::Sampling::kBeams});
        const PolarImage image =
            sim::RenderPaperFrame(caster, fan, pose, sonar, paper, absorption_db_per_m,
                                  {.full_scale = simulation.full_scale(), .noise_seed = {}});
        if (progress) progress();
        return image.value;
      };
      truths.push_back(render_by(dense));
      for (std::size_t i = 0; i < grids.size(); ++i) errors[i].Add(render_by(grids[i]), truths.back());
    }
    const RayGridSize dense_cast = AsCast(dense, sonar, sampling);
    for (std::size_t i = 0; i < grids.size(); ++i) {
      const RayGridSize cast = AsCast(grids[i], sonar, sampling);
      const double denser = static_cast<double>(dense_cast.cols) * dense_cast.rows /
                            (static_cast<double>(cast.cols) * cast.rows);
      measured.counts.push_back({errors[i].Summary(db_a_grey), sampling, cast, denser});
    }
    if (first_truths.empty()) {
      first_truths = std::move(truths);
    } else {
      Differences between;
      for (std::size_t i = 0; i < truths.size(); ++i) between.Add(truths[i], first_truths[i]);
      measured.between = between.Summary(db_a_grey);
    }
  }
  return measured;
}

DisplayParameters<double> DisplayUpToBrightest(const sim::RayCaster& caster, const SonarModel& sonar,
                                               const ParameterSet& parameters,
                                               const sim::SimulationOptions& simulation,
                                               const std::vector<Pose>& poses, const RayGridSize& grid,
                                               double span_db) {
  sim::PaperParameters<double> paper = sim::PaperParametersFor(parameters, caster.material_names());
  paper.display = {.db_min = 0.0, .db_max = 1.0};  // displays echoes in dB
  const double absorption_db_per_m =
      sim::AbsorptionDbPerM(simulation.absorption, sonar.frequency_hz, simulation.water);
  const sim::RayFan fan(sonar, {.sampling = sim::Sampling::kBeams, .cols = grid.cols, .rows = grid.rows});
  double brightest_db = -std::numeric_limits<double>::infinity();
  for (const Pose& pose : poses) {
    const sim::EchoList echoes = sim::Trace(caster, fan, pose, sonar.axes);
    for (std::size_t i = 0; i < echoes.size(); ++i) {
      const double strength_db =
          sim::GsabDb(paper.materials[echoes.material[i]], DegFromRad<double>(echoes.incidence_rad[i]));
      const double loss_db = 2.0 * sim::TransmissionLossDb(double{echoes.range_m[i]}, absorption_db_per_m);
      brightest_db = std::max(brightest_db, sim::NormalisedPaperEcho(paper, loss_db, strength_db));
    }
  }
  if (!std::isfinite(brightest_db))
    throw DataError("{}: no echo within its range window at any of {} poses", sonar.name, poses.size());
  return {.db_min = brightest_db - span_db, .db_max = brightest_db};
}

std::optional<RayError> MinRays(const std::vector<RayError>& errors, sim::Sampling sampling) {
  std::optional<RayError> fewest;
  for (const RayError& error : errors) {
    if (error.sampling != sampling || error.within_one < kShareWithinOne) continue;
    if (!fewest || error.rays() < fewest->rays()) fewest = error;
  }
  return fewest;
}

}  // namespace sonarcal::workflow
