#include "apps/commands/simulate_command.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

#include "apps/workflow/simulate.h"
#include "core/types/error.h"
#include "data_io/images/image_io.h"
#include "data_io/open_recording.h"
#include "data_io/parameters/parameters_io.h"
#include "data_io/pose_io.h"
#include "data_io/scenes/scene_io.h"
#include "sim/rays/acoustic_fan.h"
#include "sim/scenes/sonar_presets.h"
#include "tests/apps/tiny_world.h"

namespace sonarcal::commands {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::IsOneSentence;
using ::testing::Not;
using testing::Outcome;
using testing::Quoted;
using testing::RunSonarcal;
using testing::TinyWorld;

TEST(SimulateCommand, WritesARecordingThatStatesItsOrigin) {
  const TinyWorld world;
  const Outcome outcome = RunSonarcal(world.SimulateArguments() + " --quiet --out " + Quoted(world / "sim"));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.err, IsEmpty());
  EXPECT_THAT(outcome.out, HasSubstr("4 frames by the paper model"));

  const nlohmann::json json = testing::ReadJsonFile(world / "sim/recording.json");
  EXPECT_EQ(json["format"], "sonar-recording/1");
  EXPECT_EQ(json["synthetic"], true);
  EXPECT_EQ(json["source_level_db"], 200.0);
  EXPECT_EQ(json["image"]["bits"], 8);
  EXPECT_EQ(json["image"]["db_min"], 160.0);
  EXPECT_EQ(json["image"]["db_max"], 166.0);
  EXPECT_EQ(json["water"]["salinity_ppt"], 10.0);
  EXPECT_EQ(json["scene"], "../scene.gltf");
  EXPECT_EQ(json["frames"].size(), 4U);

  const auto recording = data_io::OpenRecording(world / "sim");
  EXPECT_TRUE(recording->info().synthetic);
  const std::vector<data_io::TimedPose> poses = data_io::ReadPoses(world.poses());
  for (int i = 0; i < recording->frame_count(); ++i) {
    const FrameInfo frame = recording->frame_info(i);
    ASSERT_TRUE(frame.world_from_sonar.has_value());
    EXPECT_NEAR((frame.world_from_sonar->position_m - poses[i].world_from_sonar.position_m).norm(), 0.0,
                1e-12);
    EXPECT_EQ(frame.time_s, poses[i].time_s);
  }
  const nlohmann::json provenance = testing::ReadJsonFile(world / "sim/provenance.json");
  EXPECT_EQ(provenance["command"], "simulate");
  EXPECT_EQ(provenance["configuration"]["rays"], "96x200");
  EXPECT_FALSE(provenance.contains("seed")) << "without noise there is no seed";
  EXPECT_EQ(data_io::ReadParameters(world / "sim/params.json"), testing::TinyParameters());
}

TEST(SimulateCommand, TheSeedAloneDecidesTheNoise) {
  const TinyWorld world;
  const auto run = [&](const std::string& name, const std::string& extra) {
    EXPECT_EQ(
        RunSonarcal(world.SimulateArguments() + " -q --noise " + extra + " --out " + Quoted(world / name))
            .status,
        0);
    return testing::ReadFile(world / (name + "/frame_0001.png"));
  };
  const std::string one = run("a", "--seed 5 --threads 1");
  EXPECT_EQ(one, run("b", "--seed 5"));
  EXPECT_NE(one, run("c", "--seed 6"));
}

TEST(SimulateCommand, TheWeightOfRaysIsAppliedAndRecorded) {
  const TinyWorld world;
  const auto run = [&](const std::string& name, const std::string& extra) {
    const Outcome outcome =
        RunSonarcal(world.SimulateArguments() + " -q " + extra + " --out " + Quoted(world / name));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return testing::ReadFile(world / (name + "/frame_0001.png"));
  };
  const std::string even = run("even", "--sampling frustum");
  EXPECT_EQ(run("as_even", "--sampling frustum --ray-weight even"), even);
  EXPECT_NE(run("weighed", "--sampling frustum --ray-weight solid_angle"), even);
  const auto details = data_io::OpenRecording(world / "weighed")->info().details;
  EXPECT_THAT(details, ::testing::Contains(::testing::Pair("ray weight", "solid_angle")));
  EXPECT_EQ(testing::ReadJsonFile(world / "weighed/provenance.json")["configuration"]["ray_weight"],
            "solid_angle");
  const Outcome refused =
      RunSonarcal(world.SimulateArguments() + " --model acoustic --ray-weight solid_angle" + " --out " +
                  Quoted(world / "refused"));
  EXPECT_EQ(refused.status, 2);
  EXPECT_TRUE(testing::IsOneSentence(refused.err)) << refused.err;
}

