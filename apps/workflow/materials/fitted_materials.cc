#include "apps/workflow/materials/fitted_materials.h"

#include <fmt/ranges.h>

#include <cmath>
#include <map>
#include <optional>
#include <string_view>

#include "calib/fit_report.h"
#include "core/types/error.h"
#include "core/types/parameter_table.h"
#include "data_io/json/json_reader.h"

namespace sonarcal::workflow {
namespace {

using Parameters = std::map<std::string, data_io::JsonReader>;

Parameters ParametersOf(const data_io::JsonReader& fit) {
  fit.CheckFormat("sonar-fit/1");
  Parameters parameters;
  for (const data_io::JsonReader& parameter : fit.At("parameters").Items())
    parameters.emplace(parameter.At("name").String(), parameter);
  return parameters;
}

calib::ParameterStatus StatusOf(const data_io::JsonReader& parameter) {
  return parameter.At("status").Word<calib::ParameterStatus>();
}

// Standard error, or standard deviation of the prior where the data determine nothing; of the logarithm if
// the parameter is fitted as one.
double SigmaOf(const data_io::JsonReader& parameter, bool logarithmic, bool& determined) {
  const std::optional<double> sigma = parameter.FindNumber("sigma", data_io::NumberRange::Above(0.0));
  determined = StatusOf(parameter) == calib::ParameterStatus::kFree && sigma.has_value();
  if (determined) return *sigma / (logarithmic ? parameter.At("value").Number() : 1.0);
  const data_io::JsonReader json = parameter.At("prior");
  const std::vector<double> prior = json.Numbers();
  if (prior.size() != 2) json.Fail("is not [value, sigma]");
  return prior[1] / (logarithmic ? prior[0] : 1.0);
}

// Level that A, C and E refer to, and the image model.
void TakeLevel(const data_io::JsonReader& fit, const Parameters& parameters, NamedMaterial& material) {
  const auto value = [&](const char* name) {
    const auto found = parameters.find(name);
    if (found == parameters.end()) fit.At("parameters").Fail(fmt::format("have no '{}'", name));
    return found->second.At("value").Number();
  };
  ParameterSet set;
  set.model = parameters.contains("display.db_min") ? EchoModel::kPaper : EchoModel::kAcoustic;
  set.source_level_db = value("source_level_db");
  if (set.model == EchoModel::kPaper) {
    set.display.db_min = value("display.db_min");
  } else {
    set.receiver.gain_db = value("receiver.gain_db");
  }
  material.model = set.model;
  material.level_db = ReferenceLevelDb(set);
  const std::optional<data_io::JsonReader> level = fit.Find("curves_level");
  const std::optional<double> sigma_db =
      level ? level->FindNumber("sigma_db", data_io::NumberRange::AtLeast(0.0)) : std::nullopt;
  if (!sigma_db) return;
  // A measured level makes the curve absolute, up to its own error.
  material.level_db.reset();
  const double sigma_of_log = std::log(PowerFromDb(*sigma_db));
  for (double* amplitude : {&material.spread.a, &material.spread.c, &material.spread.e})
    *amplitude = std::exp(std::hypot(std::log(*amplitude), sigma_of_log));
}

// Fitted curve of one material; nothing if no parameter of it was free.
std::optional<NamedMaterial> MaterialOf(const std::string& name, const Parameters& parameters) {
  NamedMaterial material{.name = name, .centre = {}, .spread = {}, .source = {}, .comment = {}};
  std::vector<std::string_view> open;
  std::vector<std::string_view> fixed;
  VisitParameters(material.centre, [&](const ParameterInfo& info, double& centre) {
    const data_io::JsonReader& parameter = parameters.at(fmt::format("material.{}.gsab.{}", name, info.key));
    centre = parameter.At("value").Number();
    if (StatusOf(parameter) == calib::ParameterStatus::kFixed) {
      fixed.push_back(info.key);
      return;
    }
    const bool logarithmic = info.scale == ParameterScale::kLogarithmic;
    bool determined = false;
    const double sigma = SigmaOf(parameter, logarithmic, determined);
    ParameterMember<double>(material.spread, info.key) = logarithmic ? std::exp(sigma) : sigma;
    if (!determined) open.push_back(info.key);
  });
  constexpr std::size_t kValues = 6;
  if (fixed.size() == kValues) return std::nullopt;
  if (!fixed.empty())
    throw DataError(
        "material '{}': {} was fixed and has no standard error, expected a fit of the whole curve", name,
        fmt::join(fixed, ", "));
  material.comment = "Spreads are standard errors.";
  if (!open.empty())
    material.comment += fmt::format(" Not determined by the recording, with the spread of the prior: {}.",
                                    fmt::join(open, ", "));
  return material;
}

}  // namespace

std::vector<NamedMaterial> FittedMaterials(const std::filesystem::path& fit_json,
                                           const RecordingInfo& recording) {
  if (!(recording.sonar.frequency_hz > 0.0))
    throw DataError("{}: the sonar's frequency_hz is unknown", recording.source);
  const data_io::JsonReader fit = data_io::JsonReader::FromFile(fit_json);
  const Parameters parameters = ParametersOf(fit);
  constexpr std::string_view kBegin = "material.";
  constexpr std::string_view kEnd = ".gsab.A";
  std::filesystem::path source = recording.source;
  if (!source.has_filename()) source = source.parent_path();
  const std::string name = source.filename().string();
  const std::string program = fmt::format("sonarcal {}", SONARCAL_VERSION);
  std::vector<NamedMaterial> materials;
  for (const auto& [parameter, json] : parameters) {
    if (!parameter.starts_with(kBegin) || !parameter.ends_with(kEnd)) continue;
    std::optional<NamedMaterial> material = MaterialOf(
        parameter.substr(kBegin.size(), parameter.size() - kBegin.size() - kEnd.size()), parameters);
    if (!material) continue;
    TakeLevel(fit, parameters, *material);
    material->frequency_min_hz = recording.sonar.frequency_hz;
    material->frequency_max_hz = recording.sonar.frequency_hz;
    material->origin =
        MaterialOrigin{.recording = name, .synthetic = recording.synthetic, .program = program};
    material->source =
        fmt::format("fit to the {}recording {}", recording.synthetic ? "synthetic " : "", name);
    materials.push_back(std::move(*material));
  }
  if (materials.empty()) throw DataError("{}: no material was fitted", fit_json.string());
  return materials;
}

}  // namespace sonarcal::workflow
