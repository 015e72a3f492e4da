// Slopes along moves of the sonar against differences of images by many more rays.
#include "sim/acoustic/echo_slopes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numbers>
#include <utility>

#include "core/types/rotation.h"
#include "core/types/units.h"
#include "sim/acoustic/acoustic_frame.h"
#include "sim/scenes/scenes.h"
#include "sim/scenes/sonar_presets.h"
#include "tests/sim/thread_limit.h"

namespace sonarcal::sim {
namespace {

constexpr double kSlopesAlphaDbPerM = 0.21;
// Half the steps of differences: far less than a range bin and a beam.
constexpr double kStepM = 0.003;
constexpr double kStepRad = 0.1 * std::numbers::pi / 180.0;
// Limits of Agreement. The differences contain rays at edges even if these are dense, most of all for roll.
constexpr double kError = 0.25;
constexpr double kGain = 0.05;
constexpr RayFanOptions kFew = {.sampling = Sampling::kBeams,
                                .cols = 512,
                                .rows = 400,
                                .elevation_span_deg = 150.0,
                                .azimuth_margin_deg = 3.0,
                                .row_crowding = 4.0,
                                .stagger = true,
                                .stagger_rows = true};

class EchoSlopesTest : public ::testing::Test {
 protected:
  EchoSlopesTest() {
    parameters_.model = EchoModel::kAcoustic;
    parameters_.source_level_db = 200.0;
    parameters_.materials["default"].gsab = {
        .a = 0.05, .b_deg = 5.0, .c = 0.005, .d = 1.5, .e = 0.02, .f_deg = 15.0};
    parameters_.materials["floor"].gsab = {
        .a = 0.1, .b_deg = 5.0, .c = 0.002, .d = 1.8, .e = 0.01, .f_deg = 11.0};
  }

  static RayFan Fan(const SonarModel& sonar, int times) {
    RayFanOptions options = kFew;
    options.cols *= times;
    options.rows *= times;
    return {sonar, options};
  }
  Grid<double> Image(const SonarModel& sonar, const RayFan& fan, const Pose& pose) const {
    const AcousticGeometry geometry{sonar, kSlopesAlphaDbPerM};
    return EchoPowerImage(CastScatterMap(caster_, fan, pose, geometry, parameters_), geometry, parameters_);
  }
  EchoSlopes Slopes(const RayFan& fan) const {
    return SlopesAlongMoves(caster_, fan, pose_, {sonar_, kSlopesAlphaDbPerM}, parameters_);
  }

  // How a slope relates to a difference: both over the power and a floor far below the brightest pixels.
  struct Agreement {
    double error = 0.0;  // of the slope, over the size of the difference
    double gain = 0.0;   // slope over difference, 1 if they agree
  };
  static Agreement Compare(const Grid<float>& slope, const Grid<double>& above, const Grid<double>& below,
                           double difference) {
    constexpr double kFloor = 1e-3;
    const double floor = kFloor * *std::ranges::max_element(above.values());
    double errors = 0.0;
    double squares = 0.0;
    double products = 0.0;
    for (std::size_t i = 0; i < above.size(); ++i) {
      const double a = above.values()[i];
      const double b = below.values()[i];
      const double level = 0.5 * (a + b) + floor;
      const double expected = (a - b) / (difference * level);
      const double found = slope.values()[i] / level;
      errors += (found - expected) * (found - expected);
      squares += expected * expected;
      products += found * expected;
    }
    return {.error = std::sqrt(errors / squares), .gain = products / squares};
  }

