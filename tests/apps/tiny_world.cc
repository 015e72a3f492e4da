#include "tests/apps/tiny_world.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "apps/commands/simulate_command.h"
#include "core/types/units.h"
#include "data_io/parameters/parameters_io.h"
#include "data_io/pose_io.h"
#include "data_io/scenes/scene_io.h"

namespace sonarcal::testing {
namespace {

Scene TinyScene() {
  Scene scene;
  const auto add_quad = [&](const std::string& material, const Eigen::Vector3f& corner,
                            const Eigen::Vector3f& u, const Eigen::Vector3f& v) {
    const int first = static_cast<int>(scene.vertices_m.size());
    scene.vertices_m.insert(scene.vertices_m.end(), {corner, corner + u, corner + u + v, corner + v});
    scene.triangles.insert(scene.triangles.end(),
                           {{first, first + 1, first + 2}, {first, first + 2, first + 3}});
    scene.triangle_material.insert(scene.triangle_material.end(), 2, scene.MaterialIndex(material));
  };
  const Eigen::Vector3f x(1, 0, 0);
  const Eigen::Vector3f y(0, 1, 0);
  const Eigen::Vector3f z(0, 0, 1);
  const Eigen::Vector3f corner(-0.5F, -0.5F, 0.0F);
  add_quad("floor", {-5, -5, 0}, 10.0F * x, 10.0F * y);
  add_quad("box", corner, x, z);
  add_quad("box", corner + x, y, z);
  add_quad("box", corner + x + y, -x, z);
  add_quad("box", corner + y, -y, z);
  add_quad("box", corner + z, x, y);
  return scene;
}

std::vector<data_io::TimedPose> TinyPoses() {
  std::vector<data_io::TimedPose> poses;
  const auto look = [&](double x_m, double y_m, double z_m, double yaw_deg, double pitch_deg) {
    poses.push_back(
        {static_cast<double>(poses.size()),
         {RotationFromYawPitchRoll(RadFromDeg(yaw_deg), RadFromDeg(pitch_deg), 0.0), {x_m, y_m, z_m}}});
  };
  look(0.0, -2.5, 1.2, 0.0, -25.0);
  look(1.4, -2.2, 1.5, 30.0, -40.0);
  look(-0.3, -1.2, 2.6, 0.0, -80.0);
  look(0.3, 2.4, 0.6, 180.0, -5.0);
  return poses;
}

std::string TinySonarJson() {
  std::string azimuths;
  for (int beam = 0; beam < 24; ++beam)
    azimuths += fmt::format("{}{}", beam > 0 ? ", " : "", (beam - 11.5) * 1.2);
  return fmt::format(R"({{"sonar": {{"name": "tiny", "frequency_hz": 900000, "beam_azimuth_deg": [{}],
  "azimuth_beam_width_deg": 1.2, "elevation_beam_width_deg": 40, "range_min_m": 0.5, "range_max_m": 4.5,
  "range_bins": 60, "sound_speed_m_per_s": 1480}},
 "water": {{"temperature_c": 15, "salinity_ppt": 10, "ph": 8, "depth_m": 1}}}})",
                     azimuths);
}

}  // namespace

ParameterSet TinyParameters() {
  ParameterSet parameters;
  parameters.display = {.db_min = 160.0, .db_max = 166.0};
  parameters.materials["floor"].gsab = {.a = 90.0, .b_deg = 4.0, .c = 0.5, .d = 1.5, .e = 8.0, .f_deg = 14.0};
  parameters.materials["box"].gsab = {.a = 40.0, .b_deg = 3.0, .c = 2.0, .d = 1.0, .e = 10.0, .f_deg = 12.0};
  parameters.jitter = {.sigma_range_m = 0.06, .sigma_azimuth_deg = 1.2, .reference_range_m = 10.0};
  return parameters;
}

ParameterSet TinyAcousticParameters() {
  ParameterSet parameters = TinyParameters();
  parameters.model = EchoModel::kAcoustic;
  for (auto& [name, material] : parameters.materials) {
    for (double* amplitude : {&material.gsab.a, &material.gsab.c, &material.gsab.e}) *amplitude *= 1e-2;
  }
  parameters.receiver.noise_db = 110.0;
  parameters.display = {.db_min = 95.0, .db_max = 160.0};
  parameters.pulse.length_m = 0.1;
  return parameters;
}

TinyWorld::TinyWorld() {
  data_io::WriteGltf(TinyScene(), scene());
  data_io::WritePoses(poses(), TinyPoses());
  data_io::WriteParameters(params(), TinyParameters());
  WriteFile(sonar(), TinySonarJson());
}

std::string TinyWorld::SimulateArguments() const {
  return fmt::format("simulate --scene {} --sonar {} --params {} --poses {} --rays 96x200", Quoted(scene()),
                     Quoted(sonar()), Quoted(params()), Quoted(poses()));
}

std::filesystem::path TinyWorld::WriteSimulated(const std::string& name, bool noise, bool expected) const {
  commands::SimulateCommandOptions options;
  options.common = {.json = false, .quiet = true};
  options.scene = scene();
  options.sonar = sonar().string();
  options.params = params();
  options.poses = poses();
  options.out = dir_ / name;
  options.simulate.rays.sampling = sim::Sampling::kBeams;
  options.simulate.rays.rays = RayGridSize{96, 200};
  options.simulate.noise = noise;
  options.simulate.expected = expected;
  options.simulate.bits = 12;
  ::testing::internal::CaptureStdout();
  const cli::ExitStatus status = commands::RunSimulate(options);
  ::testing::internal::GetCapturedStdout();
  EXPECT_EQ(status, cli::ExitStatus::kDone);
  return options.out;
}

nlohmann::json ReadJsonFile(const std::filesystem::path& file) {
  return nlohmann::json::parse(ReadFile(file));
}

bool IsOneSentence(const std::string& text) {
  return text.starts_with("sonarcal: ") && std::count(text.begin(), text.end(), '\n') == 1;
}

}  // namespace sonarcal::testing
