// Ghosts against a recording that somebody else's coherent simulation made, with mirrors in the tank: all its
// parameters are given, nothing is fitted.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <iterator>

#include "sim/ghosts/ghost_power.h"
#include "sim/physics/beam_and_pulse.h"
#include "tests/sim/synthetic_truth.h"

namespace sonarcal::sim {
namespace {

using namespace testing;  // NOLINT: the helpers of tests/sim

// Cells of many pixels, so that speckle averages out: 5.6 dB is 21.5 grey levels, and a cell of 22 x 32
// pixels holds 41 independent ones.
constexpr int kCellBins = 22;
constexpr int kCellBeams = 32;

// From where the sonar's own near field ends; the last bins lack what lies beyond the window.
constexpr int kFirstBin = 24;
constexpr int kLastBin = 654;

class SyntheticTankWithGhosts : public SyntheticTruth {
 protected:
  void SetUp() override {
    SONARCAL_NEEDS_RECORDING(folder, "synthetic_tank_ghosts");
    Open(folder);
  }

  PolarImage PowerOf(const ScatterMap& scatter) const {
    return ExpectedPower(scatter, geometry(), parameters_);
  }

  Grid<float> Shown(const PolarImage& power) const {
    return ExpectedDisplay(power, parameters_, 255.0).value;
  }

  static double CellMean(const Grid<float>& values, int row, int col) {
    double sum = 0.0;
    for (int bin = 0; bin < kCellBins; ++bin) {
      for (int beam = 0; beam < kCellBeams; ++beam) {
        sum += values(row * kCellBins + bin, col * kCellBeams + beam);
      }
    }
    return sum / (kCellBins * kCellBeams);
  }

