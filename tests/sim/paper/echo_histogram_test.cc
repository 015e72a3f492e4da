#include "sim/paper/echo_histogram.h"

#include <gtest/gtest.h>

#include <map>

#include "sim/simulator.h"
#include "tests/sim/meshes.h"
#include "tests/sim/slow_paper_model.h"

namespace sonarcal::sim {
namespace {

using namespace testing;  // NOLINT: the helpers of tests/sim

Scene Tank() {
  Scene scene;
  AddQuad(scene, {-20, -20, 0}, {40, 0, 0}, {0, 40, 0}, "floor");
  AddBox(scene, {-1.0, 3.0, 0.0}, {-0.2, 3.8, 0.9}, "box");
  return scene;
}

SonarModel HistogramSonar() {
  return MakeSonar({-12, -9, -7, -4, -2, 0, 1, 3, 6, 10}, 24.0, 1.5, 8.0, 130);
}

const Pose kPose{RotationFromYawPitchRoll(0.1, -0.1, 0.05), {0, 0, 1.1}};

EchoList TankEchoes() {
  const SonarModel sonar = HistogramSonar();
  const RayFan fan(sonar, {.sampling = Sampling::kFrustum, .cols = 111, .rows = 80});
  return Trace(RayCaster(Tank()), fan, kPose, sonar.axes);
}

// Rays whose range or incidence rounds to the other side of a border belong to a neighbouring cell or node.
TEST(EchoHistogram, CastInOnePassIsThatOfTheList) {
  const SonarModel sonar = HistogramSonar();
  const RayCaster caster(Tank());
  for (const RayFanOptions& options :
       {RayFanOptions{.sampling = Sampling::kFrustum, .cols = 111, .rows = 80},
        RayFanOptions{.sampling = Sampling::kBeams, .cols = 111, .rows = 80},
        RayFanOptions{.sampling = Sampling::kBeams, .cols = 222, .rows = 90, .stagger = true}}) {
    const RayFan fan(sonar, options);
    const EchoHistogram slow = GatherEchoes(Trace(caster, fan, kPose, sonar.axes), sonar.axes);
    const EchoHistogram quick = CastEchoHistogram(caster, fan, kPose, sonar.axes);
    EXPECT_EQ(quick.rows, slow.rows);
    EXPECT_EQ(quick.beams, slow.beams);
    EXPECT_EQ(quick.materials, slow.materials);
    ASSERT_EQ(quick.cells.size(), slow.cells.size());
    ASSERT_GT(slow.cells.size(), 400U);
    EXPECT_EQ(quick.row_start, slow.row_start);
    for (std::size_t i = 0; i < slow.cells.size(); ++i) {
      const EchoHistogram::Cell& one = quick.cells[i];
      const EchoHistogram::Cell& other = slow.cells[i];
      ASSERT_EQ(std::pair(one.row, one.col), std::pair(other.row, other.col));
      EXPECT_NEAR(one.weight, other.weight, 1e-6 * other.weight) << i;
      EXPECT_NEAR(one.log_range, other.log_range, 1e-5) << i;
      EXPECT_NEAR(one.two_way_range_m, other.two_way_range_m, 1e-5 * other.two_way_range_m) << i;
      EXPECT_NEAR(one.range_offset, other.range_offset, 1e-4) << i;
      EXPECT_NEAR(one.azimuth_offset, other.azimuth_offset, 1e-4) << i;
      std::map<std::uint32_t, double> nodes;
      for (std::uint32_t entry = one.first_entry; entry < one.last_entry; ++entry)
        nodes[quick.entries[entry].node] += quick.entries[entry].weight;
      for (std::uint32_t entry = other.first_entry; entry < other.last_entry; ++entry)
        nodes[slow.entries[entry].node] -= slow.entries[entry].weight;
      for (const auto& [node, difference] : nodes) EXPECT_NEAR(difference, 0.0, 2e-4 * other.weight) << node;
    }
  }
}

// Everything the histogram keeps, counted again echo by echo.
TEST(EchoHistogram, EveryCellEqualsARecountEchoByEcho) {
  const EchoList echoes = TankEchoes();
  const PolarAxes axes = HistogramSonar().axes;
  const EchoHistogram histogram = GatherEchoes(echoes, axes);
  struct Recount {
    double weight = 0.0, log_range = 0.0, two_way = 0.0;
    std::map<std::uint32_t, double> nodes;
  };
  std::map<std::pair<int, int>, Recount> recount;
  for (std::size_t echo = 0; echo < echoes.size(); ++echo) {
    const double range_m = echoes.range_m[echo];
    const int row = static_cast<int>(std::floor((range_m - 1.5) / (6.5 / 130 / kRangeSteps)));
    Recount& cell = recount[{row, echoes.Beam(echo)}];
    const double weight = 1.0 / echoes.rays_per_beam[echoes.Beam(echo)];
    cell.weight += weight;
    cell.log_range += weight * 40.0 * std::log10(range_m);
    cell.two_way += weight * 2.0 * range_m;
    const double position = echoes.incidence_rad[echo] * 180.0 / kPi / 0.25;
    for (int node = 0; node <= 360; ++node) {  // hat functions
      const double share = 1.0 - std::abs(position - node);
      if (share > 0.0) cell.nodes[echoes.material[echo] * 361U + node] += share * weight;
    }
  }

  ASSERT_EQ(histogram.cells.size(), recount.size());
  ASSERT_EQ(histogram.row_start.size(), 130U * kRangeSteps + 1);
  EXPECT_EQ(histogram.row_start.back(), histogram.cells.size());
  auto expected = recount.begin();  // by row, then column
  for (std::size_t i = 0; i < histogram.cells.size(); ++i, ++expected) {
    const EchoHistogram::Cell& cell = histogram.cells[i];
    ASSERT_EQ(std::pair(cell.row, cell.col), expected->first);
    EXPECT_GE(i, histogram.row_start[cell.row]);
    EXPECT_LT(i, histogram.row_start[cell.row + 1]);
    EXPECT_NEAR(cell.weight, expected->second.weight, 1e-12);
    EXPECT_NEAR(cell.log_range, expected->second.log_range, 1e-11);
    EXPECT_NEAR(cell.two_way_range_m, expected->second.two_way, 1e-11);
    std::map<std::uint32_t, double> nodes;
    for (std::uint32_t entry = cell.first_entry; entry < cell.last_entry; ++entry) {
      nodes[histogram.entries[entry].node] += histogram.entries[entry].weight;
    }
    for (const auto& [node, weight] : expected->second.nodes) {
      EXPECT_NEAR(nodes[node], weight, 1e-7 * weight + 1e-12);  // a float
      nodes.erase(node);
    }
    for (const auto& [node, weight] : nodes) EXPECT_LT(weight, 1e-12) << "a node that no echo touches";
  }
}

TEST(EchoHistogram, WeightsSumToTheShareOfRaysThatCameBack) {
  const EchoList echoes = TankEchoes();
  const EchoHistogram histogram = GatherEchoes(echoes, HistogramSonar().axes);
  std::vector<double> share(10, 0.0);
  for (const auto& cell : histogram.cells) share[cell.col] += cell.weight;
  std::vector<int> count(10, 0);
  for (std::size_t echo = 0; echo < echoes.size(); ++echo) ++count[echoes.Beam(echo)];
  for (int beam = 0; beam < 10; ++beam) {
    EXPECT_NEAR(share[beam] * echoes.rays_per_beam[beam], count[beam], 1e-9);
    EXPECT_GT(count[beam], 100);
  }
}

TEST(EchoHistogram, NoEchoesNoCells) {
  EchoList none;
  none.material_names = {"floor"};
  const EchoHistogram histogram = GatherEchoes(none, HistogramSonar().axes);
  EXPECT_TRUE(histogram.cells.empty());
  EXPECT_EQ(histogram.row_start, std::vector<std::uint32_t>(130 * kRangeSteps + 1, 0));
}

// Trace once, shade many.
TEST(EchoHistogram, ShadingCastsNoRay) {
  SimulationOptions options;
  options.fan = {.sampling = Sampling::kBeams, .cols = 50, .rows = 40};
  const Simulator simulator(Tank(), HistogramSonar(), options);
  const EchoList echoes = simulator.TraceEchoes(kPose);
  EXPECT_EQ(simulator.caster().rays_cast(), 50 * 40);
  ParameterSet parameters;
  parameters.materials["default"] = {};
  parameters.display = {.db_min = 100.0, .db_max = 200.0};
  PolarImage before = simulator.RenderExpected(echoes, parameters);
  parameters.materials["default"].gsab.c = 1.0;
  EXPECT_NE(simulator.RenderExpected(echoes, parameters).value, before.value);
  simulator.RenderEchoes(echoes, parameters);
  EXPECT_EQ(simulator.caster().rays_cast(), 50 * 40);
}

}  // namespace
}  // namespace sonarcal::sim
