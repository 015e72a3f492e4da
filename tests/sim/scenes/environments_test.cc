// The environments of Park 2024 Section 5: sizes, closed meshes, normals, resolution, and what is seen of
// them.
#include "sim/scenes/environments.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "core/types/error.h"
#include "core/types/units.h"
#include "sim/scenes/bridge_pier.h"
#include "sim/scenes/jacket.h"
#include "sim/scenes/seabed.h"
#include "tests/support/mesh_checks.h"

namespace sonarcal::sim {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;
using testing::Bounds;
using testing::FirstHitM;
using testing::IsClosed;
using testing::SignedVolumeM3;

void ExpectBounds(const Scene& scene, const Vector3d& min_m, const Vector3d& max_m) {
  const AlignedBox3d bounds = Bounds(scene);
  EXPECT_LT((bounds.min() - min_m).cwiseAbs().maxCoeff(), 1e-5) << bounds.min().transpose();
  EXPECT_LT((bounds.max() - max_m).cwiseAbs().maxCoeff(), 1e-5) << bounds.max().transpose();
}

double LongestEdgeM(const Scene& scene) {
  double longest_m = 0.0;
  for (const Eigen::Vector3i& triangle : scene.triangles) {
    const auto corners = testing::Corners(scene, triangle);
    for (int i = 0; i < 3; ++i) longest_m = std::max(longest_m, (corners[(i + 1) % 3] - corners[i]).norm());
  }
  return longest_m;
}

template <typename Action>
std::string RefusalOf(const Action& action) {
  try {
    action();
  } catch (const std::exception& error) {
    return error.what();
  }
  return {};
}

TEST(SeabedTest, HasTheSizeOfThePaperAndUsesItsWholeHeight) {
  const Scene seabed = MakeSeabed();
  seabed.Validate("seabed");
  ExpectBounds(seabed, {-5.0, -5.0, 0.0}, {5.0, 5.0, 2.0});
  EXPECT_EQ(seabed.material_names, std::vector<std::string>{"seabed"});
}

TEST(SeabedTest, LooksUpEverywhereAndIsSmooth) {
  const Scene seabed = MakeSeabed();
  double steepest_deg = 0.0;
  for (const Eigen::Vector3i& triangle : seabed.triangles) {
    const auto [a, b, c] = testing::Corners(seabed, triangle);
    const Vector3d normal = (b - a).cross(c - a).normalized();
    ASSERT_GT(normal.z(), 0.0);
    steepest_deg = std::max(steepest_deg, std::acos(normal.z()) / kRadPerDeg);
  }
  EXPECT_GT(steepest_deg, 20.0);  // relief that is real,
  EXPECT_LT(steepest_deg, 65.0);  // and no cliff

  // Smooth: a second difference shrinks as the square of its step, where no extreme is cut off.
  const SeabedRelief relief{SeabedOptions{}};
  const auto bend_m = [&](double step_m) {
    double largest_m = 0.0;
    for (double x_m = -4.0; x_m < 4.0; x_m += 0.37) {
      for (double y_m = -4.0; y_m < 4.0; y_m += 0.41) {
        const double here_m = relief.HeightM(x_m, y_m);
        if (here_m < 0.05 || here_m > 1.95) continue;
        largest_m = std::max(largest_m, std::abs(relief.HeightM(x_m + step_m, y_m) - 2.0 * here_m +
                                                 relief.HeightM(x_m - step_m, y_m)));
      }
    }
    return largest_m;
  };
  EXPECT_NEAR(bend_m(0.02) / bend_m(0.01), 4.0, 0.1);
}

TEST(SeabedTest, TheReliefDoesNotDependOnTheResolution) {
  SeabedOptions options;
  const SeabedRelief relief(options);
  // The water's volume beneath, by the midpoint rule on a grid of its own.
  constexpr int kCells = 700;
  double expected_m3 = 0.0;
  for (int row = 0; row < kCells; ++row) {
    for (int col = 0; col < kCells; ++col) {
      expected_m3 += relief.HeightM((col + 0.5) * 10.0 / kCells - 5.0, (row + 0.5) * 10.0 / kCells - 5.0);
    }
  }
  expected_m3 *= 100.0 / (kCells * kCells);
  double error_before_m3 = 0.0;
  std::size_t triangles_before = 0;
  for (const double edge_m : {0.2, 0.1, 0.05}) {
    options.max_edge_m = edge_m;
    const Scene seabed = MakeSeabed(options);
    EXPECT_EQ(seabed.triangles.size(), static_cast<std::size_t>(2 * std::pow(std::round(10.0 / edge_m), 2)));
    double volume_m3 = 0.0;
    for (const Eigen::Vector3i& triangle : seabed.triangles) {
      const auto [a, b, c] = testing::Corners(seabed, triangle);
      volume_m3 += 0.5 * (b - a).cross(c - a).z() * (a.z() + b.z() + c.z()) / 3.0;
    }
    const double error_m3 = std::abs(volume_m3 - expected_m3);
    EXPECT_LT(error_m3, 0.001 * expected_m3);
    if (triangles_before > 0) {
      EXPECT_EQ(seabed.triangles.size(), 4 * triangles_before);
      EXPECT_LT(error_m3, 0.5 * error_before_m3);
    }
    error_before_m3 = error_m3;
    triangles_before = seabed.triangles.size();
  }
}

TEST(SeabedTest, TheSeedAloneDecidesTheRelief) {
  SeabedOptions options;
  EXPECT_EQ(MakeSeabed(options).vertices_m, MakeSeabed(options).vertices_m);
  options.seed = 2;
  const Scene other = MakeSeabed(options);
  EXPECT_NE(other.vertices_m, MakeSeabed().vertices_m);
  for (std::uint64_t seed = 2; seed < 12; ++seed) {
    options.seed = seed;
    options.max_edge_m = 0.1;
    const AlignedBox3d bounds = Bounds(MakeSeabed(options));
    EXPECT_GE(bounds.min().z(), 0.0);
    EXPECT_LE(bounds.max().z(), 2.0);
    EXPECT_GT(bounds.sizes().z(), 1.95) << seed;
  }
}

TEST(BridgePierTest, IsOneClosedSolidOfTheSizeAndVolumeThatItsOptionsSay) {
  BridgePierOptions options;
  for (const double length_m : {4.0, 3.0}) {
    for (const double edge_m : {10.0, 0.25}) {
      options.length_m = length_m;
      options.max_edge_m = edge_m;
      const Scene pier = MakeBridgePier(options);
      pier.Validate("pier");
      ExpectBounds(pier, {-0.5 * length_m, -2.0, 0.0}, {0.5 * length_m, 2.0, 9.5});
      EXPECT_TRUE(IsClosed(pier));
      EXPECT_EQ(testing::EulerCharacteristic(pier), 2);
      // Boxes and frusta of pyramids: h/3 (A + a + sqrt(A a)), with shares of the full section.
      const auto frustum = [](double height_m, double share, double other) {
        return height_m / 3.0 * (share * share + other * other + share * other);
      };
      const double volume_m3 = length_m * 4.0 *
                               (frustum(1.5, 1.0, 1.0) + frustum(9.5 - 1.5 - 1.3 - 1.2, 0.6, 0.5) +
                                frustum(1.3, 0.5, 1.0) + frustum(1.2, 1.0, 1.0));
      EXPECT_NEAR(SignedVolumeM3(pier), volume_m3, 1e-4 * volume_m3);
    }
  }
}

TEST(BridgePierTest, SidesOfItsQuadrilateralsStayWithinTheLimit) {
  BridgePierOptions options;
  std::size_t before = 0;
  for (const double edge_m : {1.0, 0.5, 0.25}) {
    options.max_edge_m = edge_m;
    const Scene pier = MakeBridgePier(options);
    // Diagonals of quadrilaterals that lean by 45 degrees, with one side edge_m and one edge_m / sqrt(2)
    // high.
    EXPECT_LE(LongestEdgeM(pier), std::hypot(1.0 + std::sqrt(0.5), std::sqrt(0.5)) * edge_m * 1.001);
    EXPECT_GT(pier.triangles.size(), 2 * before);
    before = pier.triangles.size();
  }
}

TEST(JacketTest, IsAUnionOfClosedPipesOfTheSizeThatThePaperPrints) {
  for (const double edge_m : {0.25, 0.07}) {
    JacketOptions options;
    options.max_edge_m = edge_m;
    const Scene jacket = MakeJacket(options);
    jacket.Validate("jacket");
    ExpectBounds(jacket, {-2.5, -2.5, 0.0}, {2.5, 2.5, 8.5});
    EXPECT_TRUE(IsClosed(jacket));
    const std::vector<Scene> solids = testing::Pieces(jacket);
    const std::vector<Pipe> pipes = JacketPipes(options);
    ASSERT_EQ(solids.size(), pipes.size());
    double expected_m3 = 0.0;  // of prisms on polygons inscribed into circles
    for (const Pipe& pipe : pipes) {
      const int n = JacketSectors(options, pipe.radius_m);
      expected_m3 += 0.5 * n * pipe.radius_m * pipe.radius_m * std::sin(2.0 * kPi / n) *
                     (pipe.to_m - pipe.from_m).norm();
    }
    for (const Scene& solid : solids) EXPECT_GT(SignedVolumeM3(solid), 0.0);
    EXPECT_NEAR(SignedVolumeM3(jacket), expected_m3, 1e-4 * expected_m3);
    EXPECT_LE(LongestEdgeM(jacket), std::sqrt(2.0) * edge_m * 1.001);
  }
}

TEST(JacketTest, HasFourLegsThatLeanInwardsAndDiametersAsGiven) {
  JacketOptions options;
  options.leg_diameter_m = 0.5;
  options.brace_diameter_m = 0.1;
  const std::vector<Pipe> pipes = JacketPipes(options);
  const auto count = [&](double radius_m) {
    return std::count_if(pipes.begin(), pipes.end(),
                         [&](const Pipe& pipe) { return std::abs(pipe.radius_m - radius_m) < 1e-12; });
  };
  EXPECT_EQ(count(0.25), 4);                       // legs
  EXPECT_EQ(count(0.05), 4 * options.bays * 2);    // braces
  EXPECT_EQ(count(0.14), 4 * (options.bays + 1));  // level pipes
  for (const Pipe& pipe : pipes) {
    if (pipe.radius_m != 0.25) continue;
    EXPECT_LT(pipe.to_m.head<2>().norm(), pipe.from_m.head<2>().norm());
    EXPECT_GT(pipe.to_m.z(), pipe.from_m.z());
  }
}

TEST(EnvironmentTest, OptionsThatCannotBeAreRefusedByName) {
  EXPECT_NE(RefusalOf([] { MakeSeabed({.height_m = -1.0}); }).find("height_m is -1"), std::string::npos);
  EXPECT_NE(RefusalOf([] { MakeSeabed({.max_edge_m = 0.0}); }).find("max_edge_m is 0"), std::string::npos);
  EXPECT_NE(RefusalOf([] { MakeSeabed({.max_edge_m = 1e-5}); }).find("triangles"), std::string::npos);
  EXPECT_NE(RefusalOf([] { MakeBridgePier({.head_height_m = 9.0}); }).find("head_height_m is 9"),
            std::string::npos);
  EXPECT_NE(RefusalOf([] { MakeBridgePier({.max_edge_m = 1e-9}); }).find("triangles"), std::string::npos);
  EXPECT_NE(RefusalOf([] { MakeJacket({.brace_diameter_m = 0.5}); }).find("brace_diameter_m is 0.5"),
            std::string::npos);
  EXPECT_NE(RefusalOf([] { MakeJacket({.sectors = 3}); }).find("sectors is 3"), std::string::npos);
  EXPECT_NE(RefusalOf([] { FindEnvironment("moon"); }).find("'moon', expected one of tank"),
            std::string::npos);
}

TEST(EnvironmentTest, AllCanBeMadeAndTheirMaterialsAreListed) {
  const std::vector<std::string> listed = EnvironmentMaterials();
  std::set<std::string> names;
  for (const Environment& environment : Environments()) {
    EXPECT_TRUE(names.insert(std::string(environment.name)).second);
    EXPECT_EQ(&FindEnvironment(environment.name), &environment);
    const Scene coarse = environment.make({.max_edge_m = 0.5, .surface = true, .bed = true});
    coarse.Validate(std::string(environment.name));
    for (const std::string& material : coarse.material_names) {
      EXPECT_NE(std::find(listed.begin(), listed.end(), material), listed.end()) << material;
    }
    const Scene fine = environment.make({.max_edge_m = 0.2, .surface = true, .bed = true});
    EXPECT_GT(fine.triangles.size(), 2 * coarse.triangles.size()) << environment.name;
    EXPECT_EQ(
        environment.make({.bed = true}).material_names.size() > environment.make({}).material_names.size(),
        environment.bed_m > 0.0)
        << environment.name;
  }
}

TEST(EnvironmentTest, EachViewpointSeesItsObjectAheadWithinRange) {
  for (const Environment& environment : Environments()) {
    const Scene scene = environment.make({.max_edge_m = 0.5});
    const std::vector<Pose> poses = environment.viewpoints();
    EXPECT_GE(poses.size(), 3u);
    for (const Pose& pose : poses) {
      int seen = 0;
      for (const double elevation_deg : {-9.0, -5.0, 0.0, 5.0}) {
        for (const double azimuth_deg : {-18.0, -9.0, 0.0, 9.0, 18.0}) {
          const double azimuth_rad = RadFromDeg(azimuth_deg);
          const double elevation_rad = RadFromDeg(elevation_deg);
          const Vector3d ahead(std::sin(azimuth_rad) * std::cos(elevation_rad),
                               std::cos(azimuth_rad) * std::cos(elevation_rad), std::sin(elevation_rad));
          const double hit_m = FirstHitM(scene, pose.position_m, pose.rotation * ahead);
          if (hit_m > 0.0) {
            EXPECT_GT(hit_m, 1.0) << environment.name;
          }
          seen += hit_m > 0.0 && hit_m < 9.0 ? 1 : 0;
        }
      }
      EXPECT_GE(seen, 4) << environment.name << " from " << pose.position_m.transpose();
      EXPECT_LE((pose.rotation * Vector3d::UnitY()).z(), 0.0);  // level, or slightly down
      EXPECT_GE((pose.rotation * Vector3d::UnitY()).z(), -0.6);
    }
  }
}

TEST(EnvironmentTest, LookingAtPutsTheTargetOnTheBoreSight) {
  const Vector3d from_m(1.0, -2.0, 3.0);
  const Vector3d target_m(-2.0, 4.0, 1.0);
  const Pose pose = LookingAt(from_m, target_m);
  const Vector3d seen_m = pose.Inverse() * target_m;
  EXPECT_TRUE(seen_m.isApprox(Vector3d(0.0, (target_m - from_m).norm(), 0.0), 1e-12));
  EXPECT_NEAR((pose.rotation * Vector3d::UnitX()).z(), 0.0, 1e-12);
  EXPECT_GT((pose.rotation * Vector3d::UnitZ()).z(), 0.0);
}

}  // namespace
}  // namespace sonarcal::sim
