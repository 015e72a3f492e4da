// What staggered rays are for: an expected image that changes evenly as the sonar moves.
#include "sim/rays/acoustic_fan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/types/error.h"
#include "core/types/units.h"
#include "sim/acoustic/acoustic_image.h"
#include "sim/rays/ray_caster.h"
#include "sim/rays/trace.h"
#include "tests/sim/meshes.h"
#include "tests/sim/slow_paper_model.h"

namespace sonarcal::sim {
namespace {

using namespace testing;  // NOLINT: the helpers of tests/sim
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr double kPlateM = 3.0;  // distance, straight ahead

SonarModel Sonar() {
  SonarModel sonar = MakeSonar(EvenAzimuthsDeg(40, 0.5), 20.0, 2.5, 3.5, 20);
  sonar.azimuth_beam_width_deg = 1.0;
  return sonar;
}

ParameterSet FanParameters() {
  ParameterSet p;
  p.model = EchoModel::kAcoustic;
  p.source_level_db = 120.0;
  p.materials["default"].gsab = {.a = 0.16, .b_deg = 6.0, .c = 4e-3, .d = 2.0, .e = 0.016, .f_deg = 20.0};
  p.beam.elevation_pattern = ElevationPattern::kGaussian;
  return p;
}

// A plate whose left and upper edges lie on the axis: what all pixels hear of it.
double TotalPower(const RayFanOptions& options, const Pose& pose) {
  static const SonarModel kSonar = Sonar();
  static const RayCaster kCaster([] {
    Scene plate;
    AddQuad(plate, {0, kPlateM, -0.4}, {0.4, 0, 0}, {0, 0, 0.4}, "plate");
    return plate;
  }());
  const RayFan fan(kSonar, options);
  const ScatterMap scatter =
      MakeScatterMap(Trace(kCaster, fan, pose, kSonar.axes), fan, {kSonar, 0.3}, FanParameters());
  const PolarImage power = ExpectedPower(scatter, {kSonar, 0.3}, FanParameters());
  double sum = 0.0;
  for (const float value : power.value.values()) sum += value;
  return sum;
}

// The largest difference to ten times as many rays each way, while the sonar turns by a column and a row.
double Roughness(RayFanOptions options, const Eigen::Vector3d& axis) {
  RayFanOptions dense = options;
  dense.cols *= 10;
  dense.rows *= 10;
  double largest = 0.0;
  for (int step = 0; step < 16; ++step) {
    const Pose pose{Eigen::Quaterniond(Eigen::AngleAxisd(RadFromDeg(0.25 * step / 16.0), axis)), {0, 0, 0}};
    largest = std::max(largest, std::abs(TotalPower(options, pose) / TotalPower(dense, pose) - 1.0));
  }
  return largest;
}

TEST(AcousticFan, DefaultFanStaggersColumnsAndRows) {
  const RayFanOptions options = AcousticFanOptions(Sonar(), FanParameters());
  EXPECT_TRUE(options.stagger);
  EXPECT_TRUE(options.stagger_rows);
}

// A Gaussian beam ends the fan, so its width must be known; beams with side lobes see the floor below anyhow.
TEST(AcousticFan, AnUnknownElevationWidthIsRefusedIfItEndsTheFan) {
  SonarModel sonar = Sonar();
  sonar.elevation_beam_width_deg = 0.0;
  ParameterSet parameters = FanParameters();
  EXPECT_THAT([&] { AcousticFanOptions(sonar, parameters); },
              ThrowsMessage<DataError>(HasSubstr("test sonar: elevation beam width unknown")));
  parameters.beam.elevation_width_deg = 12.0;
  EXPECT_EQ(AcousticFanOptions(sonar, parameters).elevation_span_deg, 48.0);
  parameters.beam = {};
  EXPECT_EQ(AcousticFanOptions(sonar, parameters).elevation_span_deg, 176.0);
}

// Turning to the side takes an upright edge through the columns, pitching a level one through the rows. An
// edge across columns or rows that stand alike costs up to half of one, of the plate's 30 columns and 30
// rows; of staggered ones, by golden sections, (0.5 + log2 n) / n of one, of the n = 30 rays along the edge.
TEST(AcousticFan, StaggeredRaysLetEdgesMoveEvenly) {
  const RayFanOptions alike = {.sampling = Sampling::kBeams, .cols = 80, .rows = 80};
  RayFanOptions staggered = alike;
  staggered.stagger = true;
  staggered.stagger_rows = true;
  const double cells = DegFromRad(std::atan(0.4 / kPlateM)) / 0.25;
  const double bound = 2.0 * (0.5 + std::log2(cells)) / cells / cells;  // both of the plate's edges
  for (const Eigen::Vector3d& axis : {Eigen::Vector3d::UnitZ().eval(), Eigen::Vector3d::UnitX().eval()}) {
    EXPECT_GT(Roughness(alike, axis), 0.4 / cells) << axis.transpose();
    EXPECT_LT(Roughness(staggered, axis), bound) << axis.transpose();
  }
}

}  // namespace
}  // namespace sonarcal::sim
