// The tiny world on view, and what its page is answered.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "apps/commands/view_command.h"
#include "apps/view/view_api.h"
#include "data_io/open_recording.h"
#include "data_io/parameters/parameters_io.h"
#include "tests/apps/tiny_world.h"

namespace sonarcal::testing {

struct Framed {
  nlohmann::json json;
  std::string data;
};

inline Framed ReadFramed(const view::ViewAnswer& answer) {
  EXPECT_EQ(answer.status, 200) << answer.body;
  std::uint32_t length = 0;
  std::memcpy(&length, answer.body.data(), 4);
  return {nlohmann::json::parse(answer.body.substr(4, length)), answer.body.substr(4 + length)};
}

// Grey values as a recording's frame has them.
inline std::vector<float> GreyOf(const Framed& framed) {
  const int bytes = framed.json["bytes"];
  std::vector<float> values;
  for (std::size_t i = 0; i < framed.data.size(); i += bytes) {
    const auto at = [&](std::size_t k) { return static_cast<unsigned char>(framed.data[k]); };
    values.push_back(static_cast<float>(bytes == 2 ? at(i) + 256 * at(i + 1) : at(i)));
  }
  return values;
}

inline std::vector<float> FrameOf(const std::filesystem::path& recording, int frame) {
  const PolarImage image = data_io::OpenRecording(recording)->ReadFrame(frame).image;
  return {image.value.values().begin(), image.value.values().end()};
}

// The tiny world on view, beside a noisy recording of it.
class ViewApiTest : public ::testing::Test {
 protected:
  commands::ViewOptions Options() const {
    commands::ViewOptions options;
    options.common = {.json = false, .quiet = true};
    options.scene = world_.scene();
    options.params = world_.params();
    options.real = world_ / "real";
    options.out = world_ / "kept";
    options.rays.sampling = sim::Sampling::kBeams;
    options.rays.rays = RayGridSize{96, 200};
    return options;
  }

  void SetUp() override {
    world_.WriteSimulated("real", true);
    session_ = std::make_unique<view::ViewSession>(commands::SetUpView(Options()));
    api_ = std::make_unique<view::ViewApi>(*session_, Options().out);
  }

  static nlohmann::json State() {
    return {{"parameters", nlohmann::json::parse(data_io::ParametersJson(TinyParameters()).dump())}};
  }

  view::ViewAnswer Post(const std::string& path, const nlohmann::json& body) {
    return api_->Answer("POST", path, body.dump());
  }

  // What the files that the page writes make `simulate` render.
  std::vector<float> Simulated(const nlohmann::json& state, int frame) {
    const view::ViewAnswer saved = Post("/api/save", state);
    EXPECT_EQ(saved.status, 200) << saved.body;
    const std::string command = nlohmann::json::parse(saved.body)["command"];
    EXPECT_TRUE(command.starts_with("sonarcal simulate "));
    const auto outcome = RunSonarcal(command.substr(9) + " -q");
    EXPECT_EQ(outcome.status, 0) << command << '\n' << outcome.err;
    return FrameOf(world_ / "kept" / "sim", frame);
  }

  TinyWorld world_;
  std::unique_ptr<view::ViewSession> session_;
  std::unique_ptr<view::ViewApi> api_;
};

}  // namespace sonarcal::testing
