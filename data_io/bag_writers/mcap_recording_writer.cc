#include "data_io/bag_writers/mcap_recording_writer.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <optional>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/types/error.h"
#include "data_io/bag_writers/message_builder.h"
#include "data_io/bag_writers/recording_messages.h"
#include "data_io/bag_writers/ros2_definitions.h"
#include "data_io/json/json_writer.h"
#include "data_io/mcap/mcap_writer.h"
#include "data_io/pictures/fan_pictures.h"
#include "data_io/recordings/frame_storage.h"
#include "data_io/recordings/recording_json.h"
#include "data_io/ros/mcap_bag.h"

namespace sonarcal::data_io {
namespace {

constexpr MessageEncoding kCdr = MessageEncoding::kCdr;
constexpr double kMaxS = 2147483647.0;  // largest time of ROS 2

// Shapes of markers (visualization_msgs/Marker).
enum class Shape : std::int32_t { kLines = 5, kTriangles = 11 };

struct Colour {
  float red = 1.0F;
  float green = 1.0F;
  float blue = 1.0F;
};

// Colours that most people can distinguish (Okabe and Ito).
constexpr std::array<Colour, 7> kPalette = {{{0.75F, 0.75F, 0.70F},
                                             {0.90F, 0.62F, 0.00F},
                                             {0.34F, 0.71F, 0.91F},
                                             {0.00F, 0.62F, 0.45F},
                                             {0.94F, 0.89F, 0.26F},
                                             {0.84F, 0.37F, 0.00F},
                                             {0.80F, 0.47F, 0.65F}}};

struct Marker {
  std::string frame;
  std::string name;
  int id = 0;
  Shape shape = Shape::kTriangles;
  double size_m = 1.0;  // width of lines; 1 for triangles
  std::vector<Eigen::Vector3d> points_m;
  std::vector<Colour> colours;  // one per point, or a single one
};

void Add(MessageBuilder& message, const Colour& colour) {
  message.Number(colour.red).Number(colour.green).Number(colour.blue).Number(1.0F);
}

void Add(MessageBuilder& message, const Marker& marker) {
  const bool is_one_colour = marker.colours.size() == 1;
  message.Header(0, 0, marker.frame).Text(marker.name).Number(std::int32_t{marker.id});
  message.Number(static_cast<std::int32_t>(marker.shape)).Number(std::int32_t{0});       // add
  for (const double value : {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0}) message.Number(value);  // pose
  for (int axis = 0; axis < 3; ++axis) message.Number(marker.size_m);
  Add(message, is_one_colour ? marker.colours.front() : Colour{});
  message.Time(0).Number(std::uint8_t{1});  // lifetime without an end, moves with its frame
  message.Count(marker.points_m.size());
  for (const Eigen::Vector3d& point_m : marker.points_m) {
    for (const double value : point_m) message.Number(value);
  }
  message.Count(is_one_colour ? 0 : marker.colours.size());
  if (!is_one_colour) {
    for (const Colour& colour : marker.colours) Add(message, colour);
  }
  message.Text("").Header(0, 0, "").Text("").Count(0).Count(0);         // texture and its coordinates
  message.Text("").Text("").Text("").Count(0).Number(std::uint8_t{0});  // text and meshes
}

std::string MarkerArray(const std::vector<Marker>& markers) {
  MessageBuilder message(kCdr);
  message.Count(markers.size());
  for (const Marker& marker : markers) Add(message, marker);
  return message.Take();
}

// Brightness of a triangle under a light from above, so that its shape can be seen. Both sides are lit.
float Brightness(const Eigen::Vector3d& normal) {
  const Eigen::Vector3d light = Eigen::Vector3d(0.3, 0.5, 0.8).normalized();
  const double length = normal.norm();
  return static_cast<float>(0.4 + 0.6 * (length > 0.0 ? std::abs(normal.dot(light)) / length : 0.0));
}

std::vector<Marker> SceneMarkers(const Scene& scene) {
  if (scene.triangles.size() > kMaxMcapSceneTriangles) {
    throw DataError("the scene has {} triangles, expected at most {} for an MCAP file",
                    scene.triangles.size(), kMaxMcapSceneTriangles);
  }
  std::vector<Marker> markers;
  for (std::size_t material = 0; material < scene.material_names.size(); ++material) {
    markers.push_back({.frame = kWorldFrame,
                       .name = scene.material_names[material],
                       .id = static_cast<int>(material),
                       .points_m = {},
                       .colours = {}});
  }
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    const std::uint16_t material = scene.triangle_material[i];
    Marker& marker = markers.at(material);
    std::array<Eigen::Vector3d, 3> corners;
    for (int corner = 0; corner < 3; ++corner)
      corners[corner] = scene.vertices_m[scene.triangles[i][corner]].cast<double>();
    const float light = Brightness((corners[1] - corners[0]).cross(corners[2] - corners[0]));
    const Colour& colour = kPalette[material % kPalette.size()];
    for (const Eigen::Vector3d& corner : corners) {
      marker.points_m.push_back(corner);
      marker.colours.push_back({light * colour.red, light * colour.green, light * colour.blue});
    }
  }
  std::erase_if(markers, [](const Marker& marker) { return marker.points_m.empty(); });
  return markers;
}

// Outline of the fan at elevation 0: both arcs and both sides.
Marker FieldOfView(const PolarAxes& axes) {
  Marker marker{.frame = kSonarFrame,
                .name = "field of view",
                .shape = Shape::kLines,
                .size_m = 0.002 * axes.range_max_m,
                .points_m = {},
                .colours = {kPalette[1]}};
  const std::vector<double> edges_rad = axes.BeamEdgesRad();
  const auto point_m = [](double range_m, double azimuth_rad) {
    return Eigen::Vector3d(range_m * std::sin(azimuth_rad), range_m * std::cos(azimuth_rad), 0.0);
  };
  for (const double range_m : {axes.range_min_m, axes.range_max_m}) {
    for (std::size_t i = 0; i + 1 < edges_rad.size(); ++i) {
      marker.points_m.push_back(point_m(range_m, edges_rad[i]));
      marker.points_m.push_back(point_m(range_m, edges_rad[i + 1]));
    }
  }
  for (const double edge_rad : {edges_rad.front(), edges_rad.back()}) {
    marker.points_m.push_back(point_m(axes.range_min_m, edge_rad));
    marker.points_m.push_back(point_m(axes.range_max_m, edge_rad));
  }
  return marker;
}

std::string PictureMessage(int rows, int cols, SampleType type, const std::string& samples,
                           std::int64_t stamp_ns) {
  const char* encoding = type == SampleType::kByte    ? "mono8"
                         : type == SampleType::kShort ? "mono16"
                                                      : "32FC1";
  MessageBuilder message(kCdr);
  message.Header(0, stamp_ns, kSonarFrame);
  message.Number(static_cast<std::uint32_t>(rows)).Number(static_cast<std::uint32_t>(cols));
  message.Text(encoding).Number(std::uint8_t{0});
  message.Number(static_cast<std::uint32_t>(samples.size() / static_cast<std::size_t>(rows)));
  return message.Bytes(samples).Take();
}

std::string PolarPicture(const PolarImage& image, std::int64_t stamp_ns) {
  const SampleType type = SampleTypeOf(image.scale);
  std::string samples;
  for (int row = image.value.rows() - 1; row >= 0; --row) {
    for (const float value : image.value.row(row)) AppendSample(samples, type, value);
  }
  return PictureMessage(image.value.rows(), image.value.cols(), type, samples, stamp_ns);
}

std::string FanPicture(const Grid<std::uint8_t>& fan, std::int64_t stamp_ns) {
  const std::span<const std::uint8_t> values = fan.values();
  return PictureMessage(fan.rows(), fan.cols(), SampleType::kByte,
                        {reinterpret_cast<const char*>(values.data()), values.size()}, stamp_ns);
}

std::string TransformMessage(const Pose& world_from_sonar, std::int64_t stamp_ns) {
  MessageBuilder message(kCdr);
  message.Count(1).Header(0, stamp_ns, kWorldFrame).Text(kSonarFrame);
  for (const double value : world_from_sonar.position_m) message.Number(value);
  const Eigen::Quaterniond& q = world_from_sonar.rotation;
  message.Number(q.x()).Number(q.y()).Number(q.z()).Number(q.w());
  return message.Take();
}

// Channels of a file, made when their first message is written.
class Topics {
 public:
  explicit Topics(McapWriter& writer) : writer_(writer) {}

