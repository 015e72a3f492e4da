// Streaks made by a second model: the elements of a receiver array, or the channels of a lens, each with a
// limit, from which the image is formed afterwards.
#include "core/imaging/saturation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <random>
#include <vector>

namespace sonarcal {
namespace {

constexpr int kBins = 300;
constexpr int kBeams = 64;
constexpr double kFullScale = 255.0;

PolarImage ImageOf(const Grid<double>& power, double db_min, double db_max) {
  PolarImage image{
      {},
      {.quantity = Quantity::kGrey, .full_scale = kFullScale, .db_min = {}, .db_max = {}, .db_span = {}},
      {}};
  image.value = Grid<float>(power.rows(), power.cols());
  for (std::size_t i = 0; i < power.size(); ++i) {
    const double level = (10.0 * std::log10(power.values()[i]) - db_min) / (db_max - db_min);
    image.value.values()[i] = static_cast<float>(std::round(kFullScale * std::clamp(level, 0.0, 1.0)));
  }
  return image;
}

// Independent exponential power with the means of `mean`.
Grid<double> Speckle(const Grid<double>& mean, int seed) {
  std::mt19937_64 random(seed);
  std::exponential_distribution<double> one;
  Grid<double> power(mean.rows(), mean.cols());
  for (std::size_t i = 0; i < power.size(); ++i) power.values()[i] = mean.values()[i] * one(random);
  return power;
}

struct Echo {
  int bin = 0;
  int bins = 0;
  double sine = 0.0;  // of the azimuth
  double amplitude = 0.0;
};

// Image of an array of half a wavelength spacing with Hann weights. Each element clips both quadratures at
// `limit`. Specular echoes, reverberation of amplitude 1 from all directions, receiver noise of 0.03.
PolarImage ArrayImage(const std::vector<Echo>& echoes, double limit, int seed) {
  constexpr int kElements = 48;
  constexpr int kDirections = 128;
  constexpr double kReach = 0.42;  // sine of the outermost direction
  using Complex = std::complex<double>;
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal(0.0, std::numbers::sqrt2 / 2.0);
  std::uniform_real_distribution<double> uniform;
  const auto phase = [](int element, double sine) {
    return std::polar(1.0, std::numbers::pi * (element - 0.5 * (kElements - 1)) * sine);
  };
  const auto sine_of = [](int i, int count) { return kReach * (2.0 * (i + 0.5) / count - 1.0); };
  Grid<double> power(kBins, kBeams);
  for (int bin = 0; bin < kBins; ++bin) {
    std::vector<Complex> element(kElements);
    const auto add = [&](double sine, const Complex& wave) {
      for (int n = 0; n < kElements; ++n) element[n] += wave * phase(n, sine);
    };
    for (int i = 0; i < kDirections; ++i)
      add(sine_of(i, kDirections), Complex(normal(random), normal(random)) / std::sqrt(kDirections));
    for (const Echo& echo : echoes) {
      if (bin >= echo.bin && bin < echo.bin + echo.bins)
        add(echo.sine, std::polar(echo.amplitude, 2.0 * std::numbers::pi * uniform(random)));
    }
    for (Complex& value : element) {
      value += 0.03 * Complex(normal(random), normal(random));
      value = {std::clamp(value.real(), -limit, limit), std::clamp(value.imag(), -limit, limit)};
    }
    for (int beam = 0; beam < kBeams; ++beam) {
      Complex sum = 0.0;
      double weights = 0.0;
      for (int n = 0; n < kElements; ++n) {
        const double weight = std::pow(std::sin(std::numbers::pi * (n + 1.0) / (kElements + 1.0)), 2);
        sum += weight * element[n] * std::conj(phase(n, sine_of(beam, kBeams)));
        weights += weight;
      }
      power(bin, beam) = std::norm(sum / weights);
    }
  }
  return ImageOf(power, -45.0, 45.0);
}

constexpr double kNoLimit = 1e9;

// Their side lobes are below the reverberation.
TEST(AzimuthStreaksTest, TwoStrongEchoesOfAnArrayThatDoesNotClipHaveNone) {
  for (int seed = 0; seed < 5; ++seed) {
    const PolarImage image = ArrayImage({{150, 4, 0.1, 30.0}, {150, 4, -0.23, 25.0}}, kNoLimit, seed);
    EXPECT_TRUE(FindAzimuthStreaks(image).empty()) << seed;
  }
}

TEST(AzimuthStreaksTest, TwoStrongEchoesOfAClippingArrayBrightenAllBeams) {
  const std::vector<Echo> echoes = {{150, 4, 0.1, 300.0}, {150, 4, -0.23, 250.0}};
  for (int seed = 0; seed < 5; ++seed) {
    const auto streaks = FindAzimuthStreaks(ArrayImage(echoes, 30.0, seed));
    ASSERT_EQ(streaks.size(), 1U) << seed;
    EXPECT_TRUE(streaks[0].bright);
    EXPECT_LE(streaks[0].first_bin, 151);
    EXPECT_GE(streaks[0].end_bin, 153);
    EXPECT_GE(streaks[0].first_bin, 148);
    EXPECT_LE(streaks[0].end_bin, 156);
  }
}

TEST(AzimuthStreaksTest, CrosstalkBetweenChannelsIsFoundWhereItIs) {
  Grid<double> mean(kBins, kBeams, 1.0);
  for (int bin = 200; bin < 204; ++bin) {
    for (int beam = 0; beam < kBeams; ++beam) mean(bin, beam) = beam / 4 == 5 ? 1e6 : 100.0;
  }
  for (int seed = 0; seed < 20; ++seed) {
    const auto streaks = FindAzimuthStreaks(ImageOf(Speckle(mean, seed), -20.0, 60.0));
    ASSERT_EQ(streaks.size(), 1U) << seed;
    EXPECT_EQ(streaks[0], (AzimuthStreak{200, 204, true})) << seed;
  }
}

TEST(AzimuthStreaksTest, BrightObjectsDoNotHideAStreak) {
  Grid<double> mean(kBins, kBeams, 1.0);
  for (int bin = 120; bin < 280; ++bin) {
    for (int beam = 16; beam < 30; ++beam) mean(bin, beam) = 1e4;
  }
  for (int bin = 200; bin < 203; ++bin) {
    for (int beam = 0; beam < kBeams; ++beam) mean(bin, beam) += beam / 4 == 12 ? 1e6 : 1e3;
  }
  for (int seed = 0; seed < 20; ++seed) {
    const auto streaks = FindAzimuthStreaks(ImageOf(Speckle(mean, seed), -20.0, 60.0));
    ASSERT_EQ(streaks.size(), 1U) << seed;
    EXPECT_EQ(streaks[0], (AzimuthStreak{200, 203, true})) << seed;
  }
}

TEST(AzimuthStreaksTest, BeamsThatLoseTheirEchoesAreADarkStreak) {
  Grid<double> mean(kBins, kBeams, 100.0);
  for (int bin = 100; bin < 104; ++bin) {
    for (int beam = 0; beam < kBeams; ++beam) mean(bin, beam) = beam / 8 == 3 ? 1e6 : 0.3;
  }
  for (int seed = 0; seed < 20; ++seed) {
    const auto streaks = FindAzimuthStreaks(ImageOf(Speckle(mean, seed), -20.0, 60.0));
    ASSERT_EQ(streaks.size(), 1U) << seed;
    EXPECT_EQ(streaks[0], (AzimuthStreak{100, 104, false})) << seed;
  }
}

TEST(AzimuthStreaksTest, WaterFloorWallAndTargetHaveNone) {
  Grid<double> mean(kBins, kBeams, 1.0);
  for (int bin = 0; bin < kBins; ++bin) {
    for (int beam = 0; beam < kBeams; ++beam) {
      const double azimuth_rad = 0.5 * (2.0 * beam / (kBeams - 1) - 1.0);
      if (bin >= 80) mean(bin, beam) = 300.0 * std::pow(80.0 / bin, 3);  // floor from its edge on
      if (std::abs(bin * std::cos(azimuth_rad) - 220.0) < 2.0) mean(bin, beam) = 1e4;
      if (bin >= 150 && bin < 153 && beam < kBeams / 2) mean(bin, beam) = 1e4;
      if (bin >= 153 && bin < 200 && beam < kBeams / 2) mean(bin, beam) = 1.0;  // its shadow
    }
  }
  for (int seed = 0; seed < 50; ++seed) {
    EXPECT_TRUE(
        FindAzimuthStreaks(ImageOf(Speckle(Grid<double>(kBins, kBeams, 1.0), seed), -20.0, 20.0)).empty())
        << seed;
    EXPECT_TRUE(FindAzimuthStreaks(ImageOf(Speckle(mean, seed), -20.0, 60.0)).empty()) << seed;
  }
}

// A wall straight ahead, seen by a narrow fan: 3 m away, bins of 18 mm, 29 degrees.
TEST(AzimuthStreaksTest, AnArcOfFewBinsIsNone) {
  Grid<double> mean(512, 96, 1.0);
  for (int beam = 0; beam < 96; ++beam) {
    const double azimuth_rad = 0.25 * (2.0 * beam / 95.0 - 1.0);
    const int bin = static_cast<int>(170.0 / std::cos(azimuth_rad));
    mean(bin, beam) = mean(bin + 1, beam) = 1e4;
  }
  for (int seed = 0; seed < 50; ++seed)
    EXPECT_TRUE(FindAzimuthStreaks(ImageOf(Speckle(mean, seed), -20.0, 60.0)).empty()) << seed;
}

TEST(AzimuthStreaksTest, PixelsThatAreNotValidDoNotCount) {
  Grid<double> mean(kBins, kBeams, 1.0);
  for (int beam = 0; beam < kBeams; ++beam) mean(120, beam) = mean(121, beam) = 1e4;
  const PolarImage image = ImageOf(Speckle(mean, 1), -20.0, 60.0);
  EXPECT_EQ(FindAzimuthStreaks(image).size(), 1U);
  Mask valid(kBins, kBeams, 1);
  for (int beam = 0; beam < kBeams; ++beam) valid(120, beam) = valid(121, beam) = 0;
  EXPECT_TRUE(FindAzimuthStreaks(image, &valid).empty());
}

TEST(AzimuthStreaksTest, FewBeamsOrBinsHaveNone) {
  for (const auto& [bins, beams] :
       {std::pair(1, 1), std::pair(500, 1), std::pair(500, 15), std::pair(17, 64)}) {
    Grid<double> mean(bins, beams, 1.0);
    for (int beam = 0; beam < beams; ++beam) mean(bins / 2, beam) = 1e4;
    EXPECT_TRUE(FindAzimuthStreaks(ImageOf(Speckle(mean, 1), -20.0, 60.0)).empty()) << bins << " x " << beams;
  }
}

TEST(SaturationLevelTest, ValuesThatPileUpBelowFullScaleAreFound) {
  const Grid<double> mean(kBins, kBeams, 1.0);
  PolarImage image = ImageOf(Speckle(mean, 3), -30.0, 20.0);
  EXPECT_FALSE(FindSaturationLevel(image));
  EXPECT_EQ(TopLevel(image), kFullScale);
  for (float& value : image.value.values()) value = std::min(value, 170.0F);  // 3.3 dB above the mean
  ASSERT_TRUE(FindSaturationLevel(image));
  EXPECT_EQ(*FindSaturationLevel(image), 170.0);
  EXPECT_EQ(TopLevel(image), 170.0);
}

TEST(SaturationLevelTest, FullScaleAndImagesOfFewLevelsHaveNone) {
  const Grid<double> mean(kBins, kBeams, 1.0);
  const PolarImage clipped = ImageOf(Speckle(mean, 3), -30.0, 0.0);
  EXPECT_EQ(*std::ranges::max_element(clipped.value.values()), 255.0F);
  EXPECT_FALSE(FindSaturationLevel(clipped));
  EXPECT_FALSE(FindSaturationLevel(ImageOf(mean, -30.0, 20.0)));  // one level
  int found = 0;
  for (int seed = 0; seed < 200; ++seed)
    found += FindSaturationLevel(ImageOf(Speckle(mean, seed), -30.0, 20.0)).has_value();
  EXPECT_EQ(found, 0);
}

}  // namespace
}  // namespace sonarcal
