// Gathered echoes of the paper's model against the image shaded and blurred cell by cell. Frames are
// SYNTHETIC.
#include "calib/paper/paper_evaluation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "calib/paper/paper_frame_model.h"
#include "sim/paper/expected_paper_image.h"
#include "sim/physics/gsab.h"
#include "tests/calib/small_tank.h"

namespace sonarcal::calib {
namespace {

double LevelDb(const GsabParameters<double>& curve, double incidence_deg) {
  return sim::GsabDb(curve, incidence_deg);
}

// Largest error of a curve in dB that is linear between the nodes.
double InterpolationErrorDb(const GsabParameters<double>& curve, double from_deg, double to_deg) {
  const std::vector<double>& nodes = sim::CoarseIncidenceDeg();
  double largest = 0.0;
  for (double deg = from_deg; deg < to_deg; deg += 0.01) {
    const auto above = std::upper_bound(nodes.begin(), nodes.end(), deg) - nodes.begin();
    const double share = (deg - nodes[above - 1]) / (nodes[above] - nodes[above - 1]);
    const double level = (1.0 - share) * LevelDb(curve, sim::PaperIncidenceDeg(above - 1)) +
                         share * LevelDb(curve, sim::PaperIncidenceDeg(above));
    largest = std::max(largest, std::abs(level - LevelDb(curve, deg)));
  }
  return largest;
}

TEST(PaperIncidenceDeg, InterpolatesCurvesAsStated) {
  EXPECT_LT(InterpolationErrorDb({90, 4, 100, 1, 90, 8}, 0.0, 80.0), 0.02) << "the paper's own";
  EXPECT_LT(InterpolationErrorDb({90, 3, 1, 1, 0, 8}, 0.0, 80.0), 0.03);
  EXPECT_LT(InterpolationErrorDb({90, 1, 0.1, 1, 0, 8}, 0.0, 80.0), 0.4);
  EXPECT_LT(InterpolationErrorDb({0, 3, 1, 2, 0, 8}, 0.0, 80.0), 0.04);
  EXPECT_LT(InterpolationErrorDb({0, 3, 1, 2, 0, 8}, 80.0, 86.0), 0.18);
}

// Over the last interval the level of a cosine keeps its mean.
TEST(PaperIncidenceDeg, TheLastIntervalKeepsItsMeanLevel) {
  const std::vector<double>& nodes = sim::CoarseIncidenceDeg();
  const GsabParameters<double> cosine{0, 3, 1, 1, 0, 8};
  const double start_deg = nodes[nodes.size() - 2];
  double mean = 0.0;
  constexpr int kSteps = 100'000;
  for (int i = 0; i < kSteps; ++i)
    mean += LevelDb(cosine, start_deg + (90.0 - start_deg) * (i + 0.5) / kSteps) / kSteps;
  const double by_nodes =
      0.5 * (LevelDb(cosine, start_deg) + LevelDb(cosine, sim::PaperIncidenceDeg(nodes.size() - 1)));
  EXPECT_NEAR(by_nodes, mean, 0.01);
}

TEST(PaperEvaluation, SumsAreThoseOfTheImageCellByCell) {
  const sim::Simulator simulator(testing::SmallTank(), testing::SmallSonar(), testing::SmallTankOptions());
  const std::vector<std::string> materials = simulator.caster().material_names();
  const sim::ImageGeometry geometry(simulator.sonar(), simulator.absorption_db_per_m());
  const ParameterSet truth = testing::SmallTankTruth();
  const std::vector<FitFrame> frames = testing::MakeFitFrames(
      simulator, [&](const sim::EchoList& echoes, int) { return simulator.RenderExpected(echoes, truth); });
  const PaperFrameModel model(frames, geometry, materials, truth);
  const double bin_m = geometry.axes.range_bin_m();
  for (const double range_bins : {0.0, 0.7, 5.0}) {
    for (const double azimuth_deg : {0.0, 1.0}) {
      sim::PaperParameters<double> parameters = sim::PaperParametersFor(truth, materials);
      parameters.jitter.sigma_range_m = range_bins * bin_m;
      parameters.jitter.sigma_azimuth_deg = azimuth_deg;
      const double span_db = parameters.display.db_max - parameters.display.db_min;
      const auto table = std::make_shared<const std::vector<double>>(TabulateEchoes(parameters));
      for (const FitFrame& frame : frames) {
        const auto echoes = std::make_shared<const sim::PaperEchoes>(
            sim::GatherPaperEchoes(frame.echoes, geometry, parameters.jitter));
        const PaperEvaluation evaluation(model.catalog(), parameters, table, echoes,
                                         {.measured = frame.measured, .use = {}, .level = frame.level},
                                         model.beams(), nullptr, {}, {}, FrameModel::Terms::kResiduals);
        const std::vector<double> gathered = evaluation.Sums();
        const std::vector<double> cells =
            sim::PaperImageEvaluation(frame.echoes, geometry, parameters).sums();
        ASSERT_EQ(gathered.size(), cells.size());
        double lit = 0.0;
        for (std::size_t i = 0; i < cells.size(); ++i) {
          // A pixel's rays are at most all rays of its beam, and their weights add up to 1.
          ASSERT_NEAR(gathered[i], cells[i], 0.03 / span_db + 1e-5)
              << range_bins << " bins, " << azimuth_deg << " deg, pixel " << i;
          lit += cells[i] > 0.01 ? 1.0 : 0.0;
        }
        EXPECT_GT(lit, 0.0);
      }
    }
  }
}

}  // namespace
}  // namespace sonarcal::calib
