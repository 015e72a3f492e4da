// The paper's model in blocks of pixels against its own pixels, on SYNTHETIC frames.
#include "calib/paper/coarse_paper.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/paper/paper_values.h"
#include "tests/calib/small_tank.h"

namespace sonarcal::calib {
namespace {

using testing::MakeFitFrames;
using testing::SmallSonar;
using testing::SmallTank;
using testing::SmallTankOptions;

// Without clipping, and with errors that reach over several pixels, a block's value is the mean of its
// pixels.
TEST(CoarsePaper, ABlocksValueIsTheMeanOfItsPixels) {
  const std::vector<std::string> materials = {"floor", "box"};
  ParameterSet parameters = sim::PaperValues(SmallSonar(), materials);
  parameters.display.db_max = parameters.display.db_min + 60.0;
  const sim::Simulator simulator(SmallTank(), SmallSonar(), SmallTankOptions());
  const std::vector<FitFrame> frames = MakeFitFrames(simulator, [&](const sim::EchoList& echoes, int frame) {
    return simulator.RenderEchoes(echoes, parameters, frame);
  });
  const sim::ImageGeometry geometry{simulator.sonar(), simulator.absorption_db_per_m()};
  const PaperFrameModel model(frames, geometry, materials, parameters);
  const auto blocks = model.InBlocks();
  ASSERT_NE(blocks, nullptr);
  const int bins = model.range_bins() / blocks->range_bins();
  const int beams = model.beams() / blocks->beams();
  ASSERT_GT(bins * beams, 1);

  PixelTerms fine;
  PixelTerms coarse;
  const ParameterValues values = model.Values(parameters);
  ASSERT_TRUE(model.Evaluate(0, values, {}, FrameModel::Terms::kResiduals, fine));
  ASSERT_TRUE(blocks->Evaluate(0, values, {}, FrameModel::Terms::kResiduals, coarse));
  double squares = 0.0;
  double difference = 0.0;
  for (int row = 0; row < blocks->range_bins(); ++row) {
    for (int col = 0; col < blocks->beams(); ++col) {
      double mean = 0.0;
      double measured = 0.0;
      for (int bin = 0; bin < bins; ++bin) {
        for (int beam = 0; beam < beams; ++beam) {
          const auto pixel = static_cast<std::size_t>(row * bins + bin) * model.beams() + col * beams + beam;
          mean += (fine.residual[pixel] + frames[0].measured[pixel]) / (bins * beams);
          measured += frames[0].measured[pixel] / (bins * beams);
        }
      }
      const double block = coarse.residual[static_cast<std::size_t>(row) * blocks->beams() + col] + measured;
      squares += mean * mean;
      difference += (block - mean) * (block - mean);
    }
  }
  ASSERT_GT(squares, 0.0);
  EXPECT_LT(std::sqrt(difference / squares), 0.1);
}

}  // namespace
}  // namespace sonarcal::calib
