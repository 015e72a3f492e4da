#include "apps/export/scene_parts.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <set>

namespace sonarcal::exporting {
namespace {

std::string PlainName(const std::string& name) {
  std::string plain = name;
  for (char& letter : plain) {
    if (std::isalnum(static_cast<unsigned char>(letter)) == 0 && letter != '-') letter = '_';
  }
  return plain.empty() ? "part" : plain;
}

// Triangles of one material, with the vertices that they use.
std::string ObjText(const Scene& scene, std::size_t material) {
  std::string vertices;
  std::string normals;
  std::string faces;
  std::vector<int> numbers(scene.vertices_m.size(), 0);  // in the file, from 1; 0: not yet used
  int vertex_count = 0;
  int normal_count = 0;
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    if (scene.triangle_material[i] != material) continue;
    std::array<Eigen::Vector3f, 3> corners;
    for (int k = 0; k < 3; ++k) {
      const int index = scene.triangles[i][k];
      corners[k] = scene.vertices_m[index];
      if (numbers[index] != 0) continue;
      numbers[index] = ++vertex_count;
      fmt::format_to(std::back_inserter(vertices), "v {:.9g} {:.9g} {:.9g}\n", corners[k].x(), corners[k].y(),
                     corners[k].z());
    }
    const Eigen::Vector3f normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    if (!(normal.norm() > 0.0F)) continue;  // without area
    const Eigen::Vector3f unit = normal.normalized();
    ++normal_count;
    fmt::format_to(std::back_inserter(normals), "vn {:.6g} {:.6g} {:.6g}\n", unit.x(), unit.y(), unit.z());
    fmt::format_to(std::back_inserter(faces), "f {0}//{3} {1}//{3} {2}//{3}\n",
                   numbers[scene.triangles[i][0]], numbers[scene.triangles[i][1]],
                   numbers[scene.triangles[i][2]], normal_count);
  }
  if (faces.empty()) return "";
  return "# Written by sonarcal export: metres, Z up\n" + vertices + normals + faces;
}

}  // namespace

std::vector<ScenePart> ScenePartsOf(const ExportSource& source) {
  std::vector<ScenePart> parts;
  if (!source.scene) return parts;
  std::set<std::string> names;
  for (std::size_t material = 0; material < source.scene->material_names.size(); ++material) {
    std::string obj = ObjText(*source.scene, material);
    if (obj.empty()) continue;
    std::string name = PlainName(source.scene->material_names[material]);
    if (!names.insert(name).second) {
      name += fmt::format("_{}", material);
      names.insert(name);
    }
    parts.push_back({source.scene->material_names[material], name, {fmt::format("_{}.obj", name), obj}});
  }
  return parts;
}

Pose SonarPoseOf(const ExportSource& source) {
  return source.world_from_sonar.value_or(Pose{});
}

Eigen::Vector3d RollPitchYaw(const Eigen::Matrix3d& rotation) {
  // The third row is (-sin p, cos p sin r, cos p cos r), the first column (cos p cos y, cos p sin y, -sin p).
  const double sin_pitch = std::clamp(-rotation(2, 0), -1.0, 1.0);
  const double pitch_rad = std::asin(sin_pitch);
  constexpr double kVertical = 1.0 - 1e-12;
  if (std::abs(sin_pitch) > kVertical) {
    // Roll and yaw turn about the same axis: yaw is set to 0.
    return {std::atan2(-rotation(1, 2), rotation(1, 1)), pitch_rad, 0.0};
  }
  return {std::atan2(rotation(2, 1), rotation(2, 2)), pitch_rad, std::atan2(rotation(1, 0), rotation(0, 0))};
}

std::string VectorText(const Eigen::Vector3d& vector) {
  const auto plain = [](double value) { return std::abs(value) < 1e-12 ? 0.0 : value; };
  return fmt::format("{:.12g} {:.12g} {:.12g}", plain(vector.x()), plain(vector.y()), plain(vector.z()));
}

}  // namespace sonarcal::exporting
