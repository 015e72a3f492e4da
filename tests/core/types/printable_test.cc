#include "core/types/printable.h"

#include <gtest/gtest.h>

#include <string>

namespace sonarcal {
namespace {

TEST(PrintableTest, CharactersOfEachLengthAreKept) {
  for (const std::string text :
       {"plain", "\u00A0\u00E9", "\u0800\uD7FF\uE000\uFFFD", "\U00010000\U0001F30A\U0010FFFF"}) {
    EXPECT_EQ(Printable(text), text);
  }
}

TEST(PrintableTest, ControlCharactersAreReplaced) {
  EXPECT_EQ(Printable("a\x1b[2J\n\x7f"), "a?[2J??");
  EXPECT_EQ(Printable("\xC2\x9B\x32J"), "?2J") << "control sequence introducer of C1";
}

TEST(PrintableTest, LongTextIsCutBetweenCharacters) {
  EXPECT_EQ(Printable("ab\u00E9", 4), "ab\u00E9");
  EXPECT_EQ(Printable("ab\u00E9", 3), "ab...");
}

// The first and the last bytes of each form that The Unicode Standard, table 3-7, excludes.
TEST(PrintableTest, BytesThatAreNotUtf8AreReplacedOneByOne) {
  for (const std::string text :
       {"\x80\xBF", "\xC0\x9B", "\xC1\xBF", "\xF5\x80\x80\x80", "\xFF",  // lead bytes
        "\xC3", "\xE2\x82", "\xF0\x9F\x8C",                              // cut short
        "\xE0\x80\x80", "\xE0\x82\x9B", "\xE0\x9F\xBF",                  // in too many
        "\xF0\x80\x82\x9B", "\xF0\x8F\xBF\xBF",                          // bytes
        "\xED\xA0\x80", "\xED\xBF\xBF",                                  // surrogates
        "\xF4\x90\x80\x80", "\xF4\xBF\xBF\xBF"}) {                       // too high
    EXPECT_EQ(Printable(text), std::string(text.size(), '?')) << ::testing::PrintToString(text);
    EXPECT_EQ(Printable("a" + text + "b"), "a" + std::string(text.size(), '?') + "b");
  }
}

}  // namespace
}  // namespace sonarcal
