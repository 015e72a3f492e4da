#include "metrics/json/comparison_part.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "data_io/files/hash.h"
#include "metrics/aggregate.h"
#include "tests/metrics/metrics_testing.h"

namespace sonarcal::metrics {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::SpeckledBlock;
using ::testing::StartsWith;

// A part of the frames `first` to before `end`, with residuals and a table of classes.
ComparisonPart PartOf(int first, int end) {
  ComparisonPart part{.compared = "tank, options", .simulated = "out"};
  part.residuals_by_scene.push_back({.by = "material", .unit = "", .classes = {}});
  part.residuals_by_scene[0].classes.push_back({.name = "sand, wet", .from = std::nullopt});
  part.residuals_by_scene[0].classes.push_back({.name = "steel", .from = 0.5, .to = 1.5});
  CompareOptions options;
  options.sweep.steps = 3;
  options.keep_masks = true;
  FrameComparer comparer(options);
  for (int i = first; i < end; ++i) {
    PolarImage real = SpeckledBlock(2 * i + 1), simulated = SpeckledBlock(2 * i + 2);
    real.scale.db_span = simulated.scale.db_span = 80.0;
    FrameMetrics frame = comparer.Compare(real, simulated);
    frame.index = i;
    frame.name = fmt::format("frame {}", i);
    if (i % 2 == 0) frame.time_s = 0.5 * i;
    frame.notes = {"a note", ""};
    const FrameMasks& masks = frame.masks.value();
    part.residuals.Add(real, simulated, masks.polar_real, masks.polar_simulated);
    ResidualCollector::AddTo(
        part.residuals_by_scene[0], [](int bin, int) { return bin < 60 ? 0 : 1; }, real, simulated,
        masks.polar_real, masks.polar_simulated);
    part.Add(frame);
  }
  part.notes = {fmt::format("note of {}", first), "note of all"};
  return part;
}

std::string MessageOf(const std::string& bytes) {
  try {
    ParseComparisonPart(bytes, "part.bin");
  } catch (const DataError& error) {
    return error.what();
  }
  return "no error";
}

TEST(ComparisonPartTest, AFileHoldsWhatWasMeasured) {
  const ComparisonPart part = PartOf(0, 3);
  EXPECT_FALSE(part.frames[0].levels);
  EXPECT_FALSE(part.frames[0].masks);
  const std::string bytes = ComparisonPartBytes(part);
  const ComparisonPart read = ParseComparisonPart(bytes, "part.bin");
  EXPECT_EQ(ComparisonPartBytes(read), bytes);
  EXPECT_EQ(read.compared, "tank, options");
  EXPECT_EQ(read.simulated, "out");
  ASSERT_EQ(read.frames.size(), 3U);
  EXPECT_EQ(read.frames[2].index, 2);
  EXPECT_EQ(read.frames[2].name, "frame 2");
  EXPECT_EQ(read.frames[2].time_s, 1.0);
  EXPECT_FALSE(read.frames[1].time_s);
  EXPECT_EQ(read.frames[1].polar.occupancy, part.frames[1].polar.occupancy);
  EXPECT_EQ(read.frames[1].fan.ssim.whole.sum, part.frames[1].fan.ssim.whole.sum);
  EXPECT_EQ(read.frames[1].threshold_real, part.frames[1].threshold_real);
  EXPECT_EQ(read.frames[1].sweep, part.frames[1].sweep);
  EXPECT_THAT(read.frames[1].notes, ElementsAre("a note", ""));
  EXPECT_EQ(read.levels.fan.span_db, 80.0);
  EXPECT_EQ(read.levels.polar.Over(LevelDomain::kUnion).real,
            part.levels.polar.Over(LevelDomain::kUnion).real);
  EXPECT_EQ(read.residuals.frames(), 3);
  EXPECT_EQ(read.residuals.axes().range_max_m, 3.0);
  EXPECT_EQ(ResidualsCsv({read.residuals.ByRange(), read.residuals.ByBeam(), read.residuals_by_scene[0]}),
            ResidualsCsv({part.residuals.ByRange(), part.residuals.ByBeam(), part.residuals_by_scene[0]}));
  EXPECT_EQ(read.residuals.map().cells.rows(), part.residuals.map().cells.rows());
  EXPECT_EQ(read.residuals.map().bins, 2);
  EXPECT_EQ(read.residuals.map().cells(10, 20).whole.product,
            part.residuals.map().cells(10, 20).whole.product);
  EXPECT_THAT(read.notes, ElementsAre("note of 0", "note of all"));
}

TEST(ComparisonPartTest, APartWithoutFramesIsAPart) {
  const std::string bytes = ComparisonPartBytes(ComparisonPart{.compared = "a", .simulated = "b"});
  EXPECT_EQ(ComparisonPartBytes(ParseComparisonPart(bytes, "part.bin")), bytes);
}

// Any byte changed, and any length.
TEST(ComparisonPartTest, ADamagedFileIsRefused) {
  const std::string bytes = ComparisonPartBytes(PartOf(0, 1));
  const std::size_t step = bytes.size() / 97;
  for (std::size_t i = 0; i < bytes.size(); i += i < 200 ? 1 : step) {
    std::string damaged = bytes;
    damaged[i] = static_cast<char>(damaged[i] + 1);
    EXPECT_THAT(MessageOf(damaged), StartsWith("part.bin: is ")) << i;
    EXPECT_THAT(MessageOf(bytes.substr(0, i)), StartsWith("part.bin: is ")) << i;
  }
  EXPECT_THAT(MessageOf(bytes + "x"), HasSubstr("is damaged"));
  EXPECT_EQ(MessageOf("sonarcal-comparison-part/1 1 2 3\n"),
            fmt::format("part.bin: is no part of a comparison by this version of the program, expected '{}'",
                        bytes.substr(0, bytes.find('\n'))));
}

// A file whose hash is right, but whose counts say more than it holds: no list takes memory for them.
TEST(ComparisonPartTest, CountsBeyondTheEndAreRefused) {
  const std::string bytes = ComparisonPartBytes(PartOf(0, 1));
  const std::size_t head = bytes.find('\n') + 1;
  const auto with_hash = [&](const std::string& body) {
    return bytes.substr(0, head) + data_io::Sha256(body) + body;
  };
  const std::string body = bytes.substr(head + 64);
  EXPECT_EQ(with_hash(body), bytes);
  for (std::size_t size = 0; size < body.size(); size += size < 100 ? 1 : body.size() / 97) {
    EXPECT_THAT(MessageOf(with_hash(body.substr(0, size))), HasSubstr("ends in the middle")) << size;
  }
  EXPECT_THAT(MessageOf(with_hash(body + "x")), HasSubstr("has 1 bytes after its end"));
  std::string huge = body;
  huge[7] = '\x7f';  // in the count of the first text
  EXPECT_THAT(MessageOf(with_hash(huge)), HasSubstr("ends in the middle"));
}

// Parts in any order give what one program measures.
TEST(ComparisonPartTest, MergedPartsAreTheWhole) {
  const ComparisonPart whole = PartOf(0, 4);
  std::vector<ComparisonPart> parts;
  parts.push_back(PartOf(2, 4));
  parts.push_back(PartOf(0, 2));
  parts.push_back(ComparisonPart{.compared = "no frames: not looked at", .simulated = ""});
  const ComparisonPart merged = MergedParts(parts);
  EXPECT_EQ(merged.compared, whole.compared);
  EXPECT_EQ(merged.simulated, "out");
  ASSERT_EQ(merged.frames.size(), 4U);
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(merged.frames[i].index, i);
    EXPECT_EQ(merged.frames[i].polar.occupancy, whole.frames[i].polar.occupancy);
  }
  EXPECT_EQ(merged.levels.polar.Over(LevelDomain::kWhole).real,
            whole.levels.polar.Over(LevelDomain::kWhole).real);
  EXPECT_EQ(merged.residuals.frames(), 4);
  const ResidualSums& steel = merged.residuals_by_scene[0].classes[1].sums;
  EXPECT_EQ(steel.whole.pixels, 4 * 60 * 40);
  EXPECT_EQ(steel.whole.pixels, whole.residuals_by_scene[0].classes[1].sums.whole.pixels);
  EXPECT_NEAR(*steel.whole.bias(), *whole.residuals_by_scene[0].classes[1].sums.whole.bias(), 1e-15);
  EXPECT_THAT(merged.notes, ElementsAre("note of 0", "note of 2", "note of all"));
  EXPECT_EQ(AggregateFrames(merged.frames, merged.levels).micro.polar.At("iou").value,
            AggregateFrames(whole.frames, whole.levels).micro.polar.At("iou").value);
}

TEST(ComparisonPartTest, PartsThatDoNotBelongTogetherAreRefused) {
  const auto message = [](std::vector<ComparisonPart> parts) {
    try {
      MergedParts(std::move(parts));
    } catch (const DataError& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  const ComparisonPart first = PartOf(0, 2), second = PartOf(1, 2);
  EXPECT_EQ(message({first, second}), "frame 1 is in two parts, expected one");
  EXPECT_EQ(message({}), "no part of a comparison has a frame, expected at least one");
  ComparisonPart other = PartOf(2, 3);
  other.compared = "harbour";
  EXPECT_EQ(message({first, other}),
            "parts of different comparisons: tank, options and harbour, expected the same options");
  other = PartOf(2, 3);
  other.residuals_by_scene[0].classes.pop_back();
  EXPECT_EQ(message({first, other}), "parts have 1 and 2 classes of residuals, expected as many");
}

}  // namespace
}  // namespace sonarcal::metrics
