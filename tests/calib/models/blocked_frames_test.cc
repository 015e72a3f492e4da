#include "calib/models/blocked_frames.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "core/types/error.h"
#include "sim/physics/beam_and_pulse.h"
#include "tests/calib/small_tank.h"

namespace sonarcal::calib {
namespace {

ParameterSet WithTable(std::vector<double> table_db) {
  ParameterSet parameters = testing::SmallTankAcousticTruth();
  parameters.beam.azimuth_pattern = AzimuthPattern::kTable;
  parameters.beam.azimuth_table_db = std::move(table_db);
  return parameters;
}

// Main lobes wider and narrower than a beam, the latter with side lobes far off.
TEST(BlockedFramesTest, ABeamTableKeepsTheLevelOfSurfacesAndLosesNoEchoBetweenBlocks) {
  const SonarModel sonar = testing::SmallSonar();
  for (const ParameterSet& parameters :
       {WithTable({-40.0, -20.0, -10.0, -3.0, -0.5, 0.0, -0.5, -3.0, -10.0, -20.0, -40.0}),
        WithTable({-20.0, -60.0, -60.0, -60.0, -60.0, 0.0, -60.0, -60.0, -60.0, -60.0, -20.0}),
        WithTable({-60.0, 0.0, -60.0})}) {
    const sim::AzimuthShape<double> fine = sim::AzimuthShapeOf(sonar, parameters);
    const double fine_width_rad = sim::AzimuthEquivalentWidthRad(sim::AzimuthResponse<double>(fine), 0.0);
    for (const int beams : {1, 2, 3, 4, 8}) {
      const BlockedFrames blocked = InBlocks(sonar, parameters, {}, {.bins = 1, .beams = beams});
      const std::vector<double>& table_db = blocked.parameters.beam.azimuth_table_db;
      if (beams == 1) {
        EXPECT_EQ(table_db, parameters.beam.azimuth_table_db);
        continue;
      }
      const sim::AzimuthShape<double> coarse = sim::AzimuthShapeOf(blocked.sonar, blocked.parameters);
      const sim::AzimuthResponse<double> response(coarse);
      EXPECT_NEAR(sim::AzimuthEquivalentWidthRad(response, 0.0), fine_width_rad, 1e-6 * fine_width_rad)
          << beams;
      EXPECT_EQ(std::ranges::max(table_db), table_db[table_db.size() / 2]) << beams;
      const std::vector<double>& centres_rad = blocked.sonar.axes.beam_azimuth_rad;
      const double between_rad = 0.5 * (centres_rad[2] + centres_rad[3]);
      for (const int block : {2, 3}) {
        EXPECT_GT(response.Power(between_rad, centres_rad[block]),
                  0.2 * response.Power(centres_rad[block], centres_rad[block]))
            << beams;
      }
    }
  }
}

TEST(BlockedFramesTest, AnInvalidBeamTableIsRefused) {
  for (const std::vector<double>& table_db : {std::vector<double>{}, {0.0}, {0.0, -3.0}}) {
    EXPECT_THROW(InBlocks(testing::SmallSonar(), WithTable(table_db), {}, {.bins = 2, .beams = 2}),
                 DataError);
  }
}

}  // namespace
}  // namespace sonarcal::calib
