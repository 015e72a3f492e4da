// Echoes gathered while rays are cast against the list of echoes and against the image that shades each ray.
#include "sim/gathered/cast_echo_power.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sim/acoustic/acoustic_frame.h"
#include "sim/gathered/pixel_echoes.h"
#include "sim/scenes/scenes.h"
#include "sim/scenes/sonar_presets.h"
#include "tests/sim/thread_limit.h"

namespace sonarcal::sim {
namespace {

// `together`: columns that are joined.
struct PowerCase {
  RayFanOptions fan;
  int together = 1;
};

class CastEchoes : public ::testing::TestWithParam<PowerCase> {
 protected:
  static ParameterSet Parameters() {
    ParameterSet set;
    set.model = EchoModel::kAcoustic;
    set.source_level_db = 200.0;
    set.materials["default"].gsab = {.a = 80.0, .b_deg = 3.0, .c = 2.0, .d = 1.5, .e = 8.0, .f_deg = 14.0};
    set.materials["mockup"].gsab = {.a = 4.0, .b_deg = 5.0, .c = 20.0, .d = 1.0, .e = 10.0, .f_deg = 12.0};
    return set;
  }
  static SimulationOptions Options() {
    SimulationOptions options;
    options.fan = GetParam().fan;
    options.noise = false;
    return options;
  }

  // Powers of the pixels, from the curves at the nodes.
  Grid<double> PowerOf(const PixelEchoes& pixels) const {
    const std::vector<std::string>& names = simulator_.caster().material_names();
    const std::size_t nodes = CoarseIncidenceDeg().size();
    const EchoPowerModel model(geometry_, parameters_, names);
    Grid<double> power(geometry_.sonar.axes.range_bins, geometry_.sonar.axes.beam_count());
    for (std::size_t pixel = 0; pixel < power.size(); ++pixel) {
      for (std::uint32_t e = pixels.start[pixel]; e < pixels.start[pixel + 1]; ++e) {
        const auto& [node, weight] = pixels.entries[e];
        power.values()[pixel] += weight * model.level() *
                                 GsabPower(parameters_.Material(names[node / nodes]).gsab,
                                           std::min(CoarseIncidenceDeg()[node % nodes], 89.9));
      }
    }
    return power;
  }

  // Largest difference of two images in decibels, over pixels within `below_db` of the brightest.
  static double LargestDb(const Grid<double>& one, const Grid<double>& other, double below_db) {
    const double least =
        *std::max_element(other.values().begin(), other.values().end()) * PowerFromDb(-below_db);
    double largest_db = 0.0;
    for (std::size_t i = 0; i < one.size(); ++i) {
      if (other.values()[i] < least) continue;
      largest_db = std::max(largest_db, std::abs(DbFromPower(one.values()[i] / other.values()[i])));
    }
    return largest_db;
  }

  ParameterSet parameters_ = Parameters();
  Simulator simulator_{MakeMockupTank(), FindSonarPreset("p900-45").sonar, Options()};
  AcousticGeometry geometry_{simulator_.sonar(), simulator_.absorption_db_per_m()};
  Pose pose_ = MockupTankPoses(3)[1];
};

TEST_P(CastEchoes, EqualThoseOfTheListOfEchoes) {
  EXPECT_EQ(ColumnsTogether(simulator_.fan(), geometry_, parameters_), GetParam().together);
  const EchoPower of_list =
      GatherEchoPower(simulator_.TraceEchoes(pose_), simulator_.fan(), geometry_, parameters_);
  const Grid<double> slow =
      PowerOf(GatherPixelEchoes(of_list, MakePowerResponse(simulator_.sonar(), parameters_,
                                                           of_list.column_azimuth_rad, of_list.range_steps)));
  const Grid<double> quick = PowerOf(GatherPixelEchoes(simulator_, pose_, parameters_));
  // Exact up to single precision, or up to the shares of an echo between two columns.
  EXPECT_LT(LargestDb(quick, slow, 40.0), GetParam().together == 1 ? 2e-3 : 0.17);
}

// Nodes of incidence differ from the curve itself, by the errors that sim/gathered/pixel_echoes.h states, and
// joined columns as above.
TEST_P(CastEchoes, ShadeTheImageOfTheRays) {
  const Grid<double> rays =
      EchoPowerImage(CastScatterMap(simulator_.caster(), simulator_.fan(), pose_, geometry_, parameters_),
                     geometry_, parameters_);
  EXPECT_LT(LargestDb(PowerOf(GatherPixelEchoes(simulator_, pose_, parameters_)), rays, 40.0),
            GetParam().together == 1 ? 0.08 : 0.15);
}

TEST_P(CastEchoes, AreTheSameOnAnyNumberOfThreads) {
  const auto weights = [&] {
    std::vector<float> of;
    for (const PixelEchoes::Entry& entry : GatherPixelEchoes(simulator_, pose_, parameters_).entries)
      of.push_back(entry.weight);
    return of;
  };
  EXPECT_EQ(testing::WithThreads(1, weights), testing::WithThreads(2, weights));
}

INSTANTIATE_TEST_SUITE_P(
    All, CastEchoes,
    ::testing::Values(PowerCase{.fan = {.sampling = Sampling::kBeams, .cols = 300, .rows = 300}},
                      PowerCase{.fan = {.sampling = Sampling::kBeams, .cols = 1500, .rows = 300},
                                .together = 3},
                      PowerCase{.fan = {.sampling = Sampling::kBeams,
                                        .cols = 2560,
                                        .rows = 200,
                                        .elevation_span_deg = 176.0,
                                        .azimuth_margin_deg = 3.0,
                                        .row_crowding = 6.0,
                                        .stagger = true,
                                        .stagger_rows = true},
                                .together = 5}));

// A beam's weights times linear shares, over the columns that are joined: no error on average.
TEST(SharpenedForShares, LeaveNoErrorOnAverage) {
  ResponseWindow window{.first = 0, .weight = {}};
  const auto response = [](double column) { return GaussianResponse(column - 40.0, kColumnsOfBeam); };
  for (int col = 0; col <= 80; ++col) window.weight.push_back(response(col));
  for (const int together : {2, 3, 5, 50}) {
    const ResponseWindow sharp = SharpenedForShares({window}, together).front();
    for (int col = 5; col < 75; ++col) {
      double mean = 0.0;
      for (int i = -together / 2; i < together - together / 2; ++i) {
        const double part = std::abs(static_cast<double>(i) / together);
        const int next = i < 0 ? col - 1 : col + 1;
        const double shared = (1.0 - part) * sharp.weight[col] + part * sharp.weight[next];
        const double expected = response(i < 0 ? col - part : col + part);
        EXPECT_NEAR(shared, expected, 0.004) << col << ' ' << part;
        mean += (shared - expected) / together;
      }
      EXPECT_NEAR(mean, 0.0, 3e-4) << together << ' ' << col;
    }
  }
}

}  // namespace
}  // namespace sonarcal::sim
