#include "data_io/recordings/recording_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include <nlohmann/json.hpp>

#include "core/types/printable.h"
#include "core/types/units.h"
#include "data_io/images/image_header.h"
#include "data_io/json/json_fields.h"
#include "data_io/json/json_reader.h"
#include "data_io/json/json_writer.h"
#include "data_io/json/recording_limits.h"
#include "data_io/recordings/recording_io.h"

namespace sonarcal::data_io {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::string_view kRecordingFormat = "sonar-recording/1";
constexpr const char* kTruthFile = "truth.json";
// Words of the file. Messages use ToString, which returns "grey level".
constexpr Words<Quantity, 4> kQuantities = {{{"grey", Quantity::kGrey},
                                             {"decibel", Quantity::kDecibel},
                                             {"power", Quantity::kPower},
                                             {"depth", Quantity::kDepth}}};

// Adds a note once, however often a recording is converted.
void AddNote(RecordingInfo& info, std::string note) {
  if (std::find(info.notes.begin(), info.notes.end(), note) == info.notes.end()) {
    info.notes.push_back(std::move(note));
  }
}

// Number that a simulation needs but a display does not. If it is absent: 0, and a note.
double NumberOrUnknown(const JsonReader& json, const char* key, const NumberRange& range,
                       RecordingInfo& info) {
  const auto number = json.FindNumber(key, range);
  if (!number) AddNote(info, fmt::format("{} has no '{}.{}': unknown", kRecordingFile, json.path(), key));
  return number.value_or(0.0);
}

std::vector<double> ReadBeamAzimuths(const JsonReader& json) {
  std::vector<double> azimuth_rad = json.Numbers(NumberRange::Between(-180.0, 180.0));
  if (azimuth_rad.size() < 2) json.Fail(fmt::format("has {} beams, expected at least 2", azimuth_rad.size()));
  for (std::size_t beam = 0; beam < azimuth_rad.size(); ++beam) {
    azimuth_rad[beam] = RadFromDeg(azimuth_rad[beam]);
    if (beam > 0 && !(azimuth_rad[beam] > azimuth_rad[beam - 1])) {
      json.Items()[beam].Fail(fmt::format("is {:.6g}, expected more than the beam to its left, {:.6g}",
                                          DegFromRad(azimuth_rad[beam]), DegFromRad(azimuth_rad[beam - 1])));
    }
  }
  return azimuth_rad;
}

PolarAxes ReadAxes(const JsonReader& json) {
  PolarAxes axes;
  axes.range_min_m = json.At("range_min_m").Number(kSonarRangeM);
  const JsonReader range_max = json.At("range_max_m");
  axes.range_max_m = range_max.Number(kSonarRangeM);
  if (!(axes.range_max_m > axes.range_min_m)) {
    range_max.Fail(
        fmt::format("is {}, expected more than range_min_m, {}", axes.range_max_m, axes.range_min_m));
  }
  axes.beam_azimuth_rad = ReadBeamAzimuths(json.At("beam_azimuth_deg"));
  axes.range_bins = static_cast<int>(
      json.At("range_bins").Integer(1, kMaxImagePixels / static_cast<std::int64_t>(axes.beam_count())));
  return axes;
}

// One number per beam, or nothing.
std::vector<double> FindPerBeam(const JsonReader& json, const char* key, int beams) {
  const auto found = json.Find(key);
  if (!found) return {};
  std::vector<double> numbers = found->Numbers();
  if (static_cast<int>(numbers.size()) != beams) {
    found->Fail(fmt::format("has {} numbers, expected one per beam, {}", numbers.size(), beams));
  }
  return numbers;
}

void ReadSonar(const JsonReader& json, RecordingInfo& info) {
  SonarModel& sonar = info.sonar;
  if (const auto name = json.Find("name")) sonar.name = name->String();
  sonar.frequency_hz = NumberOrUnknown(json, "frequency_hz", kSonarFrequencyHz, info);
  sonar.sound_speed_m_per_s = NumberOrUnknown(json, "sound_speed_m_per_s", kSonarSoundSpeedMPerS, info);
  sonar.azimuth_beam_width_deg = NumberOrUnknown(json, "azimuth_beam_width_deg", kSonarBeamWidthDeg, info);
  sonar.elevation_beam_width_deg =
      NumberOrUnknown(json, "elevation_beam_width_deg", kSonarBeamWidthDeg, info);
  if (const auto word = json.Find("beam_forming")) sonar.beam_forming = word->Word<BeamForming>();
  sonar.axes = ReadAxes(json);
  if (const auto psf = json.Find("azimuth_psf")) info.azimuth_psf = psf->Numbers();
  info.beam_taper = FindPerBeam(json, "beam_taper", sonar.axes.beam_count());
  if (const auto pings = json.Find("pings")) sonar.pings = ReadPings(*pings, sonar.axes.beam_count());
}

SonarSettings ReadSettings(const JsonReader& json) {
  SonarSettings settings;
  settings.gain_db = json.FindNumber("gain_db", kRecordedLevelDb);
  settings.pulse_length_us = json.FindNumber("pulse_length_us", kRecordedPulseUs);
  if (const auto applied = json.Find("time_varied_gain")) settings.time_varied_gain = applied->Bool();
  if (const auto compression = json.Find("compression"))
    settings.compression = compression->Word<Compression>();
  return settings;
}

Json SettingsJson(const SonarSettings& settings) {
  Json json = Json::object();
  if (settings.gain_db) json["gain_db"] = *settings.gain_db;
  if (settings.pulse_length_us) json["pulse_length_us"] = *settings.pulse_length_us;
  if (settings.time_varied_gain) json["time_varied_gain"] = *settings.time_varied_gain;
  if (settings.compression) json["compression"] = ToString(*settings.compression);
  return json;
}

// Name of a picture. No file outside the folder can be opened, on any operating system.
std::string ReadFileName(const JsonReader& json) {
  std::string name = json.String();
  const bool is_plain = !name.empty() && name != "." && name != ".." &&
                        name.find_first_of(std::string_view("/\\:\0", 4)) == std::string::npos;
  if (!is_plain)
    json.Fail(fmt::format("is \"{}\", expected the plain name of a file in the folder", Printable(name)));
  return name;
}

double LargestInteger(int bits) {
  return bits == 8 ? 255.0 : 65535.0;
}

void ReadImage(const JsonReader& json, RecordingHeader& header) {
  const JsonReader layout = json.At("layout");
  if (layout.String() == "fan") {
    layout.Fail(R"(is "fan", which cannot be read; expected "polar": convert the images to range by beam)");
  }
  layout.Word(Words<bool, 1>{{{"polar", true}}});

  const JsonReader bits = json.At("bits");
  header.bits = static_cast<int>(bits.Integer(1, 64));
  const bool is_float = header.bits == 32;
  if (header.bits != 8 && header.bits != 16 && !is_float) {
    bits.Fail(fmt::format("is {}, expected 8, 16 or 32 (float)", header.bits));
  }

  ImageScale& scale = header.info.scale;
  if (const auto quantity = json.Find("quantity")) scale.quantity = quantity->Word(kQuantities);
  scale.full_scale = is_float ? 1.0 : LargestInteger(header.bits);
  json.Update("full_scale", scale.full_scale,
              NumberRange::AboveUpTo(0.0, is_float ? kMaxRecordedFullScale : scale.full_scale));
  scale.db_min = json.FindNumber("db_min", kRecordedLevelDb);
  scale.db_max = json.FindNumber("db_max", kRecordedLevelDb);
  scale.db_span = json.FindNumber("db_span", kRecordedSpanDb);
  if (scale.db_min && scale.db_max) {
    const double span_db = *scale.db_max - *scale.db_min;
    if (!(span_db > 0.0)) {
      json.At("db_max").Fail(
          fmt::format("is {}, expected more than db_min, {}", *scale.db_max, *scale.db_min));
    }
    if (scale.db_span && std::abs(*scale.db_span - span_db) > 1e-6) {
      json.At("db_span").Fail(fmt::format("is {}, expected db_max - db_min, {}", *scale.db_span, span_db));
    }
  }
  if (const auto settings = json.Find("settings")) header.info.settings = ReadSettings(*settings);
  header.info.display_gamma = json.FindNumber("display_gamma", NumberRange::AboveUpTo(0.0, 100.0));
  if (const auto valid = json.Find("valid")) header.valid_file = ReadFileName(*valid);
}

// Settings are those of the recording, unless the frame has its own.
FrameInfo ReadFrameInfo(const JsonReader& json, const SonarSettings& of_recording) {
  FrameInfo frame;
  frame.name = ReadFileName(json.At("file"));
  frame.time_s = json.FindNumber("time_s");
  if (const auto pose = json.Find("world_from_sonar")) frame.world_from_sonar = ReadPose(*pose);
  const auto settings = json.Find("settings");
  frame.settings = settings ? ReadSettings(*settings) : of_recording;
  if (const auto motion = json.Find("motion")) frame.motion = ReadMotion(*motion);
  return frame;
}

void ReadScene(const JsonReader& json, const fs::path& folder, RecordingInfo& info) {
  fs::path scene = folder / json.String();
  std::error_code error;
  const bool exists = fs::exists(scene, error);
  // `..` after a link is the folder above its target.
  const fs::path shorter = scene.lexically_normal();
  if (!exists || fs::equivalent(scene, shorter, error)) scene = shorter;
  info.scene_path = scene.string();
  if (!exists) {
    AddNote(info, fmt::format("{} names the scene {}, which does not exist", kRecordingFile, scene.string()));
  }
}

void ReadTexts(const JsonReader& json, RecordingInfo& info) {
  if (const auto details = json.Find("details")) {
    for (const JsonReader& detail : details->Items()) {
      const std::vector<JsonReader> texts = detail.Items();
      if (texts.size() != 2) detail.Fail(R"(is not a pair, expected ["name", "value"])");
      info.details.emplace_back(texts[0].String(), texts[1].String());
    }
  }
  if (const auto notes = json.Find("notes")) {
    for (const JsonReader& note : notes->Items()) AddNote(info, note.String());
  }
}

void ReadOrigin(const JsonReader& json, const fs::path& folder, RecordingInfo& info) {
  if (const auto synthetic = json.Find("synthetic")) info.synthetic = synthetic->Bool();
  if (const auto generator = json.Find("generator")) {
    info.synthetic = true;
    info.details.emplace_back("generator", generator->String());
  }
  std::error_code error;
  if (fs::exists(folder / kTruthFile, error)) info.synthetic = true;
}

// "frames[17].gain" -> "frames[].gain": an unknown key of every frame gives one note, not a thousand.
std::string WithoutIndices(std::string_view path) {
  std::string text;
  bool inside = false;
  for (const char c : path) {
    if (c == ']') inside = false;
    if (!inside) text += c;
    if (c == '[') inside = true;
  }
  return text;
}

void NoteUnknownKeys(const JsonReader& json, RecordingInfo& info) {
  std::map<std::string, std::pair<int, int>> line_and_count;
  for (const JsonReader::UnknownKey& key : json.UnknownKeys()) {
    auto& [line, count] = line_and_count.try_emplace(WithoutIndices(key.path), key.line, 0).first->second;
    ++count;
  }
  for (const auto& [path, at] : line_and_count) {
    const std::string times = at.second > 1 ? fmt::format(" ({} times)", at.second) : "";
    AddNote(info, fmt::format("{}:{}: key '{}'{} is not known here and has no effect", kRecordingFile,
                              at.first, path, times));
  }
}

Json SonarOfRecordingJson(const RecordingInfo& info) {
  Json json = SonarJson(info.sonar);
  if (!info.azimuth_psf.empty()) json["azimuth_psf"] = info.azimuth_psf;
  if (!info.beam_taper.empty()) json["beam_taper"] = info.beam_taper;
  return json;
}

Json ImageJson(const RecordingHeader& header) {
  const ImageScale& scale = header.info.scale;
  Json json = {{"layout", "polar"},
               {"bits", header.bits},
               {"quantity", WordIn(kQuantities, scale.quantity)},
               {"full_scale", scale.full_scale}};
  if (scale.db_min) json["db_min"] = *scale.db_min;
  if (scale.db_max) json["db_max"] = *scale.db_max;
  if (scale.db_span) json["db_span"] = *scale.db_span;
  if (header.info.settings != SonarSettings{}) json["settings"] = SettingsJson(header.info.settings);
  if (header.info.display_gamma) json["display_gamma"] = *header.info.display_gamma;
  if (!header.valid_file.empty()) json["valid"] = header.valid_file;
  return json;
}

Json FrameJson(const FrameInfo& frame, const SonarSettings& of_recording) {
  Json json = {{"file", frame.name}};
  if (frame.time_s) json["time_s"] = *frame.time_s;
  if (frame.world_from_sonar) json["world_from_sonar"] = PoseJson(*frame.world_from_sonar);
  if (frame.settings != of_recording) json["settings"] = SettingsJson(frame.settings);
  if (frame.motion) json["motion"] = MotionJson(*frame.motion);
  return json;
}

RecordingHeader ReadHeader(const JsonReader& json, const fs::path& folder) {
  json.CheckFormat(kRecordingFormat);

  RecordingHeader header;
  RecordingInfo& info = header.info;
  info.source = folder.string();
  info.format = kRecordingFormat;
  ReadTexts(json, info);
  ReadSonar(json.At("sonar"), info);
  ReadImage(json.At("image"), header);
  if (const auto water = json.Find("water")) info.water = ReadWater(*water);
  info.source_level_db = json.FindNumber("source_level_db", kRecordedLevelDb);
  if (const auto scene = json.Find("scene")) ReadScene(*scene, folder, info);
  ReadOrigin(json, folder, info);
  const JsonReader frames = json.At("frames");
  for (const JsonReader& frame : frames.Items()) header.frames.push_back(ReadFrameInfo(frame, info.settings));
  if (header.frames.empty()) frames.Fail("is empty, expected at least one frame");
  NoteUnknownKeys(json, info);
  return header;
}

// `file` relative to `folder`, which may lie behind links. The file itself may be a link and stays one.
fs::path PathFrom(const fs::path& folder, const fs::path& file) {
  std::error_code error;
  const fs::path whole = fs::absolute(file);
  const fs::path place = fs::weakly_canonical(whole.parent_path(), error);
  const fs::path from = error ? fs::path() : fs::weakly_canonical(folder, error);
  if (error) return whole.lexically_proximate(folder);
  return (place / whole.filename()).lexically_proximate(from);
}

}  // namespace

