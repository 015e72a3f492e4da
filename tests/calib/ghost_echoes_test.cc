// Ghosts gathered by pixel against the image that adds them ray by ray.
#include "sim/gathered/ghost_echoes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/types/units.h"
#include "sim/ghosts/ghost_power.h"
#include "sim/physics/gsab.h"
#include "tests/calib/small_tank.h"

namespace sonarcal::calib {
namespace {

class GhostEchoesTest : public ::testing::Test {
 protected:
  static ParameterSet Parameters() {
    ParameterSet parameters = testing::SmallTankAcousticTruth();
    parameters.receiver.noise_db.reset();
    parameters.pulse.length_m = 0.05;
    parameters.mirrors["floor"].loss_db = 5.0;
    parameters.mirrors["wall"].loss_db = 9.0;
    for (const char* name : {"wall", "board"}) parameters.materials[name] = parameters.materials["box"];
    parameters.beam.transmit_even_deg = 15.0;
    parameters.beam.transmit_end_deg = 30.0;
    const int beams = testing::SmallSonar().axes.beam_count();
    for (int beam = 0; beam < beams; ++beam)
      parameters.beam.sensitivity_db.push_back(0.1 * (beam % 20) - 1.5);
    return parameters;
  }

  // The ghosts' own part of an image, ray by ray.
  Grid<float> Slow(const sim::GhostList& ghosts, const ParameterSet& parameters) const {
    sim::EchoList none;
    none.cols = simulator_.fan().cols();
    const sim::AcousticGeometry geometry{simulator_.sonar(), simulator_.absorption_db_per_m()};
    sim::ScatterMap scatter = sim::MakeScatterMap(none, simulator_.fan(), geometry, parameters);
    sim::AddGhosts(ghosts, geometry, parameters, scatter);
    return sim::ExpectedPower(scatter, geometry, parameters).value;
  }

  // The same as the sum that the header states, term by term.
  static double Sum(const sim::GhostEchoes& ghosts, std::size_t pixel, const std::vector<std::string>& names,
                    const ParameterSet& parameters) {
    const std::vector<double>& nodes_deg = sim::CoarseIncidenceDeg();
    double sum = 0.0;
    for (std::uint32_t e = ghosts.pixels.start[pixel]; e < ghosts.pixels.start[pixel + 1]; ++e) {
      const sim::PixelEchoes::Entry& entry = ghosts.pixels.entries[e];
      const double angle_deg = nodes_deg[entry.node % nodes_deg.size()];
      const std::size_t run = entry.node / nodes_deg.size();
      const std::size_t part = run % sim::kCurveParts;
      const std::size_t material = run / sim::kCurveParts % names.size();
      const sim::GhostWay& way = ghosts.ways.at(run / sim::kCurveParts / names.size());
      double loss_db = 0.0;
      for (const std::uint16_t mirror : way) loss_db += parameters.mirrors.at(names[mirror]).loss_db;
      const GsabParameters<double>& gsab = parameters.Material(names[material]).gsab;
      const double sigma = part == 0
                               ? sim::GsabPeaksPower(gsab, angle_deg)
                               : sim::GsabSlowPower(gsab, std::max(std::cos(RadFromDeg(angle_deg)), 1e-9));
      sum += entry.weight * PowerFromDb(-loss_db) * sigma;
    }
    return sum;
  }

  const sim::Simulator simulator_{testing::SmallTankWithWall(), testing::SmallSonar(),
                                  testing::SmallTankOptions()};
};

TEST_F(GhostEchoesTest, TheSumOfAPixelIsTheImageThatRaysMake) {
  for (const int order : {1, 2}) {
    sim::SimulationOptions options = testing::SmallTankOptions();
    options.ghost_order = order;
    const sim::Simulator simulator(testing::SmallTankWithWall(), testing::SmallSonar(), options);
    const ParameterSet parameters = Parameters();
    double largest = 0.0;
    double worst = 0.0;
    std::size_t ways = 0;
    for (const Pose& pose : testing::SmallTankPoses()) {
      const sim::GhostList ghosts = simulator.TraceGhosts(pose, parameters);
      const sim::GhostEchoes fast = sim::GatherGhostEchoes(simulator, ghosts, parameters);
      ways = std::max(ways, fast.ways.size());
      ParameterSet others = parameters;  // whatever losses and curves, the sums are the same entries'
      others.mirrors["floor"].loss_db = 1.0;
      others.materials["box"].gsab.c *= 3.0;
      others.materials["floor"].gsab.d = 0.8;
      for (const ParameterSet& at : {parameters, others}) {
        const Grid<float> slow = Slow(ghosts, at);
        const double level = PowerFromDb(at.source_level_db + at.receiver.gain_db);
        for (std::size_t pixel = 0; pixel < slow.size(); ++pixel) {
          const double sum = level * Sum(fast, pixel, ghosts.material_names, at);
          largest = std::max(largest, double{slow.values()[pixel]});
          worst = std::max(worst, std::abs(sum - slow.values()[pixel]));
        }
      }
    }
    EXPECT_GT(largest, 0.0);
    EXPECT_EQ(ways, order == 1 ? 4U : 5U) << "floor and wall, each once and twice; and one after the other";
    EXPECT_LT(worst, 0.01 * largest) << "of the brightest pixel, by ghosts of order " << order;
  }
}

TEST_F(GhostEchoesTest, WithoutMirrorsThereIsNothing) {
  ParameterSet parameters = Parameters();
  parameters.mirrors.clear();
  const sim::GhostList ghosts = simulator_.TraceGhosts(testing::SmallTankPoses().front(), parameters);
  EXPECT_TRUE(ghosts.echoes.empty());
  EXPECT_TRUE(sim::WaysOf(ghosts).empty());
}

TEST_F(GhostEchoesTest, WaysAreNamedByTheirMirrors) {
  const std::vector<std::string> names = {"floor", "wall"};
  EXPECT_EQ(sim::WayName({0}, names), "floor");
  EXPECT_EQ(sim::WayName({1, 1}, names), "wall twice");
  EXPECT_EQ(sim::WayName({0, 1}, names), "floor and wall");
  EXPECT_EQ(sim::WayName({0, 1, 1, 1}, names), "floor and wall 3 times");
}

}  // namespace
}  // namespace sonarcal::calib
