#include "data_io/parameters/parameters_io.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "data_io/files/atomic_output.h"
#include "data_io/json/json_fields.h"
#include "data_io/json/json_reader.h"
#include "data_io/json/json_writer.h"

namespace sonarcal::data_io {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kFormat = "sonar-parameters/1";

// Limits of plausible levels and power ratios. They detect a misplaced decimal point and prevent overflow in
// formulas.
const NumberRange kLevelDb = NumberRange::Between(-500.0, 500.0);
const NumberRange kPowerRatio = NumberRange::Between(0.0, 1e30);
const NumberRange kExponent = NumberRange::Between(0.0, 100.0);
const NumberRange kPeakWidthDeg = NumberRange::AboveUpTo(0.0, 1000.0);
const NumberRange kSpreadM = NumberRange::Between(0.0, 100.0);
const NumberRange kTransmitDeg = NumberRange::Between(0.0, 90.0);
const NumberRange kSpreadDeg = NumberRange::Between(0.0, 360.0);
const NumberRange kLooks = NumberRange::AboveUpTo(0.0, 1e6);
const NumberRange kSlopeDbPerM = NumberRange::Between(-1000.0, 1000.0);
const NumberRange kDisplayExponent = NumberRange::AboveUpTo(0.0, 10.0);
const NumberRange kMirrorLossDb = NumberRange::Between(0.0, 200.0);  // a mirror does not amplify
const NumberRange kPositive = NumberRange::AboveUpTo(0.0, 1e12);

DisplayParameters<double> ReadDisplay(const JsonReader& json) {
  const JsonReader db_max_json = json.At("db_max");
  DisplayParameters<double> display{.db_min = json.At("db_min").Number(kLevelDb),
                                    .db_max = db_max_json.Number(kLevelDb)};
  if (!(display.db_max > display.db_min)) {
    db_max_json.Fail(fmt::format("is {}, expected more than db_min, {}", display.db_max, display.db_min));
  }
  if (const auto law = json.Find("law")) display.law = law->Word<DisplayLaw>();
  json.Update("soft_db", display.soft_db, kLevelDb);
  json.Update("exponent", display.exponent, kDisplayExponent);
  return display;
}

MaterialParameters ReadMaterial(const JsonReader& json) {
  const JsonReader gsab = json.At("gsab");
  return {.gsab = {.a = gsab.At("A").Number(kPowerRatio),
                   .b_deg = gsab.At("B_deg").Number(kPeakWidthDeg),
                   .c = gsab.At("C").Number(kPowerRatio),
                   .d = gsab.At("D").Number(kExponent),
                   .e = gsab.At("E").Number(kPowerRatio),
                   .f_deg = gsab.At("F_deg").Number(kPeakWidthDeg)}};
}

JitterParameters<double> ReadJitter(const JsonReader& json) {
  JitterParameters<double> jitter;
  json.Update("sigma_range_m", jitter.sigma_range_m, kSpreadM);
  json.Update("sigma_azimuth_deg", jitter.sigma_azimuth_deg, kSpreadDeg);
  json.Update("reference_range_m", jitter.reference_range_m, kPositive);
  json.Update("reference_frequency_hz", jitter.reference_frequency_hz, kPositive);
  if (const auto growth = json.Find("growth")) jitter.growth = growth->Word<JitterGrowth>();
  return jitter;
}

ReceiverParameters ReadReceiver(const JsonReader& json) {
  ReceiverParameters receiver;
  json.Update("gain_db", receiver.gain_db, kLevelDb);
  if (const auto law = json.Find("time_varied_gain")) receiver.time_varied_gain = law->Word<TimeVariedGain>();
  receiver.noise_db = json.FindNumber("noise_db", kLevelDb);
  json.Update("noise_slope_db_per_m", receiver.noise_slope_db_per_m, kSlopeDbPerM);
  if (const auto taper = json.Find("noise_taper_db")) receiver.noise_taper_db = taper->Numbers(kLevelDb);
  receiver.noise_after_gain_db = json.FindNumber("noise_after_gain_db", kLevelDb);
  if (const auto taper = json.Find("noise_after_gain_taper_db"))
    receiver.noise_after_gain_taper_db = taper->Numbers(kLevelDb);
  json.Update("looks", receiver.looks, kLooks);
  return receiver;
}

BeamParameters ReadBeam(const JsonReader& json) {
  BeamParameters beam;
  json.Update("azimuth_width_deg", beam.azimuth_width_deg, kSpreadDeg);
  json.Update("elevation_width_deg", beam.elevation_width_deg, kSpreadDeg);
  if (const auto pattern = json.Find("azimuth_pattern")) {
    beam.azimuth_pattern = pattern->Word<AzimuthPattern>();
  }
  if (const auto pattern = json.Find("elevation_pattern")) {
    beam.elevation_pattern = pattern->Word<ElevationPattern>();
  }
  if (const auto lobes = json.Find("mirror_lobes")) beam.mirror_lobes = lobes->Word<MirrorLobes>();
  json.Update("elevation_taper", beam.elevation_taper, NumberRange::Between(0.0, 1.0));
  json.Update("azimuth_taper", beam.azimuth_taper, NumberRange::Between(0.0, 1.0));
  if (const auto table = json.Find("azimuth_table_db")) {
    beam.azimuth_table_db = table->Numbers(NumberRange::Between(-500.0, 0.0));
    if (beam.azimuth_table_db.size() < 3 || beam.azimuth_table_db.size() % 2 == 0) {
      table->Fail(
          fmt::format("has {} numbers, expected an odd number of them, 3 at least, the axis in the "
                      "middle",
                      beam.azimuth_table_db.size()));
    }
  } else if (beam.azimuth_pattern == AzimuthPattern::kTable) {
    json.Fail("has the azimuth pattern \"table\" but no azimuth_table_db");
  }
  json.Update("transmit_even_deg", beam.transmit_even_deg, kTransmitDeg);
  json.Update("transmit_end_deg", beam.transmit_end_deg, kTransmitDeg);
  if (beam.transmit_end_deg < beam.transmit_even_deg) {
    json.Fail(fmt::format("ends sending at {} degrees, expected no less than transmit_even_deg, {}",
                          beam.transmit_end_deg, beam.transmit_even_deg));
  }
  if (const auto sensitivity = json.Find("sensitivity_db"))
    beam.sensitivity_db = sensitivity->Numbers(kLevelDb);
  return beam;
}

PulseParameters ReadPulse(const JsonReader& json) {
  PulseParameters pulse;
  json.Update("length_m", pulse.length_m, kSpreadM);
  return pulse;
}

ParameterSet Read(const JsonReader& json) {
  json.CheckFormat(kFormat);
  ParameterSet parameters;
  parameters.model = json.At("model").Word<EchoModel>();
  json.Update("source_level_db", parameters.source_level_db, kLevelDb);
  json.Update("noise_level_db", parameters.noise_level_db, kLevelDb);
  json.Update("array_gain_db", parameters.array_gain_db, kLevelDb);
  if (const auto display = json.Find("display")) parameters.display = ReadDisplay(*display);
  const JsonReader materials = json.At("materials");
  for (const auto& [name, material] : materials.Members()) {
    parameters.materials.emplace(name, ReadMaterial(material));
  }
  if (const auto mirrors = json.Find("mirror")) {
    for (const auto& [name, mirror] : mirrors->Members()) {
      parameters.mirrors[name].loss_db = mirror.At("loss_db").Number(kMirrorLossDb);
    }
  }
  if (const auto jitter = json.Find("jitter")) parameters.jitter = ReadJitter(*jitter);
  if (const auto receiver = json.Find("receiver")) parameters.receiver = ReadReceiver(*receiver);
  if (const auto beam = json.Find("beam")) parameters.beam = ReadBeam(*beam);
  if (const auto pulse = json.Find("pulse")) parameters.pulse = ReadPulse(*pulse);
  if (const auto water = json.Find("water")) parameters.water = ReadWater(*water);
  json.Finish();
  if (parameters.materials.empty()) materials.Fail("is empty, expected at least one material");
  return parameters;
}

Json MaterialJson(const MaterialParameters& material) {
  const GsabParameters<double>& gsab = material.gsab;
  return {{"gsab",
           {{"A", gsab.a},
            {"B_deg", gsab.b_deg},
            {"C", gsab.c},
            {"D", gsab.d},
            {"E", gsab.e},
            {"F_deg", gsab.f_deg}}}};
}

Json DisplayJson(const DisplayParameters<double>& display) {
  return {{"db_min", display.db_min},
          {"db_max", display.db_max},
          {"law", ToString(display.law)},
          {"soft_db", display.soft_db},
          {"exponent", display.exponent}};
}

Json JitterJson(const JitterParameters<double>& jitter) {
  return {{"sigma_range_m", jitter.sigma_range_m},
          {"sigma_azimuth_deg", jitter.sigma_azimuth_deg},
          {"reference_range_m", jitter.reference_range_m},
          {"reference_frequency_hz", jitter.reference_frequency_hz},
          {"growth", ToString(jitter.growth)}};
}

Json ReceiverJson(const ReceiverParameters& receiver) {
  Json json = {{"gain_db", receiver.gain_db}, {"time_varied_gain", ToString(receiver.time_varied_gain)}};
  if (receiver.noise_db) json["noise_db"] = *receiver.noise_db;
  json["noise_slope_db_per_m"] = receiver.noise_slope_db_per_m;
  json["noise_taper_db"] = receiver.noise_taper_db;
  if (receiver.noise_after_gain_db) json["noise_after_gain_db"] = *receiver.noise_after_gain_db;
  json["noise_after_gain_taper_db"] = receiver.noise_after_gain_taper_db;
  json["looks"] = receiver.looks;
  return json;
}

Json BeamJson(const BeamParameters& beam) {
  Json json = {{"azimuth_width_deg", beam.azimuth_width_deg},
               {"elevation_width_deg", beam.elevation_width_deg},
               {"azimuth_pattern", ToString(beam.azimuth_pattern)},
               {"azimuth_taper", beam.azimuth_taper},
               {"elevation_pattern", ToString(beam.elevation_pattern)},
               {"elevation_taper", beam.elevation_taper},
               {"transmit_even_deg", beam.transmit_even_deg},
               {"transmit_end_deg", beam.transmit_end_deg},
               {"mirror_lobes", ToString(beam.mirror_lobes)},
               {"sensitivity_db", beam.sensitivity_db}};
  if (!beam.azimuth_table_db.empty()) json["azimuth_table_db"] = beam.azimuth_table_db;
  return json;
}

}  // namespace

