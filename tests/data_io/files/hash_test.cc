#include "data_io/files/hash.h"

#include <gtest/gtest.h>

#include "core/types/error.h"
#include "tests/support/temp_dir.h"

namespace sonarcal::data_io {
namespace {

// NIST FIPS 180-4 examples.
TEST(HashTest, Sha256EqualsTheExamplesOfTheStandard) {
  EXPECT_EQ(Sha256(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(Sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST(HashTest, AFileHashesLikeItsBytes) {
  const testing::TempDir dir;
  const std::string bytes(200'000, 'x');  // longer than a piece
  testing::WriteFile(dir / "a", bytes);
  EXPECT_EQ(Sha256OfFile(dir / "a"), Sha256(bytes));
}

TEST(HashTest, AbsentFilesAndFoldersAreRefused) {
  const testing::TempDir dir;
  EXPECT_THROW(Sha256OfFile(dir / "absent"), DataError);
  EXPECT_THROW(Sha256OfFile(dir.path()), DataError);
}

}  // namespace
}  // namespace sonarcal::data_io