// By name, `beams` are staggered for the paper's model alone; what other models are given is as dense as
// ever.
TEST(RayOptions, DefaultBeamsAreThePapers) {
  const SonarModel& sonar = sim::FindSonarPreset("p900-45").sonar;
  const workflow::RayOptions rays(sim::Sampling::kBeams);
  const sim::RayFanOptions paper = rays.For(sonar, {}).fan;
  EXPECT_EQ(paper.cols, 512);
  EXPECT_EQ(paper.rows, 330);
  EXPECT_TRUE(paper.stagger);
  for (const EchoModel model : {EchoModel::kAcoustic, EchoModel::kCoherent}) {
    const sim::RayFanOptions other = rays.For(sonar, {}, model).fan;
    EXPECT_EQ(other.cols, 512);
    EXPECT_EQ(other.rows, 400);
    EXPECT_FALSE(other.stagger);
  }
  EXPECT_EQ(workflow::RayOptions().For(sonar, {}).fan.rows, 330) << "beams, where nothing is asked for";
  const sim::RayFanOptions papers_own = workflow::RayOptions(sim::Sampling::kFrustum).For(sonar, {}).fan;
  EXPECT_EQ(papers_own.cols, 1500);
  EXPECT_EQ(papers_own.rows, 1200);
  EXPECT_FALSE(papers_own.stagger);
  EXPECT_EQ(workflow::RayOptions().For(sonar, {}, EchoModel::kCoherent).fan.sampling,
            sim::Sampling::kFrustum);
  EXPECT_EQ(workflow::RayOptions().For(sonar, {}, ParameterSet{}).fan.rows, 330);
}

TEST(RayOptions, OtherModelsReachAsFarAsTheirBeam) {
  const SonarModel& sonar = sim::FindSonarPreset("p900-45").sonar;
  for (const EchoModel model : {EchoModel::kAcoustic, EchoModel::kCoherent}) {
    ParameterSet parameters;
    parameters.model = model;
    const sim::RayFanOptions wanted = sim::AcousticFanOptions(sonar, parameters);
    workflow::RayOptions rays;
    EXPECT_EQ(rays.For(sonar, {}, parameters).fan.rows, wanted.rows);
    rays.rays = RayGridSize{256, 300};
    const sim::RayFanOptions few = rays.For(sonar, {}, parameters).fan;
    EXPECT_EQ(few.sampling, sim::Sampling::kBeams);
    EXPECT_EQ(few.cols, 256);
    EXPECT_EQ(few.rows, 300);
    EXPECT_EQ(few.elevation_span_deg, wanted.elevation_span_deg);
    EXPECT_EQ(few.azimuth_margin_deg, wanted.azimuth_margin_deg);
    EXPECT_EQ(few.row_crowding, wanted.row_crowding);
    rays.sampling = sim::Sampling::kFrustum;
    const sim::RayFanOptions pinhole = rays.For(sonar, {}, parameters).fan;
    EXPECT_EQ(pinhole.sampling, sim::Sampling::kFrustum);
    EXPECT_EQ(pinhole.rows, 300);
    EXPECT_EQ(pinhole.elevation_span_deg, 120.0);
    EXPECT_EQ(pinhole.row_crowding, 1.0);
    sim::RayFan(sonar, pinhole);  // that is a fan
  }
}