RecordingHeader ReadRecordingHeader(const fs::path& folder) {
  return ReadHeader(JsonReader::FromFile(folder / kRecordingFile), folder);
}

RecordingHeader ParseRecordingHeader(std::string_view text, const fs::path& folder) {
  return ReadHeader(JsonReader::FromText(text, (folder / kRecordingFile).string()), folder);
}

RecordingInfo ReadSonarFile(const fs::path& file) {
  const JsonReader json = JsonReader::FromFile(file);
  RecordingInfo info;
  info.source = file.string();
  ReadSonar(json.At("sonar"), info);
  if (const auto water = json.Find("water")) info.water = ReadWater(*water);
  json.Finish();
  // The notes name a recording; here they must name this file.
  for (std::string& note : info.notes) {
    if (note.starts_with(kRecordingFile))
      note.replace(0, std::string_view(kRecordingFile).size(), info.source);
  }
  return info;
}

void WriteSonarFile(const fs::path& file, const RecordingInfo& info) {
  Json json = {{"sonar", SonarOfRecordingJson(info)}};
  if (info.water) json["water"] = WaterJson(*info.water);
  WriteJson(file, json);
}

Json RecordingJson(const RecordingHeader& header, const fs::path& folder) {
  const RecordingInfo& info = header.info;
  Json json = {{"format", kRecordingFormat}, {"sonar", SonarOfRecordingJson(info)}};
  if (info.water) json["water"] = WaterJson(*info.water);
  json["image"] = ImageJson(header);
  if (info.source_level_db) json["source_level_db"] = *info.source_level_db;
  if (info.scene_path) json["scene"] = PathFrom(folder, *info.scene_path).string();
  if (info.synthetic) json["synthetic"] = true;
  for (const auto& [name, value] : info.details) json["details"].push_back(Json::array({name, value}));
  if (!info.format.empty() && info.format != kRecordingFormat) {
    json["details"].push_back(Json::array({"original format", info.format}));
  }
  if (!info.notes.empty()) json["notes"] = info.notes;
  for (const FrameInfo& frame : header.frames) json["frames"].push_back(FrameJson(frame, info.settings));
  return json;
}

}  // namespace sonarcal::data_io
