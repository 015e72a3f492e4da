// The page of `sonarcal view` in headless Chromium, clicked through.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/apps/tiny_world.h"

namespace sonarcal::view {
namespace {

using testing::Quoted;

constexpr int kNotHere = 77;

TEST(ViewInBrowser, MovedControlsChangeTheImagesInTheBrowser) {
  const testing::TinyWorld world;
  const auto made =
      testing::RunSonarcal(world.SimulateArguments() + " --noise --out " + Quoted(world / "real") + " -q");
  ASSERT_EQ(made.status, 0) << made.err;
  const char* screenshots = std::getenv("SONARCAL_SCREENSHOTS");  // a folder, for who wants to look
  const std::string command =
      fmt::format("{} {} {} {} {} >{}", SONARCAL_PYTHON, Quoted(SONARCAL_VIEW_SCRIPT),
                  Quoted(SONARCAL_BINARY), Quoted((world / "scene.gltf").parent_path()),
                  screenshots != nullptr ? Quoted(screenshots) : "", Quoted(world / "faults"));
  const int status = WEXITSTATUS(std::system(command.c_str()));
  const std::string said = testing::ReadFile(world / "faults");
  if (status == kNotHere) GTEST_SKIP() << said;
  EXPECT_EQ(status, 0) << said;
  std::printf("%s", said.c_str());
}

}  // namespace
}  // namespace sonarcal::view