  SonarModel sonar_ = FindSonarPreset("p900-45").sonar;
  RayCaster caster_{MakeMockupTank()};
  Pose pose_ = MockupTankPoses(2)[1];
  ParameterSet parameters_;
};

TEST_F(EchoSlopesTest, PowerIsThatOfTheImage) {
  const RayFan fan = Fan(sonar_, 1);
  const Grid<double> image = Image(sonar_, fan, pose_);
  const EchoSlopes slopes = Slopes(fan);
  const double largest = *std::ranges::max_element(image.values());
  for (std::size_t i = 0; i < image.size(); ++i)
    ASSERT_NEAR(slopes.power.values()[i], image.values()[i], 1e-3 * image.values()[i] + 1e-3 * largest);
}

// Six times as many rows and columns for the differences, because these contain the rays at edges.
TEST_F(EchoSlopesTest, AreDifferencesOfImages) {
  constexpr int kTimes = 6;
  const EchoSlopes slopes = Slopes(Fan(sonar_, 1));
  const RayFan dense = Fan(sonar_, kTimes);
  for (int move = 0; move < kSonarMoves; ++move) {
    const double step = move < 3 ? kStepM : kStepRad;
    const auto moved = [&](double by) {
      Eigen::Vector3d shift = Eigen::Vector3d::Zero();
      Eigen::Vector3d turn = Eigen::Vector3d::Zero();
      (move < 3 ? shift : turn)(move % 3) = by;
      return Image(sonar_, dense, {Turned(pose_.rotation, turn), pose_ * shift});
    };
    const Agreement agreement = Compare(slopes.along[move], moved(step), moved(-step), 2.0 * step);
    EXPECT_LT(agreement.error, kError) << "move " << move;
    EXPECT_NEAR(agreement.gain, 1.0, kGain) << "move " << move;
  }
}

// A wide floor that slides or turns in itself looks the same. Pixels at the far end of the range axis see
// patches beyond it.
TEST_F(EchoSlopesTest, AFloorThatSlidesInItselfChangesNothing) {
  Scene floor;
  floor.vertices_m = {{-60, -60, 0}, {60, -60, 0}, {60, 60, 0}, {-60, 60, 0}};
  floor.triangles = {{0, 1, 2}, {0, 2, 3}};
  floor.triangle_material = {0, 0};
  floor.material_names = {"floor"};
  const RayCaster caster(std::move(floor));
  for (const double pitch_deg : {-10.0, -30.0}) {
    const Pose pose{Turned(Eigen::Quaterniond::Identity(), {RadFromDeg(pitch_deg), 0.0, 0.0}),
                    {0.0, 0.0, 1.5}};
    const EchoSlopes slopes =
        SlopesAlongMoves(caster, Fan(sonar_, 1), pose, {sonar_, kSlopesAlphaDbPerM}, parameters_);
    const Eigen::Matrix3d sonar_from_world = pose.rotation.conjugate().toRotationMatrix();
    const double floor_power = 1e-3 * *std::ranges::max_element(slopes.power.values());
    // Root mean square of the slope along a world axis, as a share of the power.
    const auto size = [&](int first_move, const Eigen::Vector3d& world_axis) {
      const Eigen::Vector3d axis = sonar_from_world * world_axis;
      double squares = 0.0;
      for (std::size_t i = 0; i < slopes.power.size(); ++i) {
        double slope = 0.0;
        for (int k = 0; k < 3; ++k) slope += axis(k) * slopes.along[first_move + k].values()[i];
        squares += std::pow(slope / (slopes.power.values()[i] + floor_power), 2);
      }
      return std::sqrt(squares / static_cast<double>(slopes.power.size()));
    };
    const double up = size(0, Eigen::Vector3d::UnitZ());
    EXPECT_LT(size(0, Eigen::Vector3d::UnitX()), 0.02 * up) << pitch_deg;
    EXPECT_LT(size(0, Eigen::Vector3d::UnitY()), 0.02 * up) << pitch_deg;
    EXPECT_LT(size(3, Eigen::Vector3d::UnitZ()), 0.04 * size(3, Eigen::Vector3d::UnitX())) << pitch_deg;
  }
}

TEST_F(EchoSlopesTest, EchoesFartherAwayAreNearerAxes) {
  const RayFan fan = Fan(sonar_, 1);
  const auto farther = [&](double by_m) {
    SonarModel nearer = sonar_;
    nearer.axes.range_min_m -= by_m;
    nearer.axes.range_max_m -= by_m;
    return Image(nearer, fan, pose_);
  };
  const Agreement agreement = Compare(Slopes(fan).farther, farther(kStepM), farther(-kStepM), 2.0 * kStepM);
  EXPECT_LT(agreement.error, kError);
  EXPECT_NEAR(agreement.gain, 1.0, kGain);
}

// A mock-up that moves alone, raised over the floor by `raised_m`.
class MovedPartTest : public EchoSlopesTest {
 protected:
  // Compares the slopes along the moves with differences of scenes.
  void Expect(double raised_m, std::initializer_list<int> moves) {
    constexpr int kTimes = 6;
    const RayCaster caster(WithMockup({Eigen::Quaterniond::Identity(), {0.0, 0.0, raised_m}}));
    const AcousticGeometry geometry{sonar_, kSlopesAlphaDbPerM};
    const EchoSlopes slopes = SlopesAlongMoves(caster, Fan(sonar_, 1), pose_, geometry, parameters_,
                                               {.count = 1, .of_triangle = Part()});
    ASSERT_EQ(slopes.of_part.size(), 1U);
    const RayFan dense = Fan(sonar_, kTimes);
    for (const int move : moves) {
      const double step = move < 3 ? kStepM : kStepRad;
      const auto image = [&](double by) {
        Eigen::Vector3d shift = Eigen::Vector3d::Zero();
        Eigen::Vector3d turn = Eigen::Vector3d::Zero();
        (move < 3 ? shift : turn)(move % 3) = by;
        const Pose in_sonar{Turned(Eigen::Quaterniond::Identity(), turn), shift};
        const Pose raised{Eigen::Quaterniond::Identity(), {0.0, 0.0, raised_m}};
        const RayCaster moved(WithMockup(pose_ * in_sonar * pose_.Inverse() * raised));
        return EchoPowerImage(CastScatterMap(moved, dense, pose_, geometry, parameters_), geometry,
                              parameters_);
      };
      const Agreement agreement = Compare(slopes.of_part[0][move], image(step), image(-step), 2.0 * step);
      EXPECT_LT(agreement.error, kError) << "move " << move;
      EXPECT_NEAR(agreement.gain, 1.0, kGain) << "move " << move;
    }
  }