TEST(SimulateCommand, FansAndRangesLieBesideTheFrames) {
  const TinyWorld world;
  ASSERT_EQ(
      RunSonarcal(world.SimulateArguments() + " -q --fan --depth --bits 12 --out " + Quoted(world / "sim"))
          .status,
      0);
  const data_io::ImageFile range(world / "sim/range_0003.tiff");
  EXPECT_EQ(range.header().rows, 200);
  EXPECT_EQ(range.header().cols, 96);
  EXPECT_TRUE(range.header().is_float);
  float longest_m = 0.0F;
  const Grid<float> ranges_m = range.DecodeGrey();
  for (const float range_m : ranges_m.values()) longest_m = std::max(longest_m, range_m);
  EXPECT_GT(longest_m, 2.0F);
  EXPECT_LE(longest_m, 4.5F);
  const Grid<std::uint16_t> depth_mm = data_io::ImageFile(world / "sim/depth_0003.png").DecodeGrey16();
  ASSERT_EQ(depth_mm.size(), ranges_m.size());
  int missed = 0;
  for (std::size_t i = 0; i < depth_mm.size(); ++i) {
    ASSERT_NEAR(depth_mm.values()[i], 1000.0 * ranges_m.values()[i], 0.501);
    missed += depth_mm.values()[i] == 0 ? 1 : 0;
  }
  EXPECT_GT(missed, 0);
  EXPECT_LT(missed, static_cast<int>(depth_mm.size()));
  EXPECT_EQ(data_io::ImageFile(world / "sim/depth_view_0003.png").header().rows, 200);
  EXPECT_EQ(data_io::ImageFile(world / "sim/fan_0000.png").header().bits, 16);
  EXPECT_EQ(testing::ReadJsonFile(world / "sim/recording.json")["image"]["full_scale"], 4095.0);
}

TEST(SimulateCommand, AnObjOrStlSceneGivesTheSameImagesAsItsGltf) {
  const TinyWorld world;
  const Scene scene = data_io::ReadGltf(world.scene());
  // The same triangles as OBJ, Y up, in millimetres, and as STL, Z up, in metres, all of one material.
  std::string obj;
  for (const Eigen::Vector3f& v : scene.vertices_m) {
    obj += fmt::format("v {:.9g} {:.9g} {:.9g}\n", 1e3 * v.x(), 1e3 * v.z(), -1e3 * v.y());
  }
  std::string stl = "solid world\n";
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    const Eigen::Vector3i& t = scene.triangles[i];
    obj += fmt::format("usemtl {}\nf {} {} {}\n", scene.material_names[scene.triangle_material[i]], t[0] + 1,
                       t[1] + 1, t[2] + 1);
    stl += "facet normal 0 0 0\nouter loop\n";
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3f& v = scene.vertices_m[t[k]];
      stl += fmt::format("vertex {:.9g} {:.9g} {:.9g}\n", v.x(), v.y(), v.z());
    }
    stl += "endloop\nendfacet\n";
  }
  testing::WriteFile(world / "scene.obj", obj);
  testing::WriteFile(world / "scene.stl", stl + "endsolid world\n");
  ParameterSet parameters = testing::TinyParameters();
  parameters.materials = {{"default", parameters.Material(scene.material_names[0])}};
  data_io::WriteParameters(world / "one.json", parameters);
  const auto images = [&](const std::string& name, const std::string& arguments) {
    const Outcome outcome =
        RunSonarcal(fmt::format("simulate {} --sonar {} --poses {} --rays 96x200 --out {}", arguments,
                                Quoted(world.sonar()), Quoted(world.poses()), Quoted(world / name)));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    if (arguments.find(".gltf") == std::string::npos) {
      EXPECT_THAT(outcome.err, HasSubstr("states neither unit nor upward axis"));
    }
    return testing::ReadFile(world / (name + "/frame_0001.png"));
  };
  const std::string params = " --params " + Quoted(world.params());
  const std::string one = " --params " + Quoted(world / "one.json");
  const std::string gltf = "--scene " + Quoted(world.scene());
  EXPECT_EQ(images("obj", "--scene " + Quoted(world / "scene.obj") + " --scene-unit mm" + params),
            images("gltf", gltf + params));
  EXPECT_EQ(images("stl", "--scene " + Quoted(world / "scene.stl") + one), images("gltf_one", gltf + one));

  const Outcome refused =
      RunSonarcal(world.SimulateArguments() + " --scene-up z --out " + Quoted(world / "no"));
  EXPECT_EQ(refused.status, 2);
  EXPECT_TRUE(testing::IsOneSentence(refused.err)) << refused.err;
}

