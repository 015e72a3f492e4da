// What the page of `sonarcal view` gets beside images (view_images_test.cc), without a socket: figures that
// are those of `compare`, controls, the mesh, fits, refusals.
#include "apps/view/view_api.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <functional>
#include <set>
#include <thread>

#include "apps/commands/compare_command.h"
#include "apps/view/view_controls.h"
#include "apps/view/view_mesh.h"
#include "calib/parameters/parameter_catalog.h"
#include "core/materials/named_materials.h"
#include "core/types/error.h"
#include "core/types/units.h"
#include "data_io/json/json_writer.h"
#include "data_io/parameters/materials_io.h"
#include "data_io/parameters/parameters_io.h"
#include "tests/apps/view/view_world.h"

namespace sonarcal::view {
namespace {

using Json = nlohmann::json;
using testing::Framed;
using testing::FrameOf;
using testing::GreyOf;
using ::testing::HasSubstr;
using testing::Quoted;
using testing::ReadFramed;
using testing::ReadJsonFile;
using testing::RunSonarcal;
using testing::TinyParameters;
using testing::ViewApiTest;

class ViewFigures : public ViewApiTest {
 protected:
  // The page's figures of every frame against those of `compare` with `extra`.
  void ExpectThoseOfCompare(const std::string& extra);
};

void ViewFigures::ExpectThoseOfCompare(const std::string& extra) {
  const auto expected = world_.WriteSimulated("expected", false, true);
  const auto outcome =
      RunSonarcal(fmt::format("compare --real {} --sim {} --as-displayed --pictures 0 --out {} -q {}",
                              Quoted(world_ / "real"), Quoted(expected), Quoted(world_ / "compared"), extra));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Json metrics = ReadJsonFile(world_ / "compared" / "metrics.json");
  for (int frame = 0; frame < session_->frame_count(); ++frame) {
    Json state = State();
    state["frame"] = frame;
    const Framed framed = ReadFramed(Post("/api/compare", state));
    for (const auto& [key, value] : metrics["frames"][frame].items())
      EXPECT_EQ(framed.json[key], value) << key;
    std::int64_t simulated = 0;
    for (const char region : framed.data) simulated += (region & 2) != 0 ? 1 : 0;
    EXPECT_EQ(framed.json["ns"], simulated);
  }
}

TEST_F(ViewFigures, TheLogLikelihoodIsThatOfTheAcousticModel) {
  const auto of = [&](const ParameterSet& parameters) {
    Json state = State();
    state["parameters"] = Json::parse(data_io::ParametersJson(parameters).dump());
    return ReadFramed(Post("/api/compare", state)).json.at("nats_per_pixel");
  };
  ParameterSet parameters = testing::TinyAcousticParameters();
  const double nats = of(parameters).get<double>();
  EXPECT_LT(nats, 0.0);
  parameters.source_level_db += 30.0;  // far too bright
  EXPECT_LT(of(parameters).get<double>(), nats);
  parameters.receiver.noise_db.reset();
  EXPECT_TRUE(of(parameters).is_null());
  EXPECT_TRUE(of(TinyParameters()).is_null());
}

TEST_F(ViewFigures, FiguresEqualThoseOfTheCompareCommand) {
  ExpectThoseOfCompare("");
}

TEST_F(ViewFigures, FiguresInTheBoxOfAnObjectEqualThoseOfTheCompareCommand) {
  commands::ViewOptions options = Options();
  options.comparison.object = "box";
  session_ = std::make_unique<ViewSession>(commands::SetUpView(options));
  api_ = std::make_unique<ViewApi>(*session_, options.out);
  ExpectThoseOfCompare("--object box");
}

TEST_F(ViewApiTest, RecordedFramesAreShownUnchanged) {
  for (const int frame : {0, 3}) {
    const Framed framed = ReadFramed(Post("/api/recorded", {{"frame", frame}}));
    EXPECT_EQ(framed.json["full_scale"], 4095);
    EXPECT_EQ(GreyOf(framed), FrameOf(world_ / "real", frame));
  }
}

// Every number and word that params.json holds has a control. No image has texture, and so no control has its
// share.
TEST_F(ViewApiTest, EveryParameterHasAControl) {
  const Json session = Json::parse(api_->Answer("GET", "/api/session", {}).body);
  std::set<std::vector<std::string>> paths;
  for (const Json& control : session["controls"])
    paths.insert(control["path"].get<std::vector<std::string>>());
  ParameterSet full = TinyParameters();
  full.water = Water{};
  full.receiver.noise_db = 1.0;
  full.receiver.noise_after_gain_db = 1.0;
  for (const char* material : {"floor", "box"}) full.mirrors[material].loss_db = 3.0;
  int count = 0;
  const std::function<void(const Json&, const std::vector<std::string>&)> walk =
      [&](const Json& node, const std::vector<std::string>& path) {
        for (const auto& [key, value] : node.items()) {
          std::vector<std::string> below = path;
          below.push_back(key);
          if (value.is_object()) {
            walk(value, below);
          } else if (!value.is_array() && key != "format" && key != "model") {
            EXPECT_EQ(paths.contains(below), key != "diffuse_share")
                << fmt::format("{}", fmt::join(below, "."));
            ++count;
          }
        }
      };
  walk(Json::parse(data_io::ParametersJson(full).dump()), {"parameters"});
  EXPECT_GT(count, 40);
}

TEST_F(ViewApiTest, ControlsHaveTheBoundsOfTheCatalogueAndWordsThatFilesHave) {
  const ViewSetup& setup = session_->setup();
  const std::vector<std::string>& materials = session_->scene().material_names;
  const auto controls = ViewControls({.parameters = setup.parameters,
                                      .sonar = setup.sonar,
                                      .water = setup.water,
                                      .material_names = materials});
  const std::vector<calib::CatalogEntry> paper = calib::BuildCatalog(materials);
  const std::vector<calib::CatalogEntry> acoustic = calib::BuildAcousticCatalog(materials, setup.sonar, {});
  int of_catalog = 0;
  int words = 0;
  for (const ViewControl& control : controls) {
    for (const std::string& word : control.words) {
      Json json = State()["parameters"];
      json[control.path[1]][control.path[2]] = word;
      EXPECT_NO_THROW(data_io::ParseParameters(json.dump(), "words")) << control.name << ' ' << word;
      ++words;
    }
    if (!control.words.empty()) continue;
    EXPECT_LT(control.slider_lower, control.slider_upper) << control.name;
    EXPECT_GE(control.slider_lower, control.lower) << control.name;
    EXPECT_LE(control.slider_upper, control.upper) << control.name;
    EXPECT_FALSE(control.unit.empty()) << control.name;
    for (const calib::CatalogEntry& entry : control.model == EchoModel::kAcoustic ? acoustic : paper) {
      if (entry.name != control.name || !control.fitted || control.absent) continue;
      EXPECT_EQ(control.unit, entry.unit) << control.name;
      EXPECT_EQ(control.lower, entry.lower) << control.name;
      // But for one that does not hold the value at the start.
      const bool wider = control.name == "material.box.gsab.C" && control.model == EchoModel::kAcoustic;
      EXPECT_EQ(control.upper, wider ? TinyParameters().Material("box").gsab.c : entry.upper) << control.name;
      ++of_catalog;
    }
  }
  EXPECT_EQ(words, 4 + 2 + 4 + 2 + 3 + 2);
  EXPECT_GE(of_catalog, 2 * 2 * 6 + 6);
}

TEST_F(ViewApiTest, InvalidRequestsAreRefusedInOneSentence) {
  const auto refused = [&](const std::string& path, const std::string& body, int status,
                           const std::string& what) {
    const ViewAnswer answer = api_->Answer("POST", path, body);
    EXPECT_EQ(answer.status, status) << body << '\n' << answer.body;
    const std::string sentence = Json::parse(answer.body)["error"];
    EXPECT_THAT(sentence, HasSubstr(what));
    EXPECT_EQ(sentence.find('\n'), std::string::npos);
  };
  refused("/api/render", "{", 400, "request:1");
  refused("/api/render", "{}", 400, "'parameters'");
  refused("/api/render", "[]", 400, "expected");
  refused("/api/render", std::string(100'000, '['), 400, "request:1");
  for (const auto& [key, value, what] : std::vector<std::tuple<std::string, Json, std::string>>{
           {"surprise", 1, "unknown key 'surprise'"},
           {"frame", 4, "'frame'"},
           {"frame", -1, "'frame'"},
           {"seed", 0.5, "'seed'"},
           {"noise", "yes", "'noise'"},
           {"parameters", 7, "'parameters'"},
           {"sonar", {{"range_bins", 1e9}}, "range_bins"},
           {"sonar", {{"beams", 1}}, "beams"},
           {"poses", {{"9", 1}}, "'9'"},
           {"poses", {{"0", {{"position_m", {1, 2}}}}}, "position_m"}}) {
    Json state = State();
    state[key] = value;
    refused("/api/render", state.dump(), 400, what);
  }
  Json state = State();
  state["parameters"]["materials"]["floor"]["gsab"]["A"] = -1;
  refused("/api/render", state.dump(), 400, "materials.floor.gsab.A");
  state = State();
  state["sonar"] = {{"range_min_m", 4.5}};
  refused("/api/render", state.dump(), 422, "range_max_m is 4.5, expected more than range_min_m, 4.5");
  state = State();
  state["parameters"]["model"] = "coherent";
  refused("/api/render", state.dump(), 422, "coherent");
  refused("/api/recorded", R"({"frame": 4})", 400, "'frame'");
  refused("/api/nothing", "{}", 404, "nothing is there");
  EXPECT_EQ(api_->Answer("GET", "/api/render", {}).status, 404);
}

TEST_F(ViewApiTest, WithoutARecordingOrAFolderItSaysSo) {
  commands::ViewOptions options = Options();
  options.real.clear();
  options.sonar = world_.sonar().string();
  ViewSession session(commands::SetUpView(options));
  EXPECT_EQ(session.frame_count(), 1);
  EXPECT_FALSE(session.setup().poses_given);
  ViewApi api(session, {});
  for (const auto& [path, what] : {std::pair{"/api/recorded", "--real"},
                                   {"/api/compare", "--real"},
                                   {"/api/fit/start", "--real"},
                                   {"/api/save", "--out"}}) {
    const ViewAnswer answer = api.Answer("POST", path, State().dump());
    EXPECT_EQ(answer.status, 422) << path;
    EXPECT_THAT(answer.body, HasSubstr(what));
  }
  // The place of its own choice sees something.
  const std::vector<float> values = GreyOf(ReadFramed(api.Answer("POST", "/api/render", State().dump())));
  EXPECT_GT(*std::max_element(values.begin(), values.end()), 0.0f);
  options.sonar.clear();
  EXPECT_THROW(commands::SetUpView(options), UsageError);
}

TEST_F(ViewApiTest, SavedFilesListWhatTheViewRead) {
  commands::ViewOptions options = Options();
  options.sonar = world_.sonar().string();
  options.poses = world_.poses();
  ViewSession session(commands::SetUpView(options));
  ViewApi api(session, options.out);
  ASSERT_EQ(api.Answer("POST", "/api/save", State().dump()).status, 200);
  std::vector<std::string> paths;
  const nlohmann::json provenance = testing::ReadJsonFile(options.out / "provenance.json");
  for (const nlohmann::json& input : provenance.at("inputs")) paths.push_back(input.at("path"));
  EXPECT_THAT(paths,
              ::testing::UnorderedElementsAre(options.scene.string(), options.sonar, options.params.string(),
                                              options.poses.string(), options.real.string()));
}

TEST_F(ViewApiTest, TheMeshIsTheScene) {
  const Scene& scene = session_->scene();
  const Framed framed = ReadFramed(api_->Answer("GET", "/api/scene", {}));
  ASSERT_EQ(framed.data.size(), 12 * scene.vertices_m.size() + 14 * scene.triangles.size());
  for (std::size_t i = 0; i < scene.vertices_m.size(); ++i) {
    Eigen::Vector3f vertex_m;
    std::memcpy(vertex_m.data(), &framed.data[12 * i], 12);
    EXPECT_EQ(vertex_m, scene.vertices_m[i]);
  }
  const char* triangles = &framed.data[12 * scene.vertices_m.size()];
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    EXPECT_EQ(std::memcmp(triangles + 12 * i, scene.triangles[i].data(), 12), 0);
  }
  const char* materials = triangles + 12 * scene.triangles.size();
  EXPECT_EQ(std::memcmp(materials, scene.triangle_material.data(), 2 * scene.triangles.size()), 0);
  EXPECT_EQ(framed.json["material_names"].get<std::vector<std::string>>(), scene.material_names);
  // Of a larger one, a share.
  const Framed few = ReadFramed({200, "", MeshFrame(scene, 5)});
  EXPECT_EQ(scene.triangles.size(), 12U);
  EXPECT_EQ(few.json["triangles"], 4);
  EXPECT_EQ(few.json["triangles_in_scene"], 12);
}

Json WaitForFit(ViewApi& api) {
  for (int i = 0; i < 6000; ++i) {
    Json status = Json::parse(api.Answer("GET", "/api/fit", {}).body);
    if (status["state"] != "running" && status["state"] != "stopping") return status;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return {{"state", "never ended"}};
}

TEST_F(ViewApiTest, AFitIsThatOfTheCommand) {
  EXPECT_EQ(Json::parse(api_->Answer("GET", "/api/fit", {}).body)["state"], "none");
  Json state = State();
  state["parameters"]["materials"]["box"]["gsab"]["C"] = 1.0;
  const Json request = {{"state", state}, {"starts", 1}, {"fixed", {"jitter.*"}}};
  const ViewAnswer started = Post("/api/fit/start", request);
  ASSERT_EQ(started.status, 200) << started.body;
  EXPECT_EQ(Post("/api/fit/start", request).status, 422);  // one at a time
  const Json status = WaitForFit(*api_);
  ASSERT_EQ(status["state"], "done") << status;
  const Json& result = status["result"];

  testing::WriteFile(world_ / "start.json", state["parameters"].dump());
  const auto outcome = RunSonarcal(
      fmt::format("fit --real {} --scene {} --params {} --rays 96x200 --starts 1 --fixed 'jitter.*' --out {} "
                  "-q",
                  Quoted(world_ / "real"), Quoted(world_.scene()), Quoted(world_ / "start.json"),
                  Quoted(world_ / "fit")));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const ParameterSet by_command = data_io::ReadParameters(world_ / "fit" / "params.json");
  const ParameterSet by_view = data_io::ParseParameters(result["parameters"].dump(), "result");
  for (const char* material : {"floor", "box"}) {
    EXPECT_EQ(by_view.Material(material), by_command.Material(material)) << material;
  }
  EXPECT_EQ(by_view.display, by_command.display);
  EXPECT_EQ(result["frames_held_out"], ReadJsonFile(world_ / "fit" / "fit.json")["frames_held_out"]);
}

// The floor's prior is in a file of materials.
class ViewPriors : public ViewApiTest {
 protected:
  ViewPriors() {
    NamedMaterial floor{.name = "tank floor",
                        .model = EchoModel::kPaper,
                        .centre = TinyParameters().materials.at("floor").gsab,
                        .spread = {.a = 1.5, .b_deg = 1.5, .c = 1.2, .d = 0.1, .e = 1.5, .f_deg = 1.5},
                        .level_db = ReferenceLevelDb(TinyParameters()) + 10.0,
                        .frequency_min_hz = 9e5,
                        .frequency_max_hz = 9e5,
                        .source = "a test",
                        .comment = {}};
    data_io::WriteJson(world_ / "materials.json", data_io::MaterialsJson({floor}));
    centre_ = CentreFor(floor, TinyParameters());
  }

  // Parameters whose floor has the prior, and the curve or not.
  void WriteStart(bool with_curve) {
    auto json = data_io::ParametersJson(TinyParameters());
    json["materials"]["floor"]["prior"] = "tank floor";
    if (!with_curve) json["materials"]["floor"].erase("gsab");
    data_io::WriteJson(world_ / "start.json", json);
  }

  commands::ViewOptions WithPriors(bool with_file) const {
    commands::ViewOptions options = Options();
    options.params = world_ / "start.json";
    if (with_file) options.materials.materials = {(world_ / "materials.json").string()};
    return options;
  }

  void Show(const commands::ViewOptions& options) {
    session_ = std::make_unique<ViewSession>(commands::SetUpView(options));
    api_ = std::make_unique<ViewApi>(*session_, options.out);
  }

  Json StateOfSetup() const {
    return {{"parameters", Json::parse(data_io::ParametersJson(session_->setup().parameters).dump())}};
  }

  GsabParameters<double> centre_;
};

TEST_F(ViewPriors, AMaterialWithoutACurveStartsAtTheCentreOfItsPrior) {
  WriteStart(false);
  EXPECT_THROW(commands::SetUpView(WithPriors(false)), DataError);
  commands::ViewOptions options = WithPriors(true);
  options.common.quiet = false;
  ::testing::internal::CaptureStderr();
  Show(options);
  EXPECT_THAT(::testing::internal::GetCapturedStderr(),
              HasSubstr("'floor' starts at the centre of the prior of tank floor"));
  EXPECT_EQ(session_->setup().parameters.materials.at("floor").gsab, centre_);
  EXPECT_NEAR(centre_.c, 10.0 * TinyParameters().materials.at("floor").gsab.c, 1e-9) << "10 dB in level";
  EXPECT_EQ(Post("/api/render", StateOfSetup()).status, 200);
}

TEST_F(ViewPriors, AFitTakesThePriorsOfTheFileAsTheCommandDoes) {
  WriteStart(false);
  Show(WithPriors(true));
  const ViewAnswer started =
      Post("/api/fit/start", {{"state", StateOfSetup()}, {"starts", 1}, {"fixed", {"jitter.*"}}});
  ASSERT_EQ(started.status, 200) << started.body;
  const Json status = WaitForFit(*api_);
  ASSERT_EQ(status["state"], "done") << status;
  const auto outcome = RunSonarcal(
      fmt::format("fit --real {} --scene {} --params {} --materials {} --rays 96x200 --starts 1 --fixed "
                  "'jitter.*' --out {}",
                  Quoted(world_ / "real"), Quoted(world_.scene()), Quoted(world_ / "start.json"),
                  Quoted(world_ / "materials.json"), Quoted(world_ / "fit")));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("has the prior of tank floor"));
  const ParameterSet by_command = data_io::ReadParameters(world_ / "fit" / "params.json");
  const ParameterSet by_view = data_io::ParseParameters(status["result"]["parameters"].dump(), "result");
  for (const char* material : {"floor", "box"})
    EXPECT_EQ(by_view.Material(material), by_command.Material(material)) << material;
}

TEST_F(ViewPriors, ACurveIsShownWithoutTheFileOfItsPrior) {
  WriteStart(true);
  Show(WithPriors(false));
  EXPECT_EQ(session_->setup().parameters.materials.at("floor").gsab,
            TinyParameters().materials.at("floor").gsab);
  const ViewAnswer refused = Post("/api/fit/start", {{"state", StateOfSetup()}});
  EXPECT_EQ(refused.status, 422);
  EXPECT_THAT(refused.body, HasSubstr("tank floor"));
}

TEST_F(ViewPriors, AMaterialOfTheCommandLineMustExist) {
  commands::ViewOptions options = Options();
  options.materials.material = {"flor=park-2024"};
  EXPECT_THROW(commands::SetUpView(options), DataError);
  options.materials.material = {"floor=silt"};
  EXPECT_THROW(commands::SetUpView(options), DataError) << "silt is one of the acoustic model";
  options.materials.material = {"floor=park-2024"};
  EXPECT_EQ(commands::SetUpView(options).materials.material, options.materials.material);
}

TEST_F(ViewApiTest, AFitCanBeStoppedAndFailsInOneSentence) {
  Json state = State();
  ASSERT_EQ(Post("/api/fit/start", {{"state", state}}).status, 200);
  ASSERT_EQ(Post("/api/fit/stop", Json::object()).status, 200);
  EXPECT_EQ(WaitForFit(*api_)["state"], "stopped");
  ASSERT_EQ(Post("/api/fit/start", {{"state", state}, {"fixed", {"no such name"}}}).status, 200);
  const Json failed = WaitForFit(*api_);
  EXPECT_EQ(failed["state"], "failed");
  EXPECT_THAT(failed["error"].get<std::string>(), HasSubstr("no such name"));
  state["sonar"]["frequency_hz"] = 8e5;
  EXPECT_EQ(Post("/api/fit/start", {{"state", state}}).status, 422);
  EXPECT_EQ(Post("/api/fit/start", {{"state", 3}}).status, 400);
}

}  // namespace
}  // namespace sonarcal::view
