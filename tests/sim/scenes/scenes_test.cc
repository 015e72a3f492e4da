#include "sim/scenes/scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/types/error.h"
#include "tests/support/mesh_checks.h"

namespace sonarcal::sim {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;
using testing::Bounds;
using testing::FirstHitM;
using testing::IsClosed;
using testing::SignedVolumeM3;

constexpr double kHalfFieldOfViewDeg = 22.5;  // 45 degrees, Park 2024 Table 4

AlignedBox3d BoxOf(const Vector3d& size_m) {
  return {Vector3d::Zero(), size_m};
}

TEST(TankTest, HasTheSizesThatThePaperPrints) {
  EXPECT_TRUE(Bounds(MakeTank()).isApprox(BoxOf({12.0, 10.0, 1.5})));
  EXPECT_TRUE(Bounds(MakeTank(TankOfSize(SizeVariant::kAlternative))).isApprox(BoxOf({15.0, 10.0, 2.0})));
}

TEST(TankTest, EveryFaceLooksIntoTheWater) {
  TankOptions options;
  options.surface = true;
  options.max_edge_m = 1.0;
  const Scene tank = MakeTank(options);
  tank.Validate("tank");
  const Vector3d middle_m = Bounds(tank).center();
  for (const Eigen::Vector3i& triangle : tank.triangles) {
    const auto [a, b, c] = testing::Corners(tank, triangle);
    EXPECT_GT((b - a).cross(c - a).dot(middle_m - a), 0.0);
  }
}

TEST(TankTest, TheSurfaceIsThereOnRequestOnly) {
  EXPECT_EQ(MakeTank().material_names, (std::vector<std::string>{"floor", "wall"}));
  EXPECT_EQ(MakeTank().triangles.size(), 10u);
  TankOptions options;
  options.surface = true;
  EXPECT_EQ(MakeTank(options).material_names, (std::vector<std::string>{"floor", "wall", "surface"}));
}

TEST(TankTest, ASizeThatIsNoneIsRefusedByName) {
  TankOptions options;
  options.width_m = std::numeric_limits<double>::quiet_NaN();
  try {
    MakeTank(options);
    FAIL() << "a tank without a width was built";
  } catch (const DataError& error) {
    EXPECT_NE(std::string(error.what()).find("width_m is nan"), std::string::npos) << error.what();
  }
}

TEST(MockupTest, FillsTheSizesThatThePaperPrintsAndNoMore) {
  for (const auto& [size, height_m] :
       {std::pair{SizeVariant::kStandard, 1.5}, {SizeVariant::kAlternative, 1.0}}) {
    const AlignedBox3d bounds = Bounds(MakeMockup(MockupOfSize(size)));
    EXPECT_TRUE(bounds.min().isApprox(Vector3d(-0.5, -0.5, 0.0), 1e-6)) << bounds.min().transpose();
    EXPECT_TRUE(bounds.max().isApprox(Vector3d(0.5, 0.5, height_m), 1e-6)) << bounds.max().transpose();
  }
}

TEST(MockupTest, IsAUnionOfClosedSolidsThatFaceOutwards) {
  const Scene mockup = MakeMockup();
  mockup.Validate("mock-up");
  EXPECT_TRUE(IsClosed(mockup));
  EXPECT_EQ(mockup.material_names, std::vector<std::string>{"mockup"});
  for (const Scene& solid : testing::Pieces(mockup)) EXPECT_GT(SignedVolumeM3(solid), 0.0);
}

TEST(MockupTest, EachPieceReachesIntoTheCoreOrTheFrame) {
  // A solid that floats would be a mistake in a pattern: each but the core must overlap another's box.
  const std::vector<Scene> solids = testing::Pieces(MakeMockup());
  std::vector<AlignedBox3d> boxes;
  for (const Scene& solid : solids) {
    AlignedBox3d box;
    for (const Eigen::Vector3i& triangle : solid.triangles) {
      for (const Vector3d& corner_m : testing::Corners(solid, triangle)) box.extend(corner_m);
    }
    boxes.push_back(box);
  }
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const auto holds = [&](const AlignedBox3d& other) {
      return &other != &boxes[i] && other.intersection(boxes[i]).sizes().minCoeff() > 1e-3;
    };
    EXPECT_TRUE(std::any_of(boxes.begin(), boxes.end(), holds)) << "solid " << i;
  }
}