  // By how much what is expected changes within a cell, grey levels.
  static double CellSpread(const Grid<float>& values, int row, int col) {
    const double mean = CellMean(values, row, col);
    double squares = 0.0;
    for (int bin = 0; bin < kCellBins; ++bin) {
      for (int beam = 0; beam < kCellBeams; ++beam) {
        const double off = values(row * kCellBins + bin, col * kCellBeams + beam) - mean;
        squares += off * off;
      }
    }
    return std::sqrt(squares / (kCellBins * kCellBeams));
  }
};

// Each mirror's ghosts where they are most of what a pixel has: recorded over expected power. Of the floor
// this tells whether the two ways of a pair add as fields (four times one) or as powers (3 dB less); of the
// wall, whose pairs arrive apart, how a surface scatters from one direction to another.
//
// Cells, where ghosts or not are smooth: mean displayed values with and without ghosts beside the recorded.
TEST_F(SyntheticTankWithGhosts, GhostsExplainTheEchoesThatTheDirectImageLacks) {
  std::array<MeanRatio, 2> of_mirror;
  const std::array<std::string, 2> names = {"floor", "wall"};
  double without = 0.0;
  double with = 0.0;
  double without_where_ghosts = 0.0;
  double with_where_ghosts = 0.0;
  int cells = 0;
  int ghost_cells = 0;
  for (int index = 0; index < recording_->frame_count(); ++index) {
    const Frame frame = recording_->ReadFrame(index);
    const Pose& pose = *frame.info.world_from_sonar;
    const ScatterMap direct =
        MakeScatterMap(simulator_->TraceEchoes(pose), simulator_->fan(), geometry(), parameters_);
    const GhostList ghosts = simulator_->TraceGhosts(pose, parameters_);
    ScatterMap both = direct;
    AddGhosts(ghosts, geometry(), parameters_, both);
    const PolarImage power = PowerOf(both);

    for (std::size_t mirror = 0; mirror < names.size(); ++mirror) {
      GhostList others{{}, ghosts.material_names};
      for (const GhostEcho& echo : ghosts.echoes) {
        if (ghosts.material_names[echo.leg.mirror[0]] != names[mirror]) others.echoes.push_back(echo);
      }
      ScatterMap but_this = direct;
      AddGhosts(others, geometry(), parameters_, but_this);
      const Grid<float> rest = PowerOf(but_this).value;
      for (int bin = kFirstBin; bin < kLastBin; ++bin) {
        for (int beam = 0; beam < rest.cols(); ++beam) {
          if (!(power.value(bin, beam) > 2.0F * rest(bin, beam))) continue;
          of_mirror[mirror].Add(RecordedPower(frame.image.value(bin, beam)) / double{power.value(bin, beam)});
        }
      }
    }

    const Grid<float> shown = Shown(power);
    const Grid<float> shown_direct = Shown(PowerOf(direct));
    for (int row = kFirstBin / kCellBins + 1; row < kLastBin / kCellBins; ++row) {
      for (int col = 0; col < shown.cols() / kCellBeams; ++col) {
        if (CellSpread(shown, row, col) > 12.0 || CellSpread(shown_direct, row, col) > 12.0) continue;
        const double recorded = CellMean(frame.image.value, row, col);
        const double ghosts_add = CellMean(shown, row, col) - CellMean(shown_direct, row, col);
        const double off_with = std::abs(CellMean(shown, row, col) - recorded);
        const double off_without = std::abs(CellMean(shown_direct, row, col) - recorded);
        with += off_with;
        without += off_without;
        ++cells;
        if (ghosts_add < 4.0) continue;
        with_where_ghosts += off_with;
        without_where_ghosts += off_without;
        ++ghost_cells;
      }
    }
  }
  std::cout << "synthetic recording with ghosts, mean absolute residual of " << cells
            << " smooth cells: " << without / cells << " grey levels without ghosts, " << with / cells
            << " with; of the " << ghost_cells
            << " that ghosts raise by four levels and more: " << without_where_ghosts / ghost_cells << " and "
            << with_where_ghosts / ghost_cells << "\n";
  for (std::size_t mirror = 0; mirror < names.size(); ++mirror) {
    std::cout << "ghosts by the " << names[mirror] << ": recorded " << of_mirror[mirror].Db()
              << " dB above expected, over " << of_mirror[mirror].count << " pixels\n";
    // 17 pixels are as one (see synthetic_truth_test.cc): 4.5 standard errors, and what is left of the
    // model's own error, 0.5 dB.
    EXPECT_GT(of_mirror[mirror].count, 2000.0);
    EXPECT_NEAR(of_mirror[mirror].Db(), 0.0, 0.5 + 4.34 * 4.5 * std::sqrt(17.0 / of_mirror[mirror].count))
        << names[mirror];
  }
  EXPECT_GT(cells, 400);
  EXPECT_GT(ghost_cells, 30);
  EXPECT_LT(with, 0.85 * without);
  EXPECT_LT(with_where_ghosts, 0.5 * without_where_ghosts);
}

// Factor of one part of the expected power that fits the recording best: weighted least squares over the
// pixels that show this part, whose standard deviation is at most the whole power. 17 pixels are as one.
struct PartFactor {
  void Add(double recorded, double rest, double part) {
    const double whole = rest + part;
    if (part < 0.05 * rest) return;
    product += (recorded - rest) * part / (whole * whole);
    square += part * part / (whole * whole);
  }
  double Value() const { return product / square; }
  double Sigma() const { return std::sqrt(17.0 / square); }

