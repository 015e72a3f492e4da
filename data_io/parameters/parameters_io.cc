#include "data_io/parameters/parameters_io.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/types/error.h"
#include "core/types/parameter_table.h"
#include "data_io/files/atomic_output.h"
#include "data_io/json/json_reader.h"
#include "data_io/json/json_writer.h"
#include "data_io/json/parameter_json.h"

namespace sonarcal::data_io {
namespace {

using Json = nlohmann::ordered_json;

void CheckDisplay(const JsonReader& json, const DisplayParameters<double>& display) {
  if (display.db_max > display.db_min) return;
  json.At("db_max").Fail(fmt::format("is {}, expected more than db_min, {}", display.db_max, display.db_min));
}

void CheckBeam(const JsonReader& json, const BeamParameters& beam) {
  const std::size_t values = beam.azimuth_table_db.size();
  if (const auto table = json.Find("azimuth_table_db"); table && (values < 3 || values % 2 == 0)) {
    table->Fail(fmt::format(
        "has {} numbers, expected an odd number of them, 3 at least, the axis in the middle", values));
  }
  if (values == 0 && beam.azimuth_pattern == AzimuthPattern::kTable) {
    json.Fail("has the azimuth pattern \"table\" but no azimuth_table_db");
  }
  if (beam.transmit_end_deg < beam.transmit_even_deg) {
    json.Fail(fmt::format("ends sending at {} degrees, expected no less than transmit_even_deg, {}",
                          beam.transmit_end_deg, beam.transmit_even_deg));
  }
}

// Gives materials without a curve the centre of their prior. `known` null: each needs a curve.
void CompleteMaterials(const JsonReader& json, const std::vector<NamedMaterial>* known,
                       ParameterSet& parameters) {
  for (const auto& [name, material] : json.Members()) {
    MaterialParameters& of = parameters.materials.at(name);
    const auto prior = material.Find("prior");
    if (!prior || known == nullptr) {
      if (prior && !material.Find("gsab"))
        material.Fail("has a prior and no gsab; a prior is no value, expected the curve that a fit found");
      material.At("gsab");
      continue;
    }
    try {
      const GsabParameters<double> centre = CentreFor(FindMaterial(of.prior, *known), parameters);
      if (!material.Find("gsab")) of.gsab = centre;
    } catch (const DataError& error) {
      prior->Fail(fmt::format("cannot be used: {}", error.what()));
    }
  }
}

ParameterSet ParametersFrom(const JsonReader& json, const std::vector<NamedMaterial>* known) {
  json.CheckFormat(kParametersFormat);
  ParameterSet parameters;
  ReadGroup(json, parameters);
  if (const auto display = json.Find("display")) CheckDisplay(*display, parameters.display);
  if (const auto beam = json.Find("beam")) CheckBeam(*beam, parameters.beam);
  if (parameters.materials.empty()) json.At("materials").Fail("is empty, expected at least one material");
  CompleteMaterials(json.At("materials"), known, parameters);
  return parameters;
}

ParameterSet Read(const JsonReader& json, const std::vector<NamedMaterial>* known = nullptr) {
  ParameterSet parameters = ParametersFrom(json, known);
  json.Finish();
  return parameters;
}

}  // namespace

ParameterSet ParametersFrom(const JsonReader& json) {
  return ParametersFrom(json, nullptr);
}

ParameterSet ReadParameters(const std::filesystem::path& file) {
  return Read(JsonReader::FromFile(file));
}

ParameterSet ReadStartParameters(const std::filesystem::path& file,
                                 const std::vector<NamedMaterial>& materials) {
  return Read(JsonReader::FromFile(file), &materials);
}

ParameterSet ParseParameters(std::string_view text, const std::string& file) {
  return Read(JsonReader::FromText(text, file));
}

ParameterSet ParseStartParameters(std::string_view text, const std::string& file,
                                  const std::vector<NamedMaterial>& materials) {
  return Read(JsonReader::FromText(text, file), &materials);
}

Json ParametersJson(const ParameterSet& parameters) {
  Json json = {{"format", kParametersFormat}};
  json.update(MemberJson(parameters));
  return json;
}

void WriteParameters(const std::filesystem::path& file, const ParameterSet& parameters) {
  const std::string text = JsonText(ParametersJson(parameters));
  ParseParameters(text, file.string());  // a fit must not write a file that the next command rejects
  WriteFileWhole(file, text);
}

}  // namespace sonarcal::data_io