TEST(SimulateCommand, WaterOfTheParametersWinsAndIsReported) {
  const TinyWorld world;
  ParameterSet parameters = testing::TinyParameters();
  parameters.water = Water{.temperature_c = 5.0, .salinity_ppt = 35.0, .ph = 8.0, .depth_m = 2.0};
  data_io::WriteParameters(world.params(), parameters);
  const Outcome outcome = RunSonarcal(world.SimulateArguments() + " --out " + Quoted(world / "sim"));
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(outcome.err, HasSubstr("water of the parameters"));
  EXPECT_EQ(testing::ReadJsonFile(world / "sim/recording.json")["water"]["temperature_c"], 5.0);
}

TEST(SimulateCommand, AbsorptionIsTheFormulaWhoseRangeHoldsByDefault) {
  const TinyWorld world;
  ParameterSet parameters = testing::TinyParameters();
  parameters.water = Water{};  // fresh
  data_io::WriteParameters(world.params(), parameters);
  const auto run = [&](const std::string& more) {
    return RunSonarcal(world.SimulateArguments() + more + " --out " + Quoted(world / "sim"));
  };
  const auto formula = [&] { return testing::ReadJsonFile(world / "sim/recording.json")["details"].dump(); };
  EXPECT_THAT(run("").err, Not(HasSubstr("absorption")));
  EXPECT_THAT(formula(), HasSubstr("francois-garrison"));
  EXPECT_THAT(run(" --absorption ainslie-mccolm").err,
              HasSubstr("absorption by Ainslie-McColm (0.2277 dB/m) is used outside its stated range"));
  EXPECT_THAT(formula(), HasSubstr("ainslie-mccolm"));
}

TEST(SimulateCommand, BothModelsAndAPresetWork) {
  const TinyWorld world;
  const std::string arguments = "simulate --scene " + Quoted(world.scene()) + " --params " +
                                Quoted(world.params()) + " --poses " + Quoted(world.poses()) +
                                " --sonar p900-45 --rays 256x100 -q --json --model acoustic --noise --out " +
                                Quoted(world / "sim");
  const Outcome outcome = RunSonarcal(arguments);
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const nlohmann::json json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json["model"], "acoustic");
  EXPECT_EQ(json["frames"], 4);
  // 3 degrees beyond either outer beam, in columns of 45 / 255 degrees.
  EXPECT_EQ(json["rays_cast"], 4 * (256 + 2 * 17) * 100);
}

// A beam hears far beside its half-power elevation, the floor below most of all: fewer rays see it too.
TEST(SimulateCommand, FewRaysReachAsFarAsManyDo) {
  const TinyWorld world;
  for (const std::string model : {"acoustic", "coherent"}) {
    const auto mean = [&](const std::string& name, const std::string& rays) {
      const Outcome outcome = RunSonarcal(
          fmt::format("simulate --scene {} --sonar {} --params {} --poses {} {} -q --model {} --out {}",
                      Quoted(world.scene()), Quoted(world.sonar()), Quoted(world.params()),
                      Quoted(world.poses()), rays, model, Quoted(world / name)));
      EXPECT_EQ(outcome.status, 0) << outcome.err;
      const Grid<float> image = data_io::OpenRecording(world / name)->ReadFrame(0).image.value;
      return std::accumulate(image.values().begin(), image.values().end(), 0.0) /
             static_cast<double>(image.size());
    };
    const double of_many = mean(model + "_many", "");
    EXPECT_GT(of_many, 10.0) << model;
    EXPECT_NEAR(mean(model + "_few", "--rays 48x400"), of_many, model == "acoustic" ? 0.3 : 2.0) << model;
  }
}

TEST(SimulateCommand, TheCoherentModelGivesASampleThatTheSeedDecides) {
  const TinyWorld world;
  const auto run = [&](const std::string& name, const std::string& extra) {
    const Outcome outcome = RunSonarcal(world.SimulateArguments() + " -q --model coherent " + extra +
                                        " --out " + Quoted(world / name));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return testing::ReadFile(world / (name + "/frame_0001.png"));
  };
  const std::string one = run("a", "--seed 5 --threads 1");
  EXPECT_EQ(one, run("b", "--seed 5"));
  EXPECT_NE(one, run("c", "--seed 6"));
  const nlohmann::json json = testing::ReadJsonFile(world / "a/recording.json");
  EXPECT_EQ(json["synthetic"], true);
  EXPECT_TRUE(data_io::OpenRecording(world / "a")->info().synthetic);
  EXPECT_EQ(data_io::ReadParameters(world / "a/params.json").model, EchoModel::kCoherent);
  const nlohmann::json provenance = testing::ReadJsonFile(world / "a/provenance.json");
  EXPECT_EQ(provenance["seed"], 5);
  EXPECT_EQ(provenance["configuration"]["noise"], true);
}

