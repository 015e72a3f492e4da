// A small world for fits: a floor and a box on it, a coarse sonar, a few poses. Quick to trace, and its
// incidence angles cover both Gaussians and the cosine of the backscatter curve.
#pragma once

#include <vector>

#include "calib/fit.h"
#include "sim/simulator.h"

namespace sonarcal::testing {

Scene SmallTank();
// The same with a wall behind the box, of its own material, and a board far outside what any pose sees.
Scene SmallTankWithWall();
SonarModel SmallSonar();
std::vector<Pose> SmallTankPoses();

// Steep contrasts, so that eight bits carry the curve: the paper divides a pixel by all rays of its beam.
ParameterSet SmallTankTruth();

// The same for the acoustic model: curves 20 dB lower, a noise floor; the display 110 .. 160 dB clips a tenth
// of the noise at the bottom.
ParameterSet SmallTankAcousticTruth();

sim::SimulationOptions SmallTankOptions();

// Frames as a fit wants them: the poses' echoes, and what `render` makes of each pose.
template <typename Render>
std::vector<calib::FitFrame> MakeFitFrames(const sim::Simulator& simulator, Render&& render) {
  std::vector<calib::FitFrame> frames;
  const std::vector<Pose> poses = SmallTankPoses();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const sim::EchoList echoes = simulator.TraceEchoes(poses[i]);
    const PolarImage image = render(echoes, static_cast<int>(i));
    frames.push_back({.index = static_cast<int>(i),
                      .echoes = sim::GatherEchoes(echoes, simulator.sonar().axes),
                      .measured = calib::MeasuredForFit(image),
                      .level = calib::GreyLevel(image)});
  }
  return frames;
}

}  // namespace sonarcal::testing