  // `type` is named as in ROS 1.
  void Write(const std::string& topic, const std::string& type, std::int64_t time_ns,
             std::string_view message) {
    auto known = channels_.find(topic);
    if (known == channels_.end()) {
      const std::size_t slash = type.find('/');
      const std::uint16_t id =
          writer_.AddChannel({.topic = topic,
                              .message_encoding = "cdr",
                              .schema_name = type.substr(0, slash) + "/msg" + type.substr(slash),
                              .schema_encoding = "ros2msg",
                              .schema = Ros2Definition(type)});
      known = channels_.emplace(topic, id).first;
    }
    writer_.Write(known->second, time_ns, message);
  }

 private:
  McapWriter& writer_;
  std::map<std::string, std::uint16_t> channels_;
};

void WriteFrame(const Frame& frame, const RecordingInfo& info, const FrameTimes& times,
                const FanPainter* painter, Topics& topics) {
  const auto [stamp_ns, logged_ns] = times;
  topics.Write(kImageTopic, "marine_acoustic_msgs/ProjectedSonarImage", logged_ns,
               ImageMessage(kCdr, frame, info.sonar, 0, stamp_ns));
  topics.Write("/sonar/polar", "sensor_msgs/Image", logged_ns, PolarPicture(frame.image, stamp_ns));
  if (painter != nullptr)
    topics.Write("/sonar/fan", "sensor_msgs/Image", logged_ns, FanPicture(painter->Paint(frame), stamp_ns));
  if (!frame.info.world_from_sonar) return;
  const Pose& pose = *frame.info.world_from_sonar;
  topics.Write(kPoseTopic, "geometry_msgs/PoseStamped", logged_ns, PoseMessage(kCdr, pose, 0, stamp_ns));
  // A transform without a time would hold for all times.
  topics.Write("/tf", "tf2_msgs/TFMessage", logged_ns, TransformMessage(pose, logged_ns));
}

// Writes SonarInfo with the first frame, if it changes, and again and again, so that each part of a split
// recording has one.
class SonarInfoWriter {
 public:
  SonarInfoWriter(const RecordingInfo& info, const std::optional<SonarCalibration>& calibration)
      : info_(info), calibration_(calibration) {}

