#include "tests/calib/small_tank.h"

#include "core/types/units.h"

namespace sonarcal::testing {
namespace {

void AddQuad(Scene& scene, const std::string& material, const Eigen::Vector3f& corner,
             const Eigen::Vector3f& u, const Eigen::Vector3f& v) {
  const int first = static_cast<int>(scene.vertices_m.size());
  scene.vertices_m.insert(scene.vertices_m.end(), {corner, corner + u, corner + u + v, corner + v});
  scene.triangles.insert(scene.triangles.end(),
                         {{first, first + 1, first + 2}, {first, first + 2, first + 3}});
  scene.triangle_material.insert(scene.triangle_material.end(), 2, scene.MaterialIndex(material));
}

}  // namespace

Scene SmallTank() {
  Scene scene;
  AddQuad(scene, "floor", {-5, -5, 0}, {10, 0, 0}, {0, 10, 0});
  const Eigen::Vector3f x(1, 0, 0);
  const Eigen::Vector3f y(0, 1, 0);
  const Eigen::Vector3f z(0, 0, 1);
  const Eigen::Vector3f corner(-0.5F, -0.5F, 0.0F);
  AddQuad(scene, "box", corner, x, z);
  AddQuad(scene, "box", corner + x, y, z);
  AddQuad(scene, "box", corner + x + y, -x, z);
  AddQuad(scene, "box", corner + y, -y, z);
  AddQuad(scene, "box", corner + z, x, y);
  return scene;
}

Scene SmallTankWithWall() {
  Scene scene = SmallTank();
  AddQuad(scene, "wall", {-3, 1.2F, 0}, {6, 0, 0}, {0, 0, 2});
  AddQuad(scene, "board", {-3, 60, -40}, {6, 0, 0}, {0, 0, 2});
  return scene;
}

SonarModel SmallSonar() {
  SonarModel sonar{.name = "small sonar",
                   .frequency_hz = 900e3,
                   .axes = {0.5, 4.5, 160, {}},
                   .azimuth_beam_width_deg = 1.0,
                   .elevation_beam_width_deg = 40.0,
                   .sound_speed_m_per_s = 1480.0};
  for (int beam = 0; beam < 48; ++beam)
    sonar.axes.beam_azimuth_rad.push_back(RadFromDeg((beam - 23.5) * 0.6));
  return sonar;
}

std::vector<Pose> SmallTankPoses() {
  std::vector<Pose> poses;
  const auto look = [&](double x_m, double y_m, double z_m, double yaw_deg, double pitch_deg) {
    poses.push_back(
        {RotationFromYawPitchRoll(RadFromDeg(yaw_deg), RadFromDeg(pitch_deg), 0.0), {x_m, y_m, z_m}});
  };
  look(0.0, -2.5, 1.2, 0.0, -25.0);
  look(1.4, -2.2, 1.5, 30.0, -40.0);
  look(-0.3, -1.2, 2.6, 0.0, -80.0);
  look(0.3, 2.4, 0.6, 180.0, -5.0);
  return poses;
}

ParameterSet SmallTankTruth() {
  ParameterSet truth;
  truth.source_level_db = 200.0;
  truth.display = {.db_min = 160.0, .db_max = 170.0};
  truth.materials["floor"].gsab = {.a = 90.0, .b_deg = 4.0, .c = 0.5, .d = 1.5, .e = 8.0, .f_deg = 14.0};
  truth.materials["box"].gsab = {.a = 40.0, .b_deg = 3.0, .c = 2.0, .d = 1.0, .e = 10.0, .f_deg = 12.0};
  truth.jitter = {.sigma_range_m = 0.03, .sigma_azimuth_deg = 0.7, .reference_range_m = 10.0};
  return truth;
}

ParameterSet SmallTankAcousticTruth() {
  ParameterSet truth = SmallTankTruth();
  truth.model = EchoModel::kAcoustic;
  for (auto& [name, material] : truth.materials) {
    for (double* amplitude : {&material.gsab.a, &material.gsab.c, &material.gsab.e}) *amplitude *= 1e-2;
  }
  truth.receiver.noise_db = 120.0;
  truth.display = {.db_min = 110.0, .db_max = 160.0};
  return truth;
}

sim::SimulationOptions SmallTankOptions() {
  sim::SimulationOptions options;
  options.bits = 12;
  options.fan = {.sampling = sim::Sampling::kBeams, .cols = 48 * 4, .rows = 400};
  options.water = {.temperature_c = 15.0, .salinity_ppt = 0.5, .ph = 7.0, .depth_m = 1.0};
  return options;
}

}  // namespace sonarcal::testing