ParameterSet ReadParameters(const std::filesystem::path& file) {
  return Read(JsonReader::FromFile(file));
}

ParameterSet ParseParameters(std::string_view text, const std::string& file) {
  return Read(JsonReader::FromText(text, file));
}

Json ParametersJson(const ParameterSet& parameters) {
  Json json = {{"format", kFormat},
               {"model", ToString(parameters.model)},
               {"source_level_db", parameters.source_level_db},
               {"noise_level_db", parameters.noise_level_db},
               {"array_gain_db", parameters.array_gain_db},
               {"display", DisplayJson(parameters.display)},
               {"materials", Json::object()}};
  for (const auto& [name, material] : parameters.materials) json["materials"][name] = MaterialJson(material);
  json["mirror"] = Json::object();
  for (const auto& [name, mirror] : parameters.mirrors) json["mirror"][name] = {{"loss_db", mirror.loss_db}};
  json["jitter"] = JitterJson(parameters.jitter);
  json["receiver"] = ReceiverJson(parameters.receiver);
  json["beam"] = BeamJson(parameters.beam);
  json["pulse"] = {{"length_m", parameters.pulse.length_m}};
  if (parameters.water) json["water"] = WaterJson(*parameters.water);
  return json;
}

void WriteParameters(const std::filesystem::path& file, const ParameterSet& parameters) {
  const std::string text = JsonText(ParametersJson(parameters));
  ParseParameters(text, file.string());  // a fit must not write a file that the next command rejects
  WriteFileWhole(file, text);
}

}  // namespace sonarcal::data_io
