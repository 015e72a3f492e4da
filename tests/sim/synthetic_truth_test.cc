// The acoustic model against recordings that somebody else's coherent simulation made, with all their
// parameters: the one check that shares no line with this project.
#include "tests/sim/synthetic_truth.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace sonarcal::sim {
namespace {

using namespace testing;  // NOLINT: the helpers of tests/sim

class SyntheticTank : public SyntheticTruth {
 protected:
  void SetUp() override {
    SONARCAL_NEEDS_RECORDING(folder, "synthetic_tank");
    Open(folder);
  }
};

// Beyond 2.7 m (bin 164) all of the floor that the truth's elevation pattern, two cosine-tapered apertures,
// shows is within 17 degrees of the axis, where a Gaussian of the same width follows it; nearer it is up to 1
// dB below the Gaussian. The two bins at the far end lack what lies beyond the window.
constexpr int kFirstBin = 164;
constexpr int kLastBin = 655;

// Speckle of the recording is correlated over 17 pixels (sum of its measured correlation over both axes), so
// 80'000 floor pixels are 5000 independent ones, standard error 1.4 %, 0.06 dB; of noise more.
TEST_F(SyntheticTank, LevelsAreThoseOfTheRecordedFrames) {
  MeanRatio floor;
  MeanRatio noise;
  std::vector<double> ratios;
  for (int index = 0; index < recording_->frame_count(); index += 2) {
    const Frame frame = recording_->ReadFrame(index);
    const EchoList echoes = simulator_->TraceEchoes(*frame.info.world_from_sonar);
    const Grid<float> all = Power(echoes, parameters_);
    const Grid<float> of_floor = Power(echoes, Alone("floor"));
    for (int bin = kFirstBin; bin < kLastBin; ++bin) {
      for (int beam = 0; beam < all.cols(); ++beam) {
        const double ratio = RecordedPower(frame.image.value(bin, beam)) / double{all(bin, beam)};
        const double others = double{all(bin, beam)} - double{of_floor(bin, beam)};
        if (others < 0.05 * of_floor(bin, beam)) floor.Add(ratio);
        if (all(bin, beam) < 1.02 * NoisePower()) noise.Add(ratio);
        ratios.push_back(ratio);
      }
    }
  }
  EXPECT_GT(floor.count, 60'000);
  EXPECT_GT(noise.count, 60'000);
  EXPECT_NEAR(floor.Db(), 0.0, 0.2);
  EXPECT_NEAR(noise.Db(), 0.0, 0.2);

  // Power over its expectation is exponential everywhere: floor, object, wall, shadow. The display hides what
  // lies below 82 dB, 6 % of noise at 94, hence from a tenth of the mean on.
  std::sort(ratios.begin(), ratios.end());
  double distance = 0.0;
  for (std::size_t i = 0; i < ratios.size(); ++i) {
    if (ratios[i] < 0.1) continue;
    const double share = (static_cast<double>(i) + 0.5) / static_cast<double>(ratios.size());
    distance = std::max(distance, std::abs(share - (1.0 - std::exp(-ratios[i]))));
  }
  RecordProperty("floor_db", std::to_string(floor.Db()));
  RecordProperty("noise_db", std::to_string(noise.Db()));
  RecordProperty("distance", std::to_string(distance));
  // Beyond 2.47 / sqrt(n) with a probability of 1e-5 (Kolmogorov).
  EXPECT_LT(distance, 2.47 / std::sqrt(static_cast<double>(ratios.size()) / 17.0));
}

}  // namespace
}  // namespace sonarcal::sim
