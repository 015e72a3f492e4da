// Images of `sonarcal view`, without a socket: those of `simulate`, to the bit, whatever is moved.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <set>
#include <utility>

#include "tests/apps/view/view_world.h"

namespace sonarcal::view {
namespace {

using Json = nlohmann::json;
using testing::Framed;
using testing::FrameOf;
using testing::GreyOf;
using testing::ReadFramed;
using testing::ReadJsonFile;
using testing::ViewApiTest;

TEST_F(ViewApiTest, ImagesAreThoseOfSimulateToTheBit) {
  const auto expected = world_.WriteSimulated("expected", false, true);
  for (int frame = 0; frame < session_->frame_count(); ++frame) {
    Json state = State();
    state["frame"] = frame;
    EXPECT_EQ(GreyOf(ReadFramed(Post("/api/render", state))), FrameOf(expected, frame)) << frame;
  }
}

TEST_F(ViewApiTest, MovedControlsMakeTheImageThatTheSavedFilesMake) {
  Json state = State();
  const std::vector<float> before = GreyOf(ReadFramed(Post("/api/render", state)));
  state["parameters"]["materials"]["box"]["gsab"]["A"] = 71.23;
  state["parameters"]["water"] = {{"temperature_c", 8}, {"salinity_ppt", 35}, {"ph", 8.1}, {"depth_m", 3}};
  const std::vector<float> shaded = GreyOf(ReadFramed(Post("/api/render", state)));
  EXPECT_NE(shaded, before);
  EXPECT_EQ(shaded, Simulated(state, 0));

  state["noise"] = true;
  state["seed"] = 7;
  state["frame"] = 2;
  state["poses"]["2"] = {
      {"position_m", {0.1, -2.2, 1.4}}, {"yaw_deg", 3.5}, {"pitch_deg", -31.0}, {"roll_deg", 2.0}};
  const std::vector<float> noisy = GreyOf(ReadFramed(Post("/api/render", state)));
  EXPECT_EQ(noisy, Simulated(state, 2));
  state["seed"] = 8;
  EXPECT_NE(GreyOf(ReadFramed(Post("/api/render", state))), noisy);
}

// Makes four pings receive the beams, one after the other.
void TimePings(const std::filesystem::path& sonar_file) {
  Json sonar = ReadJsonFile(sonar_file);
  for (int beam = 0; beam < 24; ++beam) sonar["sonar"]["pings"]["of_beam"].push_back(beam % 4);
  sonar["sonar"]["pings"]["period_s"] = 0.01;
  testing::WriteFile(sonar_file, sonar.dump());
}

// A sonar that turns by 2 degrees while four pings receive its beams.
TEST_F(ViewApiTest, BeamsHaveThePosesOfTheirPings) {
  TimePings(world_.sonar());
  Json poses = ReadJsonFile(world_.poses());
  for (Json& pose : poses["poses"]) pose["motion"] = {{"turn_rate_deg_per_s", {0, 0, 66}}};
  testing::WriteFile(world_.poses(), poses.dump());
  commands::ViewOptions options = Options();
  options.real = world_.WriteSimulated("turning", true);
  const std::vector<float> still = GreyOf(ReadFramed(Post("/api/render", State())));
  session_ = std::make_unique<ViewSession>(commands::SetUpView(options));
  api_ = std::make_unique<ViewApi>(*session_, options.out);
  const std::vector<float> turning = GreyOf(ReadFramed(Post("/api/render", State())));
  EXPECT_EQ(turning, FrameOf(world_.WriteSimulated("expected", false, true), 0));
  EXPECT_NE(turning, still);
  Json state = State();
  state["noise"] = true;
  EXPECT_EQ(GreyOf(ReadFramed(Post("/api/render", state))), FrameOf(options.real, 0));
  state["noise"] = false;
  state["parameters"]["model"] = "acoustic";
  state["parameters"]["display"] = {{"db_min", 60}, {"db_max", 200}};
  state["parameters"]["receiver"]["noise_db"] = 70;
  EXPECT_EQ(GreyOf(ReadFramed(Post("/api/render", state))), Simulated(state, 0)) << "with the saved motion";
}

// A file of poses with times and without motion, which follows from the times.
TEST_F(ViewApiTest, BeamsHaveThePosesOfTheirPingsByTheTimesOfAFile) {
  commands::ViewOptions options = Options();
  options.real.clear();
  options.sonar = world_.sonar().string();
  options.poses = world_.poses();
  const auto shown = [&] {
    session_ = std::make_unique<ViewSession>(commands::SetUpView(options));
    api_ = std::make_unique<ViewApi>(*session_, options.out);
    return GreyOf(ReadFramed(Post("/api/render", State())));
  };
  const std::vector<float> still = shown();
  TimePings(world_.sonar());
  const std::vector<float> moving = shown();
  EXPECT_NE(moving, still);
  EXPECT_EQ(moving, Simulated(State(), 0));
}

TEST_F(ViewApiTest, AcousticImagesAreThoseOfSimulateToTheBit) {
  Json state = State();
  state["parameters"]["model"] = "acoustic";
  state["parameters"]["display"] = {{"db_min", 60}, {"db_max", 200}};
  state["parameters"]["receiver"]["noise_db"] = 70;
  state["parameters"]["mirror"]["floor"]["loss_db"] = 3;
  const std::vector<float> expected = GreyOf(ReadFramed(Post("/api/render", state)));
  EXPECT_EQ(expected, Simulated(state, 0));
  state["noise"] = true;
  state["parameters"]["beam"]["azimuth_width_deg"] = 2.2;
  EXPECT_EQ(GreyOf(ReadFramed(Post("/api/render", state))), Simulated(state, 0));
}

// Whoever chooses the rays: simulate's own rule for the acoustic model is the view's.
TEST_F(ViewApiTest, AcousticImagesAreThoseOfSimulateForEveryChoiceOfRays) {
  Json state = State();
  state["parameters"]["model"] = "acoustic";
  state["parameters"]["display"] = {{"db_min", 60}, {"db_max", 200}};
  state["parameters"]["receiver"]["noise_db"] = 70;
  const std::vector<std::pair<std::optional<sim::Sampling>, std::optional<RayGridSize>>> choices = {
      {{}, {}},
      {{}, RayGridSize{96, 120}},
      {sim::Sampling::kBeams, {}},
      {sim::Sampling::kFrustum, RayGridSize{96, 120}}};
  std::set<std::vector<float>> images;
  for (const auto& [sampling, rays] : choices) {
    commands::ViewOptions options = Options();
    options.rays = {};
    options.rays.sampling = sampling;
    options.rays.rays = rays;
    session_ = std::make_unique<ViewSession>(commands::SetUpView(options));
    api_ = std::make_unique<ViewApi>(*session_, options.out);
    const std::vector<float> image = GreyOf(ReadFramed(Post("/api/render", state)));
    SCOPED_TRACE(rays ? rays->cols : 0);
    EXPECT_EQ(image, Simulated(state, 0));
    images.insert(image);
  }
  EXPECT_GE(images.size(), 3U) << "the rays can be told apart";
}

// What is seen in a mirror changes with the beam, though the rays of direct echoes stay.
TEST_F(ViewApiTest, GhostsFollowTheBeam) {
  Json state = State();
  state["parameters"]["model"] = "acoustic";
  state["parameters"]["display"] = {{"db_min", 0}, {"db_max", 200}};
  state["parameters"]["mirror"]["floor"]["loss_db"] = 0;
  Json& beam = state["parameters"]["beam"];
  beam["elevation_pattern"] = "aperture";
  beam["elevation_taper"] = 0.0;
  beam["elevation_width_deg"] = 30.0;
  Post("/api/render", state);
  for (const auto& [name, value] : {std::pair<const char*, Json>{"elevation_width_deg", 12.0},
                                    {"elevation_taper", 1.0},
                                    {"elevation_pattern", "cosine"},
                                    {"transmit_end_deg", 30.0}}) {
    beam[name] = value;
    SCOPED_TRACE(name);
    EXPECT_EQ(GreyOf(ReadFramed(Post("/api/render", state))), Simulated(state, 0));
  }
}

TEST_F(ViewApiTest, AChangedSonarMakesTheImageOfItsSavedFiles) {
  commands::ViewOptions options = Options();
  options.real.clear();
  options.sonar = world_.sonar().string();
  options.poses = world_.poses();
  options.rays = {};
  session_ = std::make_unique<ViewSession>(commands::SetUpView(options));
  api_ = std::make_unique<ViewApi>(*session_, options.out);
  Json state = State();
  state["sonar"] = {
      {"range_max_m", 5.5}, {"range_bins", 77}, {"field_of_view_deg", 40}, {"frequency_hz", 5e5}};
  const Framed framed = ReadFramed(Post("/api/render", state));
  EXPECT_EQ(framed.json["bins"], 77);
  EXPECT_EQ(framed.json["axes"]["range_m"][1], 5.5);
  const std::vector<double> azimuth_deg = framed.json["axes"]["azimuth_deg"];
  EXPECT_NEAR((azimuth_deg.back() - azimuth_deg.front()) * 24.0 / 23.0, 40.0, 1e-9);
  EXPECT_EQ(GreyOf(framed), Simulated(state, 0));
}

TEST_F(ViewApiTest, UnknownFieldsOfASonarStayUnknown) {
  Json sonar = ReadJsonFile(world_.sonar());
  sonar["sonar"].erase("sound_speed_m_per_s");
  sonar["sonar"].erase("azimuth_beam_width_deg");
  testing::WriteFile(world_ / "unknown.json", sonar.dump());
  commands::ViewOptions options = Options();
  options.real.clear();
  options.sonar = (world_ / "unknown.json").string();
  options.poses = world_.poses();
  session_ = std::make_unique<ViewSession>(commands::SetUpView(options));
  api_ = std::make_unique<ViewApi>(*session_, options.out);
  Json state = State();
  state["sonar"] = {{"range_bins", 77}, {"beams", 19}};
  EXPECT_EQ(GreyOf(ReadFramed(Post("/api/render", state))), Simulated(state, 0));
  const Json written = ReadJsonFile(world_ / "kept" / "sonar.json")["sonar"];
  EXPECT_FALSE(written.contains("sound_speed_m_per_s"));
  EXPECT_FALSE(written.contains("azimuth_beam_width_deg"));
}

TEST_F(ViewApiTest, MaterialsOfThePapersExpectedImageAreShadedWithoutARay) {
  Json state = State();
  state["noise"] = false;
  Post("/api/render", state);
  const std::int64_t cast = session_->rays_cast();
  state["parameters"]["materials"]["floor"]["gsab"]["C"] = 3.0;
  const Framed shaded = ReadFramed(Post("/api/render", state));
  EXPECT_EQ(session_->rays_cast(), cast);
  EXPECT_EQ(shaded.json["traced"], false);
  state["frame"] = 1;
  EXPECT_EQ(ReadFramed(Post("/api/render", state)).json["traced"], true);
  EXPECT_GT(session_->rays_cast(), cast);
}

TEST_F(ViewApiTest, AnOvertakenRequestIsNotRendered) {
  Json state = State();
  state["client"] = "page";
  state["sequence"] = 5;
  EXPECT_EQ(Post("/api/render", state).status, 200);
  state["sequence"] = 4;
  EXPECT_EQ(Post("/api/render", state).status, 204);
  state["client"] = "another page";
  EXPECT_EQ(Post("/api/render", state).status, 200);
}

}  // namespace
}  // namespace sonarcal::view
