#include "data_io/parameters/marker_map_io.h"

#include <fmt/format.h>

#include <map>

#include <nlohmann/json.hpp>

#include "core/types/printable.h"
#include "core/types/units.h"
#include "data_io/json/json_fields.h"
#include "data_io/json/json_reader.h"
#include "data_io/json/json_writer.h"

namespace sonarcal::data_io {
namespace {

constexpr std::string_view kMarkersFormat = "sonar-markers/1";
constexpr std::size_t kMaxMarkers = 10'000;

Marker ReadMarker(const JsonReader& json, const MarkerDictionary& dictionary) {
  const JsonReader id = json.At("id");
  Marker marker{.id = static_cast<int>(id.Integer(0, 1'000'000)),
                .size_m = json.At("size_m").Number(NumberRange::Between(1e-3, 100.0)),
                .world_from_marker = ReadPose(json.At("world_from_marker"))};
  if (marker.id >= dictionary.ids) {
    id.Fail(fmt::format("is {}, expected 0 to {} as {} has", marker.id, dictionary.ids - 1, dictionary.name));
  }
  return marker;
}

}  // namespace

const std::vector<MarkerDictionary>& MarkerDictionaries() {
  static const std::vector<MarkerDictionary> kDictionaries = {
      {"DICT_4X4_50", 0, 6, 50},
      {"DICT_4X4_100", 1, 6, 100},
      {"DICT_4X4_250", 2, 6, 250},
      {"DICT_4X4_1000", 3, 6, 1000},
      {"DICT_5X5_50", 4, 7, 50},
      {"DICT_5X5_100", 5, 7, 100},
      {"DICT_5X5_250", 6, 7, 250},
      {"DICT_5X5_1000", 7, 7, 1000},
      {"DICT_6X6_50", 8, 8, 50},
      {"DICT_6X6_100", 9, 8, 100},
      {"DICT_6X6_250", 10, 8, 250},
      {"DICT_6X6_1000", 11, 8, 1000},
      {"DICT_7X7_50", 12, 9, 50},
      {"DICT_7X7_100", 13, 9, 100},
      {"DICT_7X7_250", 14, 9, 250},
      {"DICT_7X7_1000", 15, 9, 1000},
      {"DICT_ARUCO_ORIGINAL", 16, 7, 1024},
      {"DICT_APRILTAG_16h5", 17, 6, 30},
      {"DICT_APRILTAG_25h9", 18, 7, 35},
      {"DICT_APRILTAG_36h10", 19, 8, 2320},
      {"DICT_APRILTAG_36h11", 20, 8, 587},
  };
  return kDictionaries;
}

const MarkerDictionary* FindMarkerDictionary(std::string_view name) {
  for (const MarkerDictionary& dictionary : MarkerDictionaries()) {
    if (dictionary.name == name) return &dictionary;
  }
  return nullptr;
}

MarkerMap ReadMarkerMap(const std::filesystem::path& file) {
  const JsonReader json = JsonReader::FromFile(file);
  json.CheckFormat(kMarkersFormat);
  MarkerMap map;
  const JsonReader name = json.At("dictionary");
  map.dictionary = name.String();
  const MarkerDictionary* dictionary = FindMarkerDictionary(map.dictionary);
  if (dictionary == nullptr) {
    name.Fail(fmt::format("is '{}', expected one of OpenCV's, such as DICT_4X4_50 or DICT_APRILTAG_36h11",
                          Printable(map.dictionary)));
  }
  const JsonReader list = json.At("markers");
  const std::vector<JsonReader> items = list.Items();
  if (items.empty() || items.size() > kMaxMarkers)
    list.Fail(fmt::format("has {} markers, expected 1 to {}", items.size(), kMaxMarkers));
  std::map<int, int> line_of_id;
  for (const JsonReader& item : items) {
    map.markers.push_back(ReadMarker(item, *dictionary));
    const auto [first, is_new] = line_of_id.try_emplace(map.markers.back().id, item.line());
    if (!is_new) {
      item.At("id").Fail(fmt::format("is {}, as in line {}: expected each marker once", map.markers.back().id,
                                     first->second));
    }
  }
  if (const auto sigma = json.Find("sigma")) {
    map.sigma = MarkerMapSigma{
        .position_m = sigma->At("position_m").Number(NumberRange::AboveUpTo(0.0, 10.0)),
        .angle_rad = RadFromDeg(sigma->At("angle_deg").Number(NumberRange::AboveUpTo(0.0, 90.0)))};
  }
  json.Finish();
  return map;
}

void WriteMarkerMap(const std::filesystem::path& file, const MarkerMap& map) {
  nlohmann::ordered_json markers = nlohmann::ordered_json::array();
  for (const Marker& marker : map.markers) {
    markers.push_back({{"id", marker.id},
                       {"size_m", marker.size_m},
                       {"world_from_marker", PoseJson(marker.world_from_marker)}});
  }
  nlohmann::ordered_json json = {
      {"format", kMarkersFormat}, {"dictionary", map.dictionary}, {"markers", markers}};
  if (map.sigma) {
    json["sigma"] = {{"position_m", map.sigma->position_m}, {"angle_deg", DegFromRad(map.sigma->angle_rad)}};
  }
  WriteJson(file, json);
}

}  // namespace sonarcal::data_io
