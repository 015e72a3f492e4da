#include "data_io/bag_writers/ros2_definitions.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <sstream>
#include <string_view>
#include <vector>

#include "core/types/error.h"

namespace sonarcal::data_io {
namespace {

// Fields of a message, "TYPE NAME" each. Messages of other packages and of the same one are named in full.
struct Definition {
  std::string_view type;
  std::string_view fields;
};

constexpr Definition kDefinitions[] = {
    {"builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n"},
    {"builtin_interfaces/Duration", "int32 sec\nuint32 nanosec\n"},
    {"std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n"},
    {"std_msgs/ColorRGBA", "float32 r\nfloat32 g\nfloat32 b\nfloat32 a\n"},
    {"geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n"},
    {"geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z\n"},
    {"geometry_msgs/Quaternion", "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n"},
    {"geometry_msgs/Pose", "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n"},
    {"geometry_msgs/PoseStamped", "std_msgs/Header header\ngeometry_msgs/Pose pose\n"},
    {"geometry_msgs/Transform", "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n"},
    {"geometry_msgs/TransformStamped",
     "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n"},
    {"tf2_msgs/TFMessage", "geometry_msgs/TransformStamped[] transforms\n"},
    {"sensor_msgs/Image",
     "std_msgs/Header header\nuint32 height\nuint32 width\nstring encoding\nuint8 is_bigendian\nuint32 step\n"
     "uint8[] data\n"},
    {"sensor_msgs/CompressedImage", "std_msgs/Header header\nstring format\nuint8[] data\n"},
    {"visualization_msgs/UVCoordinate", "float32 u\nfloat32 v\n"},
    {"visualization_msgs/MeshFile", "string filename\nuint8[] data\n"},
    {"visualization_msgs/Marker",
     "std_msgs/Header header\nstring ns\nint32 id\nint32 type\nint32 action\ngeometry_msgs/Pose pose\n"
     "geometry_msgs/Vector3 scale\nstd_msgs/ColorRGBA color\nbuiltin_interfaces/Duration lifetime\n"
     "bool frame_locked\ngeometry_msgs/Point[] points\nstd_msgs/ColorRGBA[] colors\n"
     "string texture_resource\nsensor_msgs/CompressedImage texture\n"
     "visualization_msgs/UVCoordinate[] uv_coordinates\nstring text\nstring mesh_resource\n"
     "visualization_msgs/MeshFile mesh_file\nbool mesh_use_embedded_materials\n"},
    {"visualization_msgs/MarkerArray", "visualization_msgs/Marker[] markers\n"},
    {"marine_interfaces/SonarInfo",
     "std_msgs/Header header\nstring sonar_model\nstring calibration_ref\n"
     "builtin_interfaces/Time calibration_time\nfloat32[] pulse_lengths\nfloat32[] bandwidths\n"
     "uint8[] tx_signal_types\nuint8 intensity_quantity\nuint8 intensity_scale\nuint8 intensity_reference\n"
     "float32 scale\nfloat32 offset\nuint8 tvg_model\nfloat32 tvg_absorption_db_per_km\n"
     "float32 source_level_db\nuint8 angular_normalization\nfloat32[] angular_response_angle_deg\n"
     "float32[] angular_response_db_rel_nadir\nuint8 angular_response_tl\n"
     "float32 angular_response_absorption_db_per_m\nfloat32[] beam_pattern_angle_deg\n"
     "float32[] beam_pattern_gain_db\n"},
    {"marine_acoustic_msgs/PingInfo",
     "float32 frequency\nfloat32 sound_speed\nfloat32[] tx_beamwidths\nfloat32[] rx_beamwidths\n"},
    {"marine_acoustic_msgs/SonarImageData",
     "bool is_bigendian\nuint32 dtype\nuint32 beam_count\nuint8[] data\n"},
    {"marine_acoustic_msgs/ProjectedSonarImage",
     "std_msgs/Header header\nmarine_acoustic_msgs/PingInfo ping_info\n"
     "geometry_msgs/Vector3[] beam_directions\nfloat32[] ranges\nmarine_acoustic_msgs/SonarImageData "
     "image\n"},
};

std::string FieldsOf(std::string_view type) {
  const auto* const found = std::ranges::find(kDefinitions, type, &Definition::type);
  SONARCAL_CHECK(found != std::end(kDefinitions), "no definition of {}", type);
  return std::string(found->fields);
}

// Types that the fields name, in their order.
std::vector<std::string> NestedTypes(const std::string& fields) {
  std::vector<std::string> types;
  std::istringstream lines(fields);
  for (std::string line; std::getline(lines, line);) {
    std::string type = line.substr(0, line.find(' '));
    type = type.substr(0, type.find('['));
    if (type.find('/') != std::string::npos) types.push_back(type);
  }
  return types;
}

}  // namespace

std::string Ros2Definition(const std::string& type) {
  const std::string line(80, '=');
  std::string text = FieldsOf(type);
  std::vector<std::string> types = NestedTypes(text);
  for (std::size_t i = 0; i < types.size(); ++i) {
    if (std::find(types.begin(), types.begin() + static_cast<std::ptrdiff_t>(i), types[i]) !=
        types.begin() + static_cast<std::ptrdiff_t>(i)) {
      continue;
    }
    const std::string fields = FieldsOf(types[i]);
    text += fmt::format("{}\nMSG: {}\n{}", line, types[i], fields);
    for (const std::string& nested : NestedTypes(fields)) types.push_back(nested);
  }
  return text;
}

}  // namespace sonarcal::data_io
