#include "data_io/parameters/materials_io.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include <nlohmann/json.hpp>

#include "core/types/error.h"
#include "core/types/parameter_table.h"
#include "data_io/json/json_reader.h"
#include "data_io/json/parameter_json.h"

namespace sonarcal::data_io {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kMaterialsFormat = "sonar-materials/1";
constexpr double kMaxFrequencyHz = 1e9;

bool IsLogarithmic(const ParameterInfo& info) {
  return info.scale == ParameterScale::kLogarithmic;
}

std::string_view SpreadKey(const ParameterInfo& info) {
  return IsLogarithmic(info) ? "factor" : "sigma";
}

void ReadCurve(const JsonReader& json, NamedMaterial& material) {
  VisitParameters(material.centre, [&](const ParameterInfo& info, double& centre) {
    const JsonReader member = json.At(info.key);
    NumberRange range = RangeOf(info);
    range.min_excluded = range.min_excluded || IsLogarithmic(info);
    centre = member.At("centre").Number(range);
    const double least = IsLogarithmic(info) ? 1.0 : 0.0;
    ParameterMember<double>(material.spread, info.key) =
        member.At(SpreadKey(info)).Number(NumberRange::AboveUpTo(least, info.max));
  });
}

NamedMaterial ReadMaterial(const std::string& name, const JsonReader& json) {
  NamedMaterial material{.name = name,
                         .model = json.At("model").Word<EchoModel>(),
                         .centre = {},
                         .spread = {},
                         .level_db = json.FindNumber("level_db"),
                         .source = json.At("source").String(),
                         .comment = {}};
  const JsonReader band = json.At("frequency_hz");
  const std::vector<double> frequencies = band.Numbers(NumberRange::AboveUpTo(0.0, kMaxFrequencyHz));
  if (frequencies.size() != 2 || frequencies[0] > frequencies[1])
    band.Fail("is not [lowest, highest] frequency");
  material.frequency_min_hz = frequencies[0];
  material.frequency_max_hz = frequencies[1];
  ReadCurve(json.At("gsab"), material);
  if (const auto comment = json.Find("comment")) material.comment = comment->String();
  if (const auto origin = json.Find("origin")) {
    material.origin = MaterialOrigin{.recording = origin->At("recording").String(),
                                     .synthetic = origin->At("synthetic").Bool(),
                                     .program = origin->At("program").String()};
  }
  return material;
}

bool Has(const std::vector<NamedMaterial>& materials, const std::string& name) {
  return std::ranges::find(materials, name, &NamedMaterial::name) != materials.end();
}

}  // namespace

std::vector<NamedMaterial> ReadMaterials(const std::filesystem::path& file) {
  const JsonReader json = JsonReader::FromFile(file);
  json.CheckFormat(kMaterialsFormat);
  std::vector<NamedMaterial> materials;
  for (const auto& [name, member] : json.At("materials").Members(kMaxMaterials)) {
    if (Has(BuiltInMaterials(), name)) member.Fail("has the name of a built-in material, expected another");
    materials.push_back(ReadMaterial(name, member));
  }
  json.Finish();
  return materials;
}

std::vector<NamedMaterial> KnownMaterials(const std::vector<std::filesystem::path>& files) {
  std::vector<NamedMaterial> known = BuiltInMaterials();
  for (const std::filesystem::path& file : files) {
    for (NamedMaterial& material : ReadMaterials(file)) {
      if (Has(known, material.name))
        throw DataError("{}: material '{}' is also in another file, expected it once", file.string(),
                        material.name);
      known.push_back(std::move(material));
    }
  }
  return known;
}

Json MaterialJson(const NamedMaterial& material) {
  Json json = {{"model", ToString(material.model)},
               {"frequency_hz", {material.frequency_min_hz, material.frequency_max_hz}}};
  if (material.level_db) json["level_db"] = *material.level_db;
  VisitParameters(material.centre, [&](const ParameterInfo& info, double centre) {
    json["gsab"][std::string(info.key)] = {
        {"centre", centre},
        {std::string(SpreadKey(info)), ParameterMember<const double>(material.spread, info.key)}};
  });
  json["source"] = material.source;
  json["comment"] = material.comment;
  if (material.origin) {
    json["origin"] = {{"recording", material.origin->recording},
                      {"synthetic", material.origin->synthetic},
                      {"program", material.origin->program}};
  }
  return json;
}

Json MaterialsJson(const std::vector<NamedMaterial>& materials) {
  Json json = {{"format", kMaterialsFormat}, {"materials", Json::object()}};
  for (const NamedMaterial& material : materials) json["materials"][material.name] = MaterialJson(material);
  return json;
}

}  // namespace sonarcal::data_io
