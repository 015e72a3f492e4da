#include "apps/view/view_mesh.h"

#include <Eigen/Geometry>
#include <bit>
#include <cstdint>
#include <cstring>

#include <nlohmann/json.hpp>

namespace sonarcal::view {
namespace {

using Json = nlohmann::ordered_json;

static_assert(std::endian::native == std::endian::little, "the page reads little-endian numbers");

template <typename T>
void Append(const T& value, std::string& bytes) {
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  bytes.append(raw, sizeof(T));
}

}  // namespace

std::string Framed(const std::string& json, const std::string& data) {
  const std::size_t padded = (json.size() + 3) / 4 * 4;
  std::string bytes;
  bytes.reserve(4 + padded + data.size());
  Append(static_cast<std::uint32_t>(padded), bytes);
  bytes += json;
  bytes.append(padded - json.size(), ' ');
  return bytes + data;
}

std::string MeshFrame(const Scene& scene, std::size_t most) {
  const std::size_t step = (scene.triangles.size() + most - 1) / std::max<std::size_t>(1, most);
  std::string triangles;
  std::string materials;
  std::size_t shown = 0;
  for (std::size_t i = 0; i < scene.triangles.size(); i += std::max<std::size_t>(1, step)) {
    for (const int index : scene.triangles[i]) Append(static_cast<std::uint32_t>(index), triangles);
    Append(scene.triangle_material[i], materials);
    ++shown;
  }
  std::string data;
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& vertex_m : scene.vertices_m) {
    for (const float coordinate_m : vertex_m) Append(coordinate_m, data);
    box.extend(vertex_m);
  }
  const auto corner = [](const Eigen::Vector3f& at) { return Json::array({at.x(), at.y(), at.z()}); };
  const Json json = {{"vertices", scene.vertices_m.size()},
                     {"triangles", shown},
                     {"triangles_in_scene", scene.triangles.size()},
                     {"material_names", scene.material_names},
                     {"lowest_m", box.isEmpty() ? Json(nullptr) : corner(box.min())},
                     {"highest_m", box.isEmpty() ? Json(nullptr) : corner(box.max())}};
  return Framed(json.dump(-1, ' ', false, Json::error_handler_t::replace), data + triangles + materials);
}

}  // namespace sonarcal::view