  double product = 0.0;
  double square = 0.0;
};

// Recorded over expected power: ghosts by the surface, by the elevation of the leg further off the axis;
// direct echoes through side lobes. docs/studies/ghosts.md shows the output.
TEST_F(SyntheticTankWithGhosts, HasDirectEchoesThroughSideLobesAndNoGhosts) {
  const double main_deg =
      DegFromRad(MainLobeEndRad(ElevationResponseOf(simulator_->sonar(), parameters_.beam)));
  EXPECT_NEAR(main_deg, 38.0, 0.5);
  const std::array<double, 8> edges_deg = {0.0, 20.0, 25.0, 30.0, 34.0, main_deg, 50.0, 70.0};
  ParameterSet all_lobes = parameters_;
  all_lobes.beam.mirror_lobes = MirrorLobes::kAll;
  std::array<PartFactor, edges_deg.size() - 1> of_ghosts;
  PartFactor of_direct;
  for (int index = 0; index < recording_->frame_count(); ++index) {
    const Frame frame = recording_->ReadFrame(index);
    const Pose& pose = *frame.info.world_from_sonar;
    const EchoList echoes = simulator_->TraceEchoes(pose);
    const GhostList ghosts = simulator_->TraceGhosts(pose, all_lobes);
    const auto off_axis_deg = [](const GhostEcho& echo) {
      return DegFromRad(std::max(std::abs(echo.leg.elevation_rad), std::abs(echo.other.elevation_rad)));
    };
    // Power with the ghosts that are kept and, if `side_lobes`, the direct echoes through side lobes.
    const auto power = [&](const auto& keep, bool side_lobes) {
      EchoList direct = echoes;
      for (std::size_t i = 0; i < direct.size(); ++i) {
        if (!side_lobes && DegFromRad(std::abs(direct.elevation_rad[i])) > main_deg)
          direct.solid_angle_sr[i] = 0.0F;
      }
      ScatterMap scatter = MakeScatterMap(direct, simulator_->fan(), geometry(), all_lobes);
      GhostList kept{{}, ghosts.material_names};
      std::copy_if(ghosts.echoes.begin(), ghosts.echoes.end(), std::back_inserter(kept.echoes), keep);
      AddGhosts(kept, geometry(), all_lobes, scatter);
      return PowerOf(scatter).value;
    };
    const auto add = [&](const Grid<float>& rest, const Grid<float>& whole, PartFactor& factor) {
      for (int bin = kFirstBin; bin < kLastBin; ++bin) {
        for (int beam = 0; beam < rest.cols(); ++beam) {
          factor.Add(RecordedPower(frame.image.value(bin, beam)), rest(bin, beam),
                     double{whole(bin, beam)} - double{rest(bin, beam)});
        }
      }
    };
    const auto in_main = [&](const GhostEcho& echo) { return off_axis_deg(echo) <= main_deg; };
    const Grid<float> known = power(in_main, true);
    add(power(in_main, false), known, of_direct);
    for (std::size_t i = 0; i < of_ghosts.size(); ++i) {
      const auto in_part = [&](const GhostEcho& echo) {
        const double deg = off_axis_deg(echo);
        return ghosts.material_names[echo.leg.mirror[0]] == "surface" && deg > edges_deg[i] &&
               deg <= edges_deg[i + 1];
      };
      const bool in_known = edges_deg[i] < main_deg;
      const auto in_rest = [&](const GhostEcho& echo) { return in_main(echo) && !in_part(echo); };
      const auto in_whole = [&](const GhostEcho& echo) { return in_main(echo) || in_part(echo); };
      if (in_known) {
        add(power(in_rest, true), known, of_ghosts[i]);
      } else {
        add(known, power(in_whole, true), of_ghosts[i]);
      }
    }
  }
  const auto print = [](const std::string& what, const PartFactor& factor) {
    std::cout << what << ": recorded " << factor.Value() << " +- " << factor.Sigma() << " of expected\n";
  };
  print("direct echoes through side lobes in elevation", of_direct);
  for (std::size_t i = 0; i < of_ghosts.size(); ++i) {
    print(fmt::format("ghosts by the surface, {:.0f} to {:.0f} degrees", edges_deg[i], edges_deg[i + 1]),
          of_ghosts[i]);
    const double expected = edges_deg[i] < main_deg ? 1.0 : 0.0;
    EXPECT_NEAR(of_ghosts[i].Value(), expected, 4.0 * of_ghosts[i].Sigma()) << edges_deg[i];
  }
  EXPECT_NEAR(of_direct.Value(), 1.0, 4.0 * of_direct.Sigma());
  EXPECT_LT(of_ghosts.back().Sigma(), 0.1);
}

}  // namespace
}  // namespace sonarcal::sim