// How deep behind the nominal face the mesh lies, on a grid of points over the side facing -y.
std::vector<double> FrontReliefM(const MockupOptions& options) {
  const Scene mockup = MakeMockup(options);
  std::vector<double> depths_m;
  for (double z_m = 0.051; z_m < options.height_m; z_m += 0.1) {
    for (double x_m = -0.471; x_m < 0.5; x_m += 0.05) {
      depths_m.push_back(FirstHitM(mockup, {x_m, -0.5 * options.width_m - 1.0, z_m}, Vector3d::UnitY()) -
                         1.0);
    }
  }
  return depths_m;
}

TEST(MockupTest, TheFourPatternsDiffer) {
  std::vector<std::vector<double>> reliefs_m;
  for (const MockupPattern pattern : kMockupPatterns) {
    MockupOptions options;
    options.max_edge_m = kUndivided;
    options.patterns[0] = pattern;
    reliefs_m.push_back(FrontReliefM(options));
    const auto [nearest, deepest] = std::minmax_element(reliefs_m.back().begin(), reliefs_m.back().end());
    EXPECT_NEAR(*nearest, 0.0, 1e-6) << ToString(pattern);               // the posts
    EXPECT_NEAR(*deepest, options.relief_m, 1e-6) << ToString(pattern);  // the core
  }
  for (std::size_t i = 0; i < reliefs_m.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      int differing = 0;
      for (std::size_t k = 0; k < reliefs_m[i].size(); ++k) {
        differing += std::abs(reliefs_m[i][k] - reliefs_m[j][k]) > 0.01;
      }
      EXPECT_GT(differing, static_cast<int>(reliefs_m[i].size() / 8)) << i << " and " << j;
    }
  }
}

TEST(MockupTest, APatternFacesTheSideItIsAskedFor) {
  // Turning the order of the patterns by one turns the mock-up by a quarter: the top is round.
  MockupOptions turned;
  std::rotate(turned.patterns.begin(), turned.patterns.begin() + 1, turned.patterns.end());
  turned.max_edge_m = kUndivided;
  MockupOptions straight;
  straight.max_edge_m = kUndivided;
  const Scene front = Moved(MakeMockup(straight), WorldFromObject({0.0, 0.0, -0.5 * kPi}));
  const Scene mockup = MakeMockup(turned);
  for (double z_m = 0.051; z_m < 1.5; z_m += 0.2) {
    for (double x_m = -0.471; x_m < 0.5; x_m += 0.1) {
      EXPECT_NEAR(FirstHitM(mockup, {x_m, -2.0, z_m}, Vector3d::UnitY()),
                  FirstHitM(front, {x_m, -2.0, z_m}, Vector3d::UnitY()), 1e-5);
    }
  }
}

TEST(MockupTest, CanBeRefinedToACountOfTriangles) {
  const std::size_t plain = MakeMockup().triangles.size();
  EXPECT_GT(plain, 2000u);
  EXPECT_LT(plain, 10000u);
  for (const int triangles : {20'000, 300'000}) {
    const Scene mockup = MakeMockup(RefinedTo({}, triangles));
    EXPECT_GE(mockup.triangles.size(), static_cast<std::size_t>(triangles));
    EXPECT_LE(mockup.triangles.size(), static_cast<std::size_t>(1.5 * triangles));
    EXPECT_TRUE(Bounds(mockup).isApprox(Bounds(MakeMockup()), 1e-6));
  }
}