TEST(SimulateCommand, SaysIfAFrameTakesManyTimesAsLong) {
  const TinyWorld world;
  ParameterSet parameters = testing::TinyAcousticParameters();
  const auto warnings = [&](const std::string& extra) {
    data_io::WriteParameters(world.params(), parameters);
    const Outcome outcome = RunSonarcal(world.SimulateArguments() + " --frames :1 --force --out " +
                                        Quoted(world / "sim") + extra);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return outcome.err;
  };
  EXPECT_THAT(warnings(" --noise"), Not(HasSubstr("times as long")));
  EXPECT_THAT(warnings(" --model coherent"), Not(HasSubstr("times as long")));
  parameters.receiver.looks = 20.0;
  EXPECT_THAT(warnings(" --noise"), HasSubstr("receiver.looks is 20: a sample draws as many fields"));
  EXPECT_THAT(warnings(" --expected"), Not(HasSubstr("times as long"))) << "no sample";
  parameters.receiver.looks = 1.0;
  parameters.pulse.length_m = 2.0;
  EXPECT_THAT(warnings(" --noise"), Not(HasSubstr("times as long"))) << "no scatterers";
  EXPECT_THAT(warnings(" --model coherent"), HasSubstr("warning: the pulse is 2 m long"));
}

TEST(SimulateCommand, FrozenSpeckleStaysWhileNothingMoves) {
  const TinyWorld world;
  std::vector<data_io::TimedPose> poses(2, data_io::ReadPoses(world.poses())[1]);
  poses[1].time_s = *poses[0].time_s + 1.0;
  data_io::WritePoses(world.poses(), poses);
  for (const std::string model : {"acoustic --noise", "coherent"}) {
    const auto frames_are_one = [&](const std::string& name, const std::string& extra) {
      const Outcome outcome =
          RunSonarcal(fmt::format("{} -q --model {}{} --out {}", world.SimulateArguments(), model, extra,
                                  Quoted(world / (name + model))));
      EXPECT_EQ(outcome.status, 0) << outcome.err;
      return testing::ReadFile(world / (name + model + "/frame_0000.png")) ==
             testing::ReadFile(world / (name + model + "/frame_0001.png"));
    };
    // The tiny world's receiver has no noise.
    EXPECT_TRUE(frames_are_one("frozen ", " --frozen-speckle")) << model;
    EXPECT_FALSE(frames_are_one("moving ", "")) << model;
  }
}

TEST(SimulateCommand, InvalidOptionsAreRefusedInOneSentenceAndWriteNothing) {
  const TinyWorld world;
  const std::string good = world.SimulateArguments() + " -q --out " + Quoted(world / "sim");
  const std::vector<std::pair<std::string, int>> mistakes = {{good + " --model fancy", 2},
                                                             {good + " --rays 100", 2},
                                                             {good + " --bits 9", 2},
                                                             {good + " --sampling sideways", 2},
                                                             {good + " --threads -3", 2},
                                                             {"simulate --out x", 2},
                                                             {good + " --sonar no-such-sonar", 2},
                                                             {good + " --frozen-speckle", 2},
                                                             {good + " --model acoustic --frozen-speckle", 2},
                                                             {good + " --margin 3", 1},
                                                             {good + " --noise --seed -1", 2},
                                                             {good + " --noise --seed 1.5", 2},
                                                             {good + " --seed 5", 2},
                                                             {good + " --ghost-order 2", 2},
                                                             {good + " --model acoustic --ghost-order 2", 2},
                                                             {good + " --model coherent --normals depth", 2}};
  for (const auto& [arguments, status] : mistakes) {
    const Outcome outcome = RunSonarcal(arguments);
    EXPECT_EQ(outcome.status, status) << arguments;
    EXPECT_TRUE(IsOneSentence(outcome.err)) << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(world / "sim")) << arguments;
  }
  testing::WriteFile(world.params(),
                     R"({"format": "sonar-parameters/1", "model": "paper", "materials": {}})");
  const Outcome outcome = RunSonarcal(good);
  EXPECT_EQ(outcome.status, 1);
  EXPECT_TRUE(IsOneSentence(outcome.err)) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("params.json"));
}