  // The scene with its mock-up moved in the world.
  Scene WithMockup(const Pose& move) const {
    Scene scene = caster_.scene();
    std::vector<char> moves(scene.vertices_m.size(), 0);
    for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
      for (const int vertex : scene.triangles[i]) moves[vertex] = Part()[i] == 0 ? 1 : moves[vertex];
    }
    for (std::size_t i = 0; i < moves.size(); ++i) {
      if (moves[i] != 0) scene.vertices_m[i] = (move * scene.vertices_m[i].cast<double>()).cast<float>();
    }
    return scene;
  }

  const std::vector<std::int16_t>& Part() const { return part_; }

 private:
  std::vector<std::int16_t> part_ = [this] {
    const Scene& scene = caster_.scene();
    const auto mockup = std::ranges::find(scene.material_names, "mockup") - scene.material_names.begin();
    std::vector<std::int16_t> part;
    for (const int material : scene.triangle_material) part.push_back(material == mockup ? 0 : -1);
    return part;
  }();
};

// Its edges over floor and walls, and its shadow.
TEST_F(MovedPartTest, HoveringIsLikeDifferencesOfScenes) {
  Expect(0.3, {0, 1, 2, 3, 4, 5});
}

// The line where it stands moves with it. Raised or tilted, it leaves a gap, and lowered it does not, so that
// a difference is no slope there.
TEST_F(MovedPartTest, StandingIsLikeDifferencesOfScenesAlongTheFloor) {
  Expect(0.0, {0, 1, 5});
}

// It goes on below the floor. Raised or pitched, the line on the floor does not move, and few pixels change:
// there the slopes are off by a third (0.32 up; gain 0.89 in pitch).
TEST_F(MovedPartTest, SunkIsLikeDifferencesOfScenes) {
  Expect(-0.2, {0, 1, 4, 5});
}

TEST_F(EchoSlopesTest, AreTheSameOnAnyNumberOfThreads) {
  const RayFan fan = Fan(sonar_, 1);
  const auto along = [&] { return Slopes(fan).along[1]; };
  EXPECT_EQ(testing::WithThreads(1, along), testing::WithThreads(2, along));
}

}  // namespace
}  // namespace sonarcal::sim