TEST(MockupTest, OptionsThatMakeNoMockupAreRefused) {
  MockupOptions deep;
  deep.relief_m = 0.4;
  EXPECT_THROW(MakeMockup(deep), DataError);
  MockupOptions flat;
  flat.height_m = 0.0;
  EXPECT_THROW(MakeMockup(flat), DataError);
  MockupOptions edgeless;
  edgeless.max_edge_m = -1.0;
  EXPECT_THROW(MakeMockup(edgeless), DataError);
  EXPECT_THROW(RefinedTo({}, kMaxMockupTriangles + 1), DataError);
}

TEST(MockupTankTest, HoldsTheTankAndTwoMockups) {
  for (const SizeVariant size : {SizeVariant::kStandard, SizeVariant::kAlternative}) {
    const MockupTankOptions options = MockupTankOfSize(size);
    const Scene scene = MakeMockupTank(options);
    scene.Validate("paper tank");
    EXPECT_EQ(scene.material_names, (std::vector<std::string>{"floor", "wall", "mockup"}));
    EXPECT_EQ(scene.triangles.size(), 10u + 2u * MakeMockup(options.mockup).triangles.size());
    EXPECT_TRUE(Bounds(scene).isApprox(Bounds(MakeTank(options.tank))));
  }
}

// Azimuth of a point in the sonar's frame, positive to the right.
double AzimuthDeg(const Pose& world_from_sonar, const Vector3d& world_m) {
  const Vector3d sonar_m = world_from_sonar.Inverse() * world_m;
  return DegFromRad(std::atan2(sonar_m.x(), sonar_m.y()));
}

TEST(MockupTankTest, EveryPoseSeesItsTargetFromOpenWater) {
  const MockupTankOptions options;
  const Scene scene = MakeMockupTank(options);
  for (const int dataset : {1, 2, 3}) {
    const std::vector<Pose> poses = MockupTankPoses(dataset);
    EXPECT_EQ(poses.size(), 4u);
    for (const Pose& world_from_sonar : poses) {
      const Vector3d& position_m = world_from_sonar.position_m;
      const AlignedBox3d water = BoxOf({options.tank.length_m, options.tank.width_m, options.tank.depth_m});
      EXPECT_GT(water.exteriorDistance(position_m) == 0.0
                    ? (position_m - water.min()).cwiseMin(water.max() - position_m).minCoeff()
                    : -1.0,
                0.3)
          << position_m.transpose();
      for (int mockup = 0; mockup < 2; ++mockup) {
        if (dataset != 3 && dataset != mockup + 1) continue;
        const Place& place = options.places[mockup];
        const Vector3d target_m(place.x_m, place.y_m, position_m.z());
        const double range_m = (target_m - position_m).norm();
        EXPECT_GT(range_m, 3.0);
        EXPECT_LT(range_m, 6.0);
        EXPECT_LT(std::abs(AzimuthDeg(world_from_sonar, target_m)), kHalfFieldOfViewDeg - 5.0);
        // The way to it is free: the first thing met lies within the mock-up's half diagonal of its middle.
        const double first_m = FirstHitM(scene, position_m, (target_m - position_m).normalized());
        EXPECT_NEAR(first_m, range_m, 0.72);
      }
    }
  }
}

TEST(MockupTankTest, TheTwoMockupsShowDifferentSidesToTheSonar) {
  std::vector<int> facing;
  for (const Place& place : MockupTankOptions{}.places) {
    // The side whose normal points most against the viewing axis +y.
    std::vector<double> towards;
    for (int side = 0; side < 4; ++side) {
      const double normal_rad = -0.5 * kPi + 0.5 * kPi * side + place.yaw_rad;
      towards.push_back(-std::sin(normal_rad));
    }
    facing.push_back(static_cast<int>(std::max_element(towards.begin(), towards.end()) - towards.begin()));
  }
  EXPECT_EQ(facing, (std::vector<int>{0, 1}));
}

TEST(MockupTankTest, ThereAreThreeDatasets) {
  EXPECT_THROW(MockupTankPoses(0), DataError);
  EXPECT_THROW(MockupTankPoses(4), DataError);
}

