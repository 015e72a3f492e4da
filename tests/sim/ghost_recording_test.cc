// Ghosts against a recording that somebody else's coherent simulation made, with mirrors in the tank: all its
// parameters are given, nothing is fitted.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>

#include "sim/ghost_power.h"
#include "tests/sim/synthetic_truth.h"

namespace sonarcal {
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
TEST_F(SyntheticTankWithGhosts, GhostsExplainWhatTheDirectImageDoesNot) {
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

}  // namespace
}  // namespace sonarcal
