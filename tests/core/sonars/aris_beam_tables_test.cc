#include "core/sonars/aris_beam_tables.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <string>

#include "core/types/units.h"
#include "tests/support/recordings.h"

namespace sonarcal {
namespace {

struct TableCase {
  ArisSystem system;
  int beam_count;
  ArisLens lens;
  const char* file;
};

constexpr TableCase kTables[] = {
    {ArisSystem::kAris1200, 48, ArisLens::kStandard, "beam_table_ARIS1800_1200_48.csv"},
    {ArisSystem::kAris1800, 48, ArisLens::kStandard, "beam_table_ARIS1800_1200_48.csv"},
    {ArisSystem::kAris1800, 96, ArisLens::kStandard, "beam_table_ARIS1800_96.csv"},
    {ArisSystem::kAris3000, 64, ArisLens::kStandard, "beam_table_ARIS3000_64.csv"},
    {ArisSystem::kAris3000, 128, ArisLens::kStandard, "beam_table_ARIS3000_128.csv"},
    {ArisSystem::kAris1200, 48, ArisLens::kTelephoto, "beam_table_ARIS_Telephoto_48.csv"},
    {ArisSystem::kAris1800, 48, ArisLens::kTelephoto, "beam_table_ARIS_Telephoto_48.csv"},
    {ArisSystem::kAris1800, 96, ArisLens::kTelephoto, "beam_table_ARIS_Telephoto_96.csv"},
};

TEST(ArisBeamTables, HaveOneCentreABeamInIncreasingOrder) {
  for (const TableCase& table : kTables) {
    const auto centres = ArisBeamCentresDeg(table.system, table.beam_count, table.lens);
    ASSERT_EQ(centres.size(), static_cast<std::size_t>(table.beam_count)) << table.file;
    for (std::size_t i = 1; i < centres.size(); ++i) EXPECT_GT(centres[i], centres[i - 1]) << table.file;
  }
}

TEST(ArisBeamTables, AreThoseOfTheMaker) {
  SONARCAL_NEEDS_RECORDING(folder, "aris1200_telephoto");
  for (const TableCase& table : kTables) {
    std::ifstream csv(folder / table.file);
    std::string line;
    std::getline(csv, line);
    ASSERT_EQ(line, "beam,center_deg,left_deg,right_deg");
    for (const double centre : ArisBeamCentresDeg(table.system, table.beam_count, table.lens)) {
      ASSERT_TRUE(std::getline(csv, line)) << table.file;
      EXPECT_EQ(centre, std::strtod(line.c_str() + line.find(',') + 1, nullptr)) << table.file << line;
    }
    EXPECT_FALSE(std::getline(csv, line)) << table.file << " has more beams";
  }
}

TEST(ArisBeamTables, AreEmptyWhereTheMakerHasNone) {
  EXPECT_TRUE(ArisBeamCentresDeg(ArisSystem::kAris1200, 96, ArisLens::kStandard).empty());
  EXPECT_TRUE(ArisBeamCentresDeg(ArisSystem::kAris3000, 48, ArisLens::kStandard).empty());
  EXPECT_TRUE(ArisBeamCentresDeg(ArisSystem::kAris3000, 128, ArisLens::kTelephoto).empty());
  EXPECT_TRUE(ArisBeamCentresDeg(ArisSystem::kAris1800, 0, ArisLens::kStandard).empty());
}

TEST(ArisAzimuths, ArisCountsFromTheRightSoTheLastBeamIsTheLeftmostColumn) {
  const double centres_deg[] = {-15.0, -1.0, 16.0};
  const std::vector<double> azimuth_rad = ArisAzimuthsRad(centres_deg);
  ASSERT_EQ(azimuth_rad.size(), 3u);
  EXPECT_DOUBLE_EQ(azimuth_rad[0], RadFromDeg(-16.0));
  EXPECT_DOUBLE_EQ(azimuth_rad[1], RadFromDeg(1.0));
  EXPECT_DOUBLE_EQ(azimuth_rad[2], RadFromDeg(15.0));
}

}  // namespace
}  // namespace sonarcal