  void Write(const FrameInfo& frame, std::int64_t logged_ns, Topics& topics) {
    constexpr std::int64_t kHeartbeatNs = 10 * kNsPerS;
    SonarInfo sonar = SonarInfoOf(info_, frame.settings, calibration_);
    sonar.stamp_ns = logged_ns;
    if (last_ && HasSameContent(sonar, *last_) && std::abs(logged_ns - last_->stamp_ns) < kHeartbeatNs)
      return;
    topics.Write(kSonarInfoTopic, kSonarInfoType, logged_ns, SonarInfoMessage(kCdr, sonar));
    last_ = std::move(sonar);
  }

 private:
  const RecordingInfo& info_;
  const std::optional<SonarCalibration>& calibration_;
  std::optional<SonarInfo> last_;
};

std::string RecordingText(const RecordingInfo& info) {
  return JsonText(RecordingJson({.info = info, .bits = MinBits(info.scale), .frames = {}}, "/"));
}

}  // namespace

void WriteMcapRecording(const RecordingSource& recording, const McapRecordingOptions& options,
                        const std::string& library, const std::filesystem::path& file,
                        const std::function<void(int frames_done)>& progress) {
  const RecordingInfo& info = recording.info();
  const std::vector<FrameTimes> times = FrameTimesOf(recording, kMaxS);
  std::optional<FanPainter> painter;
  if (info.scale.quantity == Quantity::kGrey)
    painter.emplace(info, FanOptions{.height_px = options.fan_height_px});
  McapWriter writer(file, "ros2", library);
  Topics topics(writer);
  SonarInfoWriter sonar_info(info, options.calibration);
  for (int i = 0; i < recording.frame_count(); ++i) {
    const Frame frame = recording.ReadFrame(i);
    CheckSameAsFirst(info, frame, i);
    const FrameTimes& at = times[static_cast<std::size_t>(i)];
    if (i == 0) {
      if (options.scene != nullptr) {
        topics.Write("/scene", "visualization_msgs/MarkerArray", at.logged_ns,
                     MarkerArray(SceneMarkers(*options.scene)));
      }
      if (info.sonar.axes.beam_count() > 1) {
        topics.Write("/sonar/field_of_view", "visualization_msgs/MarkerArray", at.logged_ns,
                     MarkerArray({FieldOfView(info.sonar.axes)}));
      }
    }
    sonar_info.Write(frame.info, at.logged_ns, topics);
    WriteFrame(frame, info, at, painter ? &*painter : nullptr, topics);
    if (progress) progress(i + 1);
  }
  writer.AddMetadata(kRecordingMetadata, {{kRecordingJsonKey, RecordingText(info)}});
  writer.Close();
}

}  // namespace sonarcal::data_io
