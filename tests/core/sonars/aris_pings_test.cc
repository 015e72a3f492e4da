#include "core/sonars/aris_pings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <set>
#include <stdexcept>
#include <string>

#include "tests/support/recordings.h"

namespace sonarcal {
namespace {

using ::testing::ElementsAre;

std::vector<std::byte> BytesOf(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(stream)), {});
  std::vector<std::byte> bytes(text.size());
  std::ranges::transform(text, bytes.begin(), [](char c) { return static_cast<std::byte>(c); });
  return bytes;
}

TEST(ArisPings, EachModeHasItsPingsAndBeams) {
  constexpr int kPings[] = {0, 3, 0, 6, 0, 0, 4, 0, 0, 8, 0, 0, 0, 0};
  for (int mode = -1; mode <= 12; ++mode) {
    const int pings = mode < 0 ? 0 : kPings[mode];
    EXPECT_EQ(ArisPingsPerFrame(mode), pings) << mode;
    EXPECT_EQ(ArisPingOfBeam(mode).size(), 16U * pings) << mode;
  }
}

TEST(ArisPings, NeighbouringBeamsBelongToPingsInTurn) {
  const std::vector<int> of_48 = ArisPingOfBeam(1);
  EXPECT_THAT(std::vector<int>(of_48.begin(), of_48.begin() + 5), ElementsAre(0, 1, 2, 0, 1));
  const std::vector<int> of_128 = ArisPingOfBeam(9);
  EXPECT_EQ(of_128[7], 7);
  EXPECT_EQ(of_128[8], 0);
  EXPECT_EQ(of_128[127], 7);
}

// The first sample of ping 1 of mode 1, two samples per beam: its channels are beams 10, 2, 14, ... of 16,
// and its beams are 1, 4, 7, ... of 48.
TEST(ArisPings, ChannelsAreInTheOrderOfTheMultiplexer) {
  std::vector<std::byte> sent(2 * 48);
  sent[32] = std::byte{1};       // ping 1, sample 0, channel 0
  sent[32 + 5] = std::byte{2};   // channel 5
  sent[32 + 16] = std::byte{3};  // sample 1, channel 0
  const std::vector<std::byte> by_beam = ArisSamplesByBeam(sent, 1);
  EXPECT_EQ(by_beam[3 * 10 + 1], std::byte{1});
  EXPECT_EQ(by_beam[1], std::byte{2});
  EXPECT_EQ(by_beam[48 + 3 * 10 + 1], std::byte{3});
  EXPECT_EQ(std::ranges::count(by_beam, std::byte{0}), 93);
}

// With one sample per beam, each sample of the frame comes exactly once.
TEST(ArisPings, NoSampleIsLost) {
  for (const int mode : {1, 3, 6, 9}) {
    const int beams = kArisBeamsPerPing * ArisPingsPerFrame(mode);
    std::vector<std::byte> sent(beams);
    for (int i = 0; i < beams; ++i) sent[i] = static_cast<std::byte>(i);
    const std::vector<std::byte> by_beam = ArisSamplesByBeam(sent, mode);
    EXPECT_EQ(std::set<std::byte>(by_beam.begin(), by_beam.end()).size(), static_cast<std::size_t>(beams));
    const std::vector<int> ping_of_beam = ArisPingOfBeam(mode);
    for (int beam = 0; beam < beams; ++beam)
      EXPECT_EQ(std::to_integer<int>(by_beam[beam]) / kArisBeamsPerPing, ping_of_beam[beam]);
  }
}

TEST(ArisPings, SamplesThatCannotBeOrderedAreAMistake) {
  EXPECT_THROW(ArisSamplesByBeam(std::vector<std::byte>(48), 2), std::logic_error);
  EXPECT_THROW(ArisSamplesByBeam(std::vector<std::byte>(47), 1), std::logic_error);
}

// The manufacturer's own input and result. It has none with content for mode 6.
TEST(ArisPingsOfTheMaker, SamplesComeOutByteByByte) {
  struct Case {
    const char* name;
    int mode;
    std::size_t bytes;
  };
  for (const Case& one : {Case{"1_1200", 1, 512U * 48}, Case{"1_1800", 1, 544U * 48}, Case{"3", 3, 512U * 96},
                          Case{"9", 9, 512U * 128}}) {
    const std::string name = std::string("pingmode_") + one.name + ".dat";
    SONARCAL_NEEDS_RECORDING(input, "aris_sdk_frames/input_" + name);
    SONARCAL_NEEDS_RECORDING(expected, "aris_sdk_frames/expected_" + name);
    const std::vector<std::byte> sent = BytesOf(input);
    ASSERT_EQ(sent.size(), one.bytes);
    EXPECT_NE(sent, BytesOf(expected)) << name;
    EXPECT_EQ(ArisSamplesByBeam(sent, one.mode), BytesOf(expected)) << name;
  }
}

}  // namespace
}  // namespace sonarcal