// The arguments of the world with other rays than its own.
std::string WithRays(const TinyWorld& world, const std::string& rays) {
  const std::string own = "96x200";
  std::string arguments = world.SimulateArguments();
  return arguments.replace(arguments.find(own), own.size(), rays);
}

TEST(SimulateCommand, FewerColumnsThanBeamsAreRefused) {
  const TinyWorld world;
  for (const char* model : {"paper", "acoustic", "coherent"}) {
    const Outcome outcome =
        RunSonarcal(WithRays(world, "10x10") + " --model " + model + " --out " + Quoted(world / "sim"));
    EXPECT_EQ(outcome.status, 2) << model;
    EXPECT_TRUE(IsOneSentence(outcome.err)) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("--rays 10x10 has fewer columns than the 24 beams")) << model;
  }
}

TEST(SimulateCommand, TooManyBeamsAreRefused) {
  const TinyWorld world;
  constexpr int kBeams = 100'000;
  nlohmann::json sonar = testing::ReadJsonFile(world.sonar());
  std::vector<double> azimuth_deg;
  for (int beam = 0; beam < kBeams; ++beam) azimuth_deg.push_back(30.0 * beam / kBeams - 15.0);
  sonar["sonar"]["beam_azimuth_deg"] = azimuth_deg;
  testing::WriteFile(world.sonar(), sonar.dump());
  const std::string default_rays =
      fmt::format("simulate --scene {} --sonar {} --params {} --poses {}", Quoted(world.scene()),
                  Quoted(world.sonar()), Quoted(world.params()), Quoted(world.poses()));
  for (const auto& [model, columns] :
       {std::pair<std::string, int>{"paper", 200'000}, {"acoustic", 400'000}, {"coherent", 400'000}}) {
    const Outcome outcome =
        RunSonarcal(fmt::format("{} --model {} --out {}", default_rays, model, Quoted(world / "sim")));
    EXPECT_EQ(outcome.status, 1) << model;
    EXPECT_TRUE(IsOneSentence(outcome.err)) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(fmt::format("100000 beams need {} columns of rays", columns)));
  }
  const Outcome outcome =
      RunSonarcal(WithRays(world, "100000x1") + " --model acoustic --out " + Quoted(world / "sim"));
  EXPECT_EQ(outcome.status, 1);
  EXPECT_TRUE(IsOneSentence(outcome.err)) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("expected at most 100000000 pairs of beam and column"));
}

TEST(SimulateCommand, NoiseThatChangesNothingIsRefused) {
  const TinyWorld world;
  ParameterSet exact = testing::TinyParameters();
  exact.jitter = {};
  data_io::WriteParameters(world.params(), exact);
  const Outcome outcome = RunSonarcal(world.SimulateArguments() + " --noise --out " + Quoted(world / "sim"));
  EXPECT_EQ(outcome.status, 2);
  EXPECT_TRUE(IsOneSentence(outcome.err)) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("--noise has no effect"));
}

TEST(SimulateCommand, ARoundedNumberOfRaysIsReported) {
  const TinyWorld world;
  const auto run = [&](const std::string& rays) {
    return RunSonarcal(WithRays(world, rays) + " --out " + Quoted(world / "sim"));
  };
  EXPECT_THAT(run("96x40").err, ::testing::Not(HasSubstr("becomes")));
  const Outcome rounded = run("50x40");
  EXPECT_THAT(rounded.err,
              HasSubstr("--rays 50x40 becomes 72x40: each of the 24 beams takes 3 whole columns"));
  EXPECT_THAT(rounded.out, HasSubstr("72 x 40 rays"));
  // A pinhole casts what it is told, however few.
  EXPECT_THAT(run("10x10 --sampling frustum").out, HasSubstr("10 x 10 rays"));
}

