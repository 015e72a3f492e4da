#include "calib/models/down_weight.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "core/types/error.h"

namespace sonarcal::calib {
namespace {

constexpr int kBins = 60;
constexpr int kBeams = 50;

std::vector<RecordedPower> Speckled(const std::vector<double>& mean, unsigned seed) {
  std::mt19937 generator(seed);
  std::exponential_distribution<double> speckle(1.0);
  std::vector<RecordedPower> recorded;
  for (const double power : mean) recorded.push_back({.power = power * speckle(generator)});
  return recorded;
}

TEST(CellWeightsTest, SpeckleAboutTheMeanCountsInFull) {
  const std::vector<double> mean(kBins * kBeams, 3.0);
  const std::vector<float> weights = CellWeights(Speckled(mean, 1), mean, {}, kBins, kBeams, 1.0);
  const auto low = std::count_if(weights.begin(), weights.end(), [](float w) { return w < 1.0F; });
  EXPECT_LT(low, kBins * kBeams / 1000);
}

TEST(CellWeightsTest, ABrightObjectAndAShadowAreFound) {
  const std::vector<double> model(kBins * kBeams, 3.0);
  std::vector<double> truth = model;
  const auto within = [](int bin, int beam, int first_bin, int first_beam) {
    return bin >= first_bin && bin < first_bin + 10 && beam >= first_beam && beam < first_beam + 10;
  };
  for (int bin = 0; bin < kBins; ++bin) {
    for (int beam = 0; beam < kBeams; ++beam) {
      double& power = truth[static_cast<std::size_t>(bin) * kBeams + beam];
      if (within(bin, beam, 10, 10)) power *= 30.0;
      if (within(bin, beam, 35, 30)) power /= 30.0;
    }
  }
  const std::vector<float> weights = CellWeights(Speckled(truth, 2), model, {}, kBins, kBeams, 1.0);
  double bright = 0.0;
  double shadow = 0.0;
  double elsewhere = 0.0;
  int others = 0;
  for (int bin = 0; bin < kBins; ++bin) {
    for (int beam = 0; beam < kBeams; ++beam) {
      const double weight = weights[static_cast<std::size_t>(bin) * kBeams + beam];
      if (within(bin, beam, 10, 10)) {
        bright += weight / 100.0;
      } else if (within(bin, beam, 35, 30)) {
        shadow += weight / 100.0;
      } else if (!within(bin, beam, 9, 9) && !within(bin, beam, 11, 11) && !within(bin, beam, 9, 11) &&
                 !within(bin, beam, 11, 9)) {
        elsewhere += weight;
        ++others;
      }
    }
  }
  EXPECT_LT(bright, 0.6);
  EXPECT_LT(shadow, 0.6);
  EXPECT_GT(elsewhere / others, 0.99);
}

TEST(CellWeightsTest, GrainWidensTheWindowAndPixelsThatDoNotCountAreNotLookedAt) {
  const std::vector<double> mean(kBins * kBeams, 1.0);
  std::vector<RecordedPower> recorded(mean.size(), RecordedPower{.power = 1.0});
  std::vector<std::uint8_t> use(mean.size(), 1);
  const std::size_t middle = 30 * kBeams + 25;
  recorded[middle].power = 1e6;
  use[middle] = 0;
  EXPECT_THAT(CellWeights(recorded, mean, use, kBins, kBeams, 1.0), ::testing::Each(1.0F));
  use[middle] = 1;
  EXPECT_LT(CellWeights(recorded, mean, use, kBins, kBeams, 1.0)[middle], 1.0F);
  EXPECT_THAT([&] { CellWeights(recorded, mean, use, kBins, kBeams, 1.0, {.cell_bins = 0.5}); },
              ::testing::ThrowsMessage<DataError>(::testing::HasSubstr("cell_bins 0.5")));
}

}  // namespace
}  // namespace sonarcal::calib
