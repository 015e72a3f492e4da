// Whether a fit's standard errors are true, in a quick form. scripts/coverage.sh is the long one.
//
// 20 data sets leave a share of one parameter to chance by 10 %, and that of all parameters by 3 to 5 %. The
// limits are wider by chance and nothing else: three standard deviations of a binomial share, of a mean of
// data sets, or of a mean square. Two comparisons leave less to chance, but hold only for independent pixels:
// stated standard errors are not below the bound, and the variance of the fit is that of the linear estimate.
#include "tests/calib/coverage.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "calib/problem_builder.h"
#include "tests/calib/small_tank.h"

namespace sonarcal::testing {
namespace {

void ExpectShare(double share, double lowest, double highest, int count, const std::string& of) {
  const auto chance = [count](double p) { return 3.0 * std::sqrt(p * (1.0 - p) / count); };
  EXPECT_GE(share, lowest - chance(lowest)) << of;
  EXPECT_LE(share, highest + chance(highest)) << of;
}

constexpr int kDataSets = 20;

void ExpectShareOfAll(const CoveredShare& share, double lowest, double highest) {
  EXPECT_GE(share.mean, lowest - 3.0 * share.standard_error);
  EXPECT_LE(share.mean, highest + 3.0 * share.standard_error);
}

void ExpectCovered(const CoverageTable& table) {
  EXPECT_EQ(table.failed, 0);
  int determined = 0;
  for (const CoverageRow& row : table.rows) {
    if (row.determined < table.data_sets) continue;
    ++determined;
    ExpectShare(row.covered_68, 0.63, 0.73, row.determined, row.name);
    ExpectShare(row.covered_95, 0.92, 0.98, row.determined, row.name);
  }
  EXPECT_GE(determined, 10) << "of 13";
  ExpectShareOfAll(table.all_68, 0.63, 0.73);
  ExpectShareOfAll(table.all_95, 0.92, 0.98);
}

TEST(CoverageTest, IntervalsCoverTheTruthWithIndependentPixels) {
  CoverageOptions options;
  options.data_sets = kDataSets;
  options.fit.starts = 1;
  const CoverageTable table = StudyCoverage(options);
  ExpectCovered(table);
  const double chance = 3.0 * std::sqrt(2.0 / static_cast<double>(table.data_sets * table.rows.size()));
  EXPECT_NEAR(table.variance_over_bound, 1.0, 0.1 + chance);
  double over_linear = 0.0;
  for (const CoverageRow& row : table.rows) {
    over_linear += row.variance_over_linear / static_cast<double>(table.rows.size());
    EXPECT_GT(row.mean_sigma, 0.95 * row.bound) << row.name;
  }
  EXPECT_NEAR(over_linear, 1.0, 0.1);
}

TEST(CoverageTest, IntervalsCoverTheTruthWithSpeckleOfSeveralPixels) {
  CoverageOptions options;
  options.speckle = Speckle::kGrained;
  options.data_sets = kDataSets;
  options.seed = 2;
  options.fit.starts = 1;
  const CoverageTable table = StudyCoverage(options);
  ExpectCovered(table);
  // A grain is some pixels: whoever counts pixels as independent has sigmas that are too small.
  for (const CoverageRow& row : table.rows) {
    if (row.name == "receiver.noise_db") continue;  // independent in every pixel
    EXPECT_GT(row.mean_sigma, 1.3 * row.bound) << row.name;
  }
}

int Blocks(double beam_width_deg, double pulse_bins) {
  SonarModel sonar = SmallSonar();  // 160 bins, 48 beams 0.6 degrees apart
  sonar.azimuth_beam_width_deg = beam_width_deg;
  const sim::Simulator simulator(SmallTank(), sonar, SmallTankOptions());
  ParameterSet parameters = SmallTankTruth();
  parameters.model = EchoModel::kAcoustic;
  parameters.receiver.noise_db = 120.0;
  parameters.pulse.length_m = pulse_bins * sonar.axes.range_bin_m();
  const std::vector<calib::AcousticFrame> frames = {
      {.index = 0,
       .world_from_sonar = SmallTankPoses()[0],
       .recorded = std::vector<calib::RecordedPower>(160 * 48, {1e11})}};
  const calib::AcousticFrameModel model(simulator, frames, parameters);
  const int noise = 2;
  EXPECT_EQ(model.catalog()[noise].name, "receiver.noise_db");
  const calib::FitState state{.active = {noise}, .values = model.initial_values()};
  return static_cast<int>(calib::Accumulate(model, model.catalog(), state, {}).blocks.size());
}

TEST(CovarianceBlocksTest, AreEightBeamsAndPulsesLongWhereAFrameHasRoom) {
  EXPECT_EQ(Blocks(1.0, 1.0), 20 * 3) << "8 bins, 16 beams: what FitOptions ask for at least";
  EXPECT_EQ(Blocks(1.0, 2.0), 10 * 3) << "16 bins";
  EXPECT_EQ(Blocks(1.8, 1.0), 20 * 2) << "24 beams";
  EXPECT_EQ(Blocks(6.0, 30.0), 4 * 2) << "a few blocks are left";
}

// Adds the covariances of all pairs of pixels, one by one.
double SharedByPairs(double width, int block, int extent) {
  double all = 0.0;
  double within = 0.0;
  for (int i = 0; i < extent; ++i) {
    for (int j = 0; j < extent; ++j) {
      const double covariance = std::exp(-2.0 * std::numbers::ln2 * (i - j) * (i - j) / (width * width));
      all += covariance;
      if (i / block == j / block) within += covariance;
    }
  }
  return 1.0 - within / all;
}

TEST(CovarianceBlocksTest, ShareAtTheirEdgesWhatPairsOfPixelsDo) {
  // The sum over pairs also has the two ends of the row, where pixels have fewer neighbours.
  for (const double width : {0.5, 1.0, 2.3, 4.0}) {
    const int block = static_cast<int>(std::ceil(8.0 * width));
    EXPECT_NEAR(calib::SharedAtEdges(width, block, 40 * block), SharedByPairs(width, block, 40 * block), 1e-3)
        << width;
  }
  EXPECT_NEAR(calib::SharedAtEdges(20.0, 160, 160 * 1000), 0.479 * 20.0 / 160.0, 1e-4) << "a wide response";
  EXPECT_EQ(calib::SharedAtEdges(3.0, 24, 24), 0.0) << "one block has no inner edge";
}

}  // namespace
}  // namespace sonarcal::testing
