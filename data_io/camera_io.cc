#include "data_io/camera_io.h"

#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <vector>

#include "data_io/file_bytes.h"
#include "data_io/image_header.h"
#include "data_io/json_fields.h"
#include "data_io/json_reader.h"
#include "data_io/printable.h"
#include "data_io/types/error.h"
#include "data_io/types/units.h"

namespace sonarcal {
namespace {

constexpr std::size_t kMostBytes = 1 << 20;

std::string_view Trimmed(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r\n";
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

struct Value {
  int line = 0;
  std::string text;
};

// "key" or "block.key" -> its text, which for a list is all of "[...]", over lines too.
class FlatYaml {
 public:
  FlatYaml(std::string_view text, const std::string& file) : file_(file) {
    std::string block;
    Value* open_list = nullptr;
    for (int line = 1; !text.empty(); ++line) {
      const std::size_t end = text.find('\n');
      Line(text.substr(0, end), line, block, open_list);
      text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    }
    if (open_list != nullptr) Fail(open_list->line, "a list '[' without its ']'");
  }

  const Value* Find(const std::string& key) const {
    const auto found = values_.find(key);
    return found == values_.end() ? nullptr : &found->second;
  }

  const Value& At(const std::string& key) const {
    const Value* value = Find(key);
    if (value == nullptr)
      throw DataError("{}: no '{}', expected a camera calibration in OpenCV's YAML", file_, key);
    return *value;
  }

  double Number(const Value& value, const std::string& key, std::string_view text) const {
    double number = 0.0;
    if (!text.empty() && text.front() == '+') text.remove_prefix(1);
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(number)) {
      Fail(value.line, fmt::format("{} has '{}', expected a finite number", key, Printable(text)));
    }
    return number;
  }

  std::vector<double> List(const std::string& key) const {
    const Value& value = At(key);
    std::string_view text = value.text;
    if (text.size() < 2 || text.front() != '[' || text.back() != ']')
      Fail(value.line, fmt::format("{} is '{}', expected a list of numbers in [ ]", key, Printable(text)));
    text = Trimmed(text.substr(1, text.size() - 2));
    std::vector<double> numbers;
    while (!text.empty()) {
      const std::size_t comma = text.find(',');
      numbers.push_back(Number(value, key, Trimmed(text.substr(0, comma))));
      text.remove_prefix(comma == std::string_view::npos ? text.size() : comma + 1);
    }
    return numbers;
  }

  [[noreturn]] void Fail(int line, const std::string& what) const {
    throw DataError("{}:{}: {}", file_, line, what);
  }

 private:
  void Line(std::string_view line, int number, std::string& block, Value*& open_list) {
    if (open_list != nullptr) {
      open_list->text += ' ';
      open_list->text += Trimmed(line);
      if (open_list->text.back() == ']') open_list = nullptr;
      return;
    }
    const std::string_view text = Trimmed(line);
    if (text.empty() || text.front() == '%' || text.front() == '#' || text == "---" || text == "...") return;
    if (text.front() == '<')
      Fail(number, "XML, expected YAML (cv::FileStorage with a name in .yaml or .yml)");
    const std::size_t colon = text.find(':');
    // What follows another program's key (a list of images, say) is none of ours.
    if (colon == std::string_view::npos) return;
    const bool is_inner = line.front() == ' ' || line.front() == '\t';
    std::string key(Trimmed(text.substr(0, colon)));
    std::string_view rest = Trimmed(text.substr(colon + 1));
    if (rest.starts_with("!!opencv-matrix")) rest = {};
    if (!is_inner) block = key;
    if (is_inner) key = block + "." + key;
    const auto [place, is_new] = values_.try_emplace(key, Value{number, std::string(rest)});
    if (!is_new)
      Fail(number,
           fmt::format("key '{}' for the second time, first in line {}", Printable(key), place->second.line));
    if (rest.starts_with('[') && !rest.ends_with(']')) open_list = &place->second;
  }

  std::string file_;
  std::map<std::string, Value> values_;
};

int Size(const FlatYaml& yaml, const std::string& key) {
  const Value& value = yaml.At(key);
  const double number = yaml.Number(value, key, value.text);
  if (!(number >= 1.0 && number <= 65535.0) || number != std::floor(number))
    yaml.Fail(value.line, fmt::format("{} is {:g}, expected a whole number from 1 to 65535", key, number));
  return static_cast<int>(number);
}

void ReadCameraMatrix(const FlatYaml& yaml, Camera& camera) {
  constexpr const char* kKey = "camera_matrix.data";
  const std::vector<double> m = yaml.List(kKey);
  const int line = yaml.At(kKey).line;
  if (m.size() != 9) yaml.Fail(line, fmt::format("{} has {} numbers, expected 9", kKey, m.size()));
  const auto in_range = [](double focal_px) { return focal_px > 0.0 && focal_px < 1e6; };
  if (!in_range(m[0]) || !in_range(m[4]))
    yaml.Fail(line,
              fmt::format("focal lengths are {:g} and {:g}, expected pixels > 0 and < 1e6", m[0], m[4]));
  if (m[1] != 0.0 || m[3] != 0.0 || m[6] != 0.0 || m[7] != 0.0 || m[8] != 1.0)
    yaml.Fail(line, "camera_matrix is not fx 0 cx, 0 fy cy, 0 0 1: skewed axes are not modelled");
  const auto inside = [](double centre_px, int size_px) {
    return centre_px > -size_px && centre_px < 2.0 * size_px;
  };
  if (!inside(m[2], camera.cols) || !inside(m[5], camera.rows)) {
    yaml.Fail(line, fmt::format("principal point {:g}, {:g} is far outside an image of {} x {} pixels", m[2],
                                m[5], camera.cols, camera.rows));
  }
  camera.fx_px = m[0];
  camera.fy_px = m[4];
  camera.cx_px = m[2];
  camera.cy_px = m[5];
}

void ReadDistortion(const FlatYaml& yaml, Camera& camera) {
  for (const char* key : {"distortion_model", "camera_model"}) {
    const Value* model = yaml.Find(key);
    if (model == nullptr) continue;
    if (model->text != "plumb_bob" && model->text != "rational_polynomial" && model->text != "pinhole") {
      yaml.Fail(model->line, fmt::format("{} is '{}', expected plumb_bob or rational_polynomial", key,
                                         Printable(model->text)));
    }
  }
  if (const Value* fisheye = yaml.Find("fisheye_model")) {
    if (yaml.Number(*fisheye, "fisheye_model", fisheye->text) != 0.0)
      yaml.Fail(fisheye->line, "fisheye_model is set: fisheye lenses are not modelled");
  }
  if (yaml.Find("distortion_coefficients") == nullptr) return;
  constexpr const char* kKey = "distortion_coefficients.data";
  const std::vector<double> k = yaml.List(kKey);
  const int line = yaml.At(kKey).line;
  if (k.size() != 0 && k.size() != 4 && k.size() != 5 && k.size() != 8 && k.size() != 12 && k.size() != 14)
    yaml.Fail(line, fmt::format("{} has {} numbers, expected 4, 5, 8 or 12", kKey, k.size()));
  for (std::size_t i = 0; i < k.size(); ++i) {
    if (i >= camera.distortion.size()) {
      if (k[i] != 0.0) yaml.Fail(line, "a tilted sensor (tau_x, tau_y) is not modelled");
    } else {
      if (!(std::abs(k[i]) < 1e4))
        yaml.Fail(line, fmt::format("{} has {:g}, expected less than 1e4", kKey, k[i]));
      camera.distortion[i] = k[i];
    }
  }
}

}  // namespace

Camera CameraFromText(std::string_view text, const std::string& file) {
  const FlatYaml yaml(text, file);
  Camera camera{.cols = Size(yaml, "image_width"), .rows = Size(yaml, "image_height")};
  if (std::int64_t{camera.cols} * camera.rows > kMaxImagePixels) {
    throw DataError("{}: images of {} x {} pixels, expected at most {}", file, camera.cols, camera.rows,
                    kMaxImagePixels);
  }
  ReadCameraMatrix(yaml, camera);
  ReadDistortion(yaml, camera);
  return camera;
}

Camera ReadCamera(const std::filesystem::path& file) {
  return CameraFromText(ReadFileBytes(file, kMostBytes), file.string());
}

FlatPort ReadFlatPort(const std::filesystem::path& file) {
  const JsonReader json = JsonReader::FromFile(file);
  json.At("format").Word(JsonWords<bool, 1>{{{"sonar-port/1", true}}});
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
      normal->Fail("points aside or back, expected ahead of the camera");
    port.normal /= length_1;
  }
  json.Finish();
  return port;
}

CameraMount ReadCameraMount(const std::filesystem::path& file) {
  const JsonReader json = JsonReader::FromFile(file);
  json.At("format").Word(JsonWords<bool, 1>{{{"sonar-mount/1", true}}});
  CameraMount mount{.camera_from_sonar = ReadPose(json.At("camera_from_sonar"))};
  if (const auto sigma = json.Find("sigma")) {
    mount.sigma_position_m = sigma->At("position_m").Number(NumberRange::Between(0.0, 10.0));
    mount.sigma_angle_rad = RadFromDeg(sigma->At("angle_deg").Number(NumberRange::Between(0.0, 90.0)));
  }
  json.Finish();
  return mount;
}

}  // namespace sonarcal