TEST(SimulateCommand, FramesWithoutEchoesAreReportedWithTheLikelyReason) {
  const TinyWorld world;
  const std::string simulate = world.SimulateArguments() + " --json --out " + Quoted(world / "sim");
  const auto run = [&](const std::vector<Pose>& poses) {
    std::vector<data_io::TimedPose> timed;
    for (const Pose& pose : poses) timed.push_back({static_cast<double>(timed.size()), pose});
    data_io::WritePoses(world.poses(), timed);
    Outcome outcome = RunSonarcal(simulate);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return outcome;
  };
  const auto empty_frames = [](const Outcome& outcome) {
    return nlohmann::json::parse(outcome.out)["frames_without_echo"].get<std::vector<int>>();
  };
  const Pose sees = data_io::ReadPoses(world.poses()).front().world_from_sonar;
  Outcome outcome = run({sees});
  EXPECT_THAT(empty_frames(outcome), IsEmpty());
  EXPECT_THAT(outcome.err, ::testing::Not(HasSubstr("empty")));
  EXPECT_EQ(nlohmann::json::parse(outcome.out)["rays_cast"], 96 * 200) << "looking costs nothing that counts";

  Pose far = sees;
  far.position_m *= 1000.0;  // in millimetres
  outcome = run({sees, far, sees, far});
  EXPECT_THAT(empty_frames(outcome), ::testing::ElementsAre(1, 3));
  EXPECT_THAT(outcome.err,
              HasSubstr("warning: 2 of 4 frames are empty (1, 3): no ray hits the scene within"));
  EXPECT_THAT(outcome.err, HasSubstr("check the unit of the scene and the positions"));

  Pose away = sees;  // upwards, from above the floor
  away.position_m.z() = 1.0;
  away.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(1.5, Eigen::Vector3d::UnitX()));
  outcome = run({away, away});
  EXPECT_THAT(outcome.err, HasSubstr("warning: every frame is empty"));
  away.position_m.z() = 2.0;  // above the scene's box too
  EXPECT_THAT(run({away}).err, HasSubstr("the sonar looks along (0.00, 0.07, 1.00)"));
}

// A thing that few rays miss is no reason for a warning.
TEST(SimulateCommand, ASmallObjectShowsInTheImage) {
  const TinyWorld world;
  data_io::WriteGltf(Scene{.vertices_m = {{0, 0, 0}, {0.02F, 0, 0}, {0, 0, 0.02F}},
                           .triangles = {{0, 1, 2}},
                           .triangle_material = {0},
                           .material_names = {"box"}},
                     world.scene());
  data_io::WritePoses(world.poses(), {{0.0, Pose{Eigen::Quaterniond::Identity(), {0.005, -2.0, -0.01}}}});
  const Outcome outcome = RunSonarcal(WithRays(world, "480x1000") + " --json --out " + Quoted(world / "sim"));
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.err.find("empty"), std::string::npos) << outcome.err;
}

TEST(ChooseSonar, ReadsPresetsRecordingsAndSonarFiles) {
  const TinyWorld world;
  EXPECT_EQ(workflow::ChooseSonar("p900-45").sonar.axes.beam_count(), 256);
  EXPECT_EQ(workflow::ChooseSonar(world.sonar().string()).sonar.axes.beam_count(), 24);
  EXPECT_EQ(workflow::ChooseSonar(world.sonar().string()).water->salinity_ppt, 10.0);
  EXPECT_EQ(workflow::ChooseSonar(world.WriteSimulated("sim").string()).sonar.name, "tiny");
  EXPECT_THROW(workflow::ChooseSonar("nothing-like-it"), UsageError);
}

TEST(SimulateRecording, IsTheRecordingThatIsWritten) {
  const TinyWorld world;
  const auto written = data_io::OpenRecording(world.WriteSimulated("sim", true));
  const workflow::SonarChoice choice = workflow::ChooseSonar(world.sonar().string());
  workflow::RayOptions rays(sim::Sampling::kBeams);
  rays.rays = RayGridSize{96, 200};
  sim::SimulationOptions options = rays.For(choice.sonar, *choice.water);
  options.noise = true;
  options.bits = 12;
  const sim::Simulator simulator(data_io::ReadGltf(world.scene()), choice.sonar, options);
  int done = 0;
  const auto made =
      workflow::SimulateRecording(simulator, data_io::ReadPoses(world.poses()), testing::TinyParameters(), "",
                                  [&](int frames_done) { done = frames_done; });
  EXPECT_EQ(done, 4);
  ASSERT_EQ(made->frame_count(), written->frame_count());
  for (int i = 0; i < made->frame_count(); ++i) {
    EXPECT_EQ(made->ReadFrame(i).image.value, written->ReadFrame(i).image.value);
  }
}

}  // namespace
}  // namespace sonarcal::commands
