#include "data_io/parameters/camera_io.h"

#include <cmath>
#include <vector>

#include "core/types/error.h"
#include "core/types/printable.h"
#include "core/types/units.h"
#include "data_io/files/yaml_reader.h"
#include "data_io/images/image_header.h"
#include "data_io/json/json_fields.h"
#include "data_io/json/json_reader.h"

namespace sonarcal::data_io {
namespace {

int Size(const YamlReader& yaml) {
  const double number = yaml.Number();
  if (!(number >= 1.0 && number <= 65535.0) || number != std::floor(number))
    yaml.Fail(fmt::format("is {:g}, expected a whole number from 1 to 65535", number));
  return static_cast<int>(number);
}

void ReadCameraMatrix(const YamlReader& data, Camera& camera) {
  const std::vector<double> m = data.Numbers();
  if (m.size() != 9) data.Fail(fmt::format("has {} numbers, expected 9", m.size()));
  const auto in_range = [](double focal_px) { return focal_px > 0.0 && focal_px < 1e6; };
  if (!in_range(m[0]) || !in_range(m[4]))
    data.Fail(fmt::format("has focal lengths {:g} and {:g}, expected pixels > 0 and < 1e6", m[0], m[4]));
  if (m[1] != 0.0 || m[3] != 0.0 || m[6] != 0.0 || m[7] != 0.0 || m[8] != 1.0)
    data.Fail("is not fx 0 cx, 0 fy cy, 0 0 1: skewed axes are not modelled");
  const auto inside = [](double centre_px, int size_px) {
    return centre_px > -size_px && centre_px < 2.0 * size_px;
  };
  if (!inside(m[2], camera.cols) || !inside(m[5], camera.rows)) {
    data.Fail(fmt::format("has the principal point {:g}, {:g}, far outside an image of {} x {} pixels", m[2],
                          m[5], camera.cols, camera.rows));
  }
  camera.fx_px = m[0];
  camera.fy_px = m[4];
  camera.cx_px = m[2];
  camera.cy_px = m[5];
}

void ReadDistortion(const YamlReader& yaml, Camera& camera) {
  for (const char* key : {"distortion_model", "camera_model"}) {
    const auto model = yaml.Find(key);
    if (!model) continue;
    const std::string name = model->String();
    if (name != "plumb_bob" && name != "rational_polynomial" && name != "pinhole")
      model->Fail(fmt::format("is '{}', expected plumb_bob or rational_polynomial", Printable(name)));
  }
  if (const auto fisheye = yaml.Find("fisheye_model")) {
    if (fisheye->Number() != 0.0) fisheye->Fail("is set: fisheye lenses are not modelled");
  }
  const auto coefficients = yaml.Find("distortion_coefficients");
  if (!coefficients) return;
  const YamlReader data = coefficients->At("data");
  const std::vector<double> k = data.Numbers();
  if (!k.empty() && k.size() != 4 && k.size() != 5 && k.size() != 8 && k.size() != 12 && k.size() != 14)
    data.Fail(fmt::format("has {} numbers, expected 4, 5, 8 or 12", k.size()));
  for (std::size_t i = 0; i < k.size(); ++i) {
    if (i >= camera.distortion.size()) {
      if (k[i] != 0.0) data.Fail("has a tilted sensor (tau_x, tau_y), which is not modelled");
    } else {
      if (!(std::abs(k[i]) < 1e4)) data.Fail(fmt::format("has {:g}, expected less than 1e4", k[i]));
      camera.distortion[i] = k[i];
    }
  }
}

Camera CameraOf(const YamlReader& yaml) {
  Camera camera{.cols = Size(yaml.At("image_width")), .rows = Size(yaml.At("image_height"))};
  if (std::int64_t{camera.cols} * camera.rows > kMaxImagePixels) {
    throw DataError("{}: images of {} x {} pixels, expected at most {}", yaml.file(), camera.cols,
                    camera.rows, kMaxImagePixels);
  }
  ReadCameraMatrix(yaml.At("camera_matrix").At("data"), camera);
  ReadDistortion(yaml, camera);
  return camera;
}

}  // namespace

Camera CameraFromText(std::string_view text, const std::string& file) {
  return CameraOf(YamlReader::FromText(text, file));
}

Camera ReadCamera(const std::filesystem::path& file) {
  return CameraOf(YamlReader::FromFile(file));
}

FlatPort ReadFlatPort(const std::filesystem::path& file) {
  const JsonReader json = JsonReader::FromFile(file);
  json.CheckFormat("sonar-port/1");
  const NumberRange length = NumberRange::Between(0.0, 10.0);
  const NumberRange index = NumberRange::Between(1.0, 3.0);
  FlatPort port{.distance_m = json.At("distance_m").Number(length),
                .thickness_m = json.At("thickness_m").Number(length)};
  json.Update("glass_index", port.glass_index, index);
  json.Update("water_index", port.water_index, index);
  if (const auto normal = json.Find("normal")) {
    const std::vector<double> n = normal->Numbers(NumberRange::Between(-1e3, 1e3));
    if (n.size() != 3) normal->Fail(fmt::format("has {} numbers, expected 3", n.size()));
    port.normal = {n[0], n[1], n[2]};
    const double length_1 = port.normal.norm();
    if (!(port.normal.z() > 0.1 * length_1))
      normal->Fail("points sideways or backwards, expected forward of the camera");
    port.normal /= length_1;
  }
  json.Finish();
  return port;
}

CameraMount ReadCameraMount(const std::filesystem::path& file) {
  const JsonReader json = JsonReader::FromFile(file);
  json.CheckFormat("sonar-mount/1");
  CameraMount mount{.camera_from_sonar = ReadPose(json.At("camera_from_sonar"))};
  if (const auto sigma = json.Find("sigma")) {
    mount.sigma_position_m = sigma->At("position_m").Number(NumberRange::Between(0.0, 10.0));
    mount.sigma_angle_rad = RadFromDeg(sigma->At("angle_deg").Number(NumberRange::Between(0.0, 90.0)));
  }
  json.Finish();
  return mount;
}

}  // namespace sonarcal::data_io