TEST(BodyTest, HasThePublishedSize) {
  const Scene body = MakeBody();
  EXPECT_TRUE(IsClosed(body));
  EXPECT_EQ(testing::EulerCharacteristic(body), 2);
  EXPECT_EQ(body.material_names, std::vector<std::string>{"body"});
  const AlignedBox3d bounds = Bounds(body);
  EXPECT_NEAR(bounds.min().x(), -0.3685, 1e-6);
  EXPECT_NEAR(bounds.max().x(), 0.3685, 1e-6);
  EXPECT_NEAR(bounds.max().y(), 0.104, 1e-6);
  EXPECT_NEAR(bounds.sizes().z(), 0.208, 0.001);
}

TEST(BodyTest, TheNoseRunsIntoTheCylinderWithoutAKink) {
  const BodyOptions options;
  EXPECT_NEAR(BodyRadiusM(options, 0.0), 0.0, 1e-12);
  EXPECT_NEAR(BodyRadiusM(options, options.nose_length_m), 0.104, 1e-12);
  const double step_m = 1e-5;
  const double slope = (0.104 - BodyRadiusM(options, options.nose_length_m - step_m)) / step_m;
  EXPECT_NEAR(slope, 0.0, 1e-4);
  EXPECT_NEAR(BodyRadiusM(options, options.length_m), 0.045, 1e-12);
}

TEST(BodyTest, HoldsTheVolumeOfItsOutline) {
  BodyOptions options;
  options.max_edge_m = 0.004;
  constexpr int kSteps = 100'000;
  double volume_m3 = 0.0;
  const double step_m = options.length_m / kSteps;
  for (int i = 0; i < kSteps; ++i) {
    const double radius_m = BodyRadiusM(options, (i + 0.5) * step_m);
    volume_m3 += kPi * radius_m * radius_m * step_m;
  }
  const double mesh_m3 = SignedVolumeM3(MakeBody(options));
  EXPECT_LT(mesh_m3, volume_m3);
  EXPECT_GT(mesh_m3, 0.999 * volume_m3);
}

TEST(BodyTest, TheNosePointsAlongX) {
  const Scene body = MakeBody();
  for (const Eigen::Vector3f& vertex_m : body.vertices_m) {
    if (vertex_m.x() > 0.36f) {
      EXPECT_LT(vertex_m.tail<2>().norm(), 0.02f);
    }
  }
}

TEST(TurnedSolidTest, IsAClosedSolidThroughItsRadii) {
  const std::vector<ProfilePoint> outline = {{-0.2, 0.03}, {-0.1, 0.104}, {0.0, 0.09}, {0.3, 0.01}};
  const Scene solid = MakeTurnedSolid(outline, 0.01, "steel");
  EXPECT_TRUE(IsClosed(solid));
  EXPECT_GT(SignedVolumeM3(solid), 0.0);
  EXPECT_EQ(solid.material_names, std::vector<std::string>{"steel"});
  const AlignedBox3d bounds = Bounds(solid);
  EXPECT_NEAR(bounds.min().x(), -0.2, 1e-6);
  EXPECT_NEAR(bounds.max().x(), 0.3, 1e-6);
  EXPECT_NEAR(bounds.sizes().z(), 0.208, 0.001);
}

TEST(TurnedSolidTest, OutlinesThatMakeNoSolidAreRefused) {
  EXPECT_THROW(MakeTurnedSolid({{0.0, 0.1}}, 0.01, "steel"), DataError);
  EXPECT_THROW(MakeTurnedSolid({{0.0, 0.1}, {0.1, 0.0}}, 0.01, "steel"), DataError);
}

TEST(BodyTest, OptionsThatMakeNoBodyAreRefused) {
  BodyOptions blunt;
  blunt.nose_length_m = 0.05;
  EXPECT_THROW(MakeBody(blunt), DataError);
  BodyOptions wide;
  wide.diameter_m = 1.0;
  EXPECT_THROW(MakeBody(wide), DataError);
  BodyOptions tailless;
  tailless.tail_diameter_m = 0.3;
  EXPECT_THROW(MakeBody(tailless), DataError);
}

}  // namespace
}  // namespace sonarcal::sim
