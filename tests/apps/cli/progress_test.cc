#include "apps/cli/progress.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>
#include <thread>
#include <vector>

namespace sonarcal::cli {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

class ProgressTest : public ::testing::Test {
 protected:
  ProgressSettings Settings(bool terminal) {
    return {&stream_, terminal, [this] { return now_s_; }};
  }

  std::ostringstream stream_;
  double now_s_ = 100.0;
};

TEST_F(ProgressTest, LessThanASecondShowsNothing) {
  {
    Progress progress("Working", 10, Settings(true));
    for (int i = 0; i < 10; ++i) {
      now_s_ += 0.09;
      progress.Advance();
    }
  }
  EXPECT_THAT(stream_.str(), IsEmpty());
}

TEST_F(ProgressTest, LinesAreRareAndStateTheRemainingTime) {
  Progress progress("Working", 100, Settings(false));
  for (int i = 0; i < 40; ++i) {
    now_s_ += 0.25;
    progress.Advance();
  }
  EXPECT_EQ(stream_.str(),
            "sonarcal: Working: 4 of 100, 24 s left\nsonarcal: Working: 24 of 100, 19 s left\n");
}

TEST_F(ProgressTest, ABarGoesWhenTheWorkIsDone) {
  {
    Progress progress("Working", 4, Settings(true));
    now_s_ += 2.0;
    progress.Update(2);
    EXPECT_THAT(stream_.str(), HasSubstr("[############............] 2 of 4, 2 s left"));
  }
  EXPECT_TRUE(stream_.str().ends_with("\r\x1b[K"));
}

TEST_F(ProgressTest, ARateIsOfTheStepsThatTookTime) {
  Progress progress("Working", 100, Settings(true), "frames");
  for (int i = 0; i < 40; ++i) progress.Skip();
  now_s_ += 4.0;
  progress.Update(50);
  EXPECT_THAT(stream_.str(), HasSubstr("50 of 100, 2.5 frames/s, 20 s left"));
}

TEST_F(ProgressTest, WithoutAnOutputNothingIsShown) {
  Progress progress("Working", 4, ProgressSettings{});
  progress.Advance();
}

TEST_F(ProgressTest, ManyThreadsMayAdvance) {
  Progress progress("Working", 4000, Settings(false));
  now_s_ += 2.0;
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([&] {
      for (int step = 0; step < 500; ++step) progress.Advance();
    });
  }
  for (std::thread& thread : threads) thread.join();
  now_s_ += 10.0;
  progress.Advance();
  EXPECT_THAT(stream_.str(), HasSubstr("2001 of 4000"));
}

TEST_F(ProgressTest, TheLogGetsLinesAndTheTimeAtTheEndAlsoIfNothingIsShown) {
  std::vector<std::string> log;
  std::vector<std::string> details;
  ProgressSettings settings = Settings(true);
  settings.stream = nullptr;
  settings.log = [&](const std::string& line) { log.push_back(line); };
  settings.detail = [&](const std::string& sentence) { details.push_back(sentence); };
  {
    Progress progress("Working", 100, settings, "frames");
    for (int i = 0; i < 40; ++i) {
      now_s_ += 0.25;
      progress.Advance();
    }
  }
  EXPECT_THAT(log, ::testing::ElementsAre("Working: 4 of 100, 4 frames/s, 24 s left",
                                          "Working: 24 of 100, 4 frames/s, 19 s left"));
  EXPECT_THAT(details, ::testing::ElementsAre("Working: 40 frames in 10.00 s"));
  EXPECT_THAT(stream_.str(), IsEmpty());
}

}  // namespace
}  // namespace sonarcal::cli
