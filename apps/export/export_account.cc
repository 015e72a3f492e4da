#include "apps/export/export_account.h"

#include <fmt/format.h>

#include <map>
#include <utility>

#include "core/types/error.h"
#include "data_io/json/json_fields.h"
#include "data_io/parameters/parameters_io.h"

namespace sonarcal::exporting {
namespace {

using Json = nlohmann::ordered_json;

// Collects every leaf of a JSON object with its path; arrays are leaves.
void Flatten(const std::string& path, const Json& json, std::vector<AccountLine>& lines) {
  if (!json.is_object()) {
    lines.push_back({.parameter = path, .value = json, .target = {}, .how = {}});
    return;
  }
  for (const auto& [key, member] : json.items()) {
    Flatten(path.empty() ? key : fmt::format("{}.{}", path, key), member, lines);
  }
}

bool IsOf(std::string_view parameter, std::string_view name) {
  return name.ends_with('.') || name.ends_with('_') ? parameter.starts_with(name) : parameter == name;
}

// Parameters without effect, with the reason.
std::vector<std::pair<std::string, std::string>> Unused(const ParameterSet& parameters) {
  std::vector<std::pair<std::string, std::string>> unused;
  const auto add = [&](const char* name, const char* why) { unused.emplace_back(name, why); };
  if (parameters.model == EchoModel::kPaper) {
    for (const char* group : {"receiver.", "beam.", "pulse.", "mirror."}) {
      add(group, "the paper's model has none");
    }
  } else {
    add("jitter.", "the acoustic model has none");
    add("noise_level_db", "of the paper's model alone");
    add("array_gain_db", "of the paper's model alone");
  }
  const JitterParameters<double>& jitter = parameters.jitter;
  if (jitter.sigma_range_m == 0.0 && jitter.sigma_azimuth_deg == 0.0) add("jitter.", "both errors are 0");
  const ReceiverParameters& receiver = parameters.receiver;
  if (receiver.gain_db == 0.0) add("receiver.gain_db", "is 0");
  if (receiver.time_varied_gain == TimeVariedGain::kNone) add("receiver.time_varied_gain", "is none");
  if (!receiver.noise_db) {
    add("receiver.noise_slope_db_per_m", "there is no such noise");
    add("receiver.noise_taper_db", "there is no such noise");
  }
  if (receiver.noise_slope_db_per_m == 0.0) add("receiver.noise_slope_db_per_m", "is 0");
  if (receiver.noise_taper_db.empty()) add("receiver.noise_taper_db", "is empty");
  if (!receiver.noise_after_gain_db) add("receiver.noise_after_gain_taper_db", "there is no such noise");
  if (receiver.noise_after_gain_taper_db.empty()) add("receiver.noise_after_gain_taper_db", "is empty");
  if (receiver.diffuse_share == 0.0) add("receiver.diffuse_share", "is 0");
  if (receiver.looks >= 1.0) add("receiver.diffuse_share", "there is no texture");
  const BeamParameters& beam = parameters.beam;
  if (beam.azimuth_pattern != AzimuthPattern::kAperture) add("beam.azimuth_taper", "of another pattern");
  if (beam.elevation_pattern != ElevationPattern::kAperture)
    add("beam.elevation_taper", "of another pattern");
  if (beam.azimuth_pattern != AzimuthPattern::kTable) add("beam.azimuth_table_db", "of another pattern");
  if (parameters.mirrors.empty() || beam.transmit_end_deg == 0.0) {
    add("beam.transmit_even_deg", "nothing is sent beyond the field of view");
    add("beam.transmit_end_deg", "nothing is sent beyond the field of view");
  }
  if (parameters.mirrors.empty()) add("beam.mirror_lobes", "there is no mirror");
  if (beam.sensitivity_db.empty()) add("beam.sensitivity_db", "is empty");
  const DisplayParameters<double>& display = parameters.display;
  if (display.law != DisplayLaw::kSoftLog && display.law != DisplayLaw::kSoftAmplitude)
    add("display.soft_db", "of another law");
  if (display.law != DisplayLaw::kPower) add("display.exponent", "of another law");
  if (parameters.noise_level_db == 0.0) add("noise_level_db", "is 0");
  if (parameters.array_gain_db == 0.0) add("array_gain_db", "is 0");
  add("source_level_sigma_db", "of a fit alone");
  for (const auto& [name, material] : parameters.materials)
    unused.emplace_back(fmt::format("material.{}.prior", name), "of a fit alone");
  return unused;
}

}  // namespace

ExportAccount::ExportAccount(const ExportSource& source) {
  Json json = data_io::ParametersJson(source.parameters);
  json.erase("format");
  Json sonar = data_io::SonarJson(source.sonar);
  sonar.erase("name");
  Flatten("sonar", sonar, lines_);
  Flatten("water", data_io::WaterJson(source.water), lines_);
  Flatten("absorption_db_per_m", source.absorption_db_per_m, lines_);
  for (const auto& [key, member] : json.items()) {
    if (key == "water") continue;  // already added, as resolved
    Flatten(key == "materials" ? "material" : key, member, lines_);
  }
  accounted_.assign(lines_.size(), false);
  for (const auto& [name, why] : Unused(source.parameters)) Account(name, Expression::kUnused, "", why);
}

void ExportAccount::Account(std::string_view name, Expression expression, const std::string& target,
                            const std::string& how) {
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    if (accounted_[i] || !IsOf(lines_[i].parameter, name)) continue;
    lines_[i].expression = expression;
    lines_[i].target = target;
    lines_[i].how = how;
    accounted_[i] = true;
  }
}

void ExportAccount::Exported(std::string_view name, const std::string& target, const std::string& how) {
  Account(name, Expression::kExported, target, how);
}

void ExportAccount::Approximated(std::string_view name, const std::string& target, const std::string& how) {
  Account(name, Expression::kApproximated, target, how);
}

void ExportAccount::NotExpressed(std::string_view name, const std::string& why) {
  Account(name, Expression::kNotExpressed, "", why);
}

const std::vector<AccountLine>& ExportAccount::Lines() const {
  for (std::size_t i = 0; i < lines_.size(); ++i) {
    SONARCAL_CHECK(accounted_[i], "nothing is said of what becomes of {}", lines_[i].parameter);
  }
  return lines_;
}

nlohmann::ordered_json ExportAccount::ToJson() const {
  std::map<Expression, int> counts;
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const AccountLine& line : Lines()) {
    ++counts[line.expression];
    nlohmann::ordered_json entry = {{"name", line.parameter},
                                    {"value", line.value},
                                    {"expression", std::string(ToString(line.expression))}};
    if (!line.target.empty()) entry["target"] = line.target;
    if (!line.how.empty()) entry["how"] = line.how;
    list.push_back(std::move(entry));
  }
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  for (const Expression expression :
       {Expression::kExported, Expression::kApproximated, Expression::kNotExpressed, Expression::kUnused}) {
    json[std::string(ToString(expression))] = counts[expression];
  }
  json["parameters"] = std::move(list);
  return json;
}

std::vector<std::string> ExportAccount::Sentences() const {
  // Groups by expression and reason, in the order of the first occurrence.
  std::vector<std::pair<std::pair<Expression, std::string>, std::vector<std::string>>> groups;
  for (const AccountLine& line : Lines()) {
    if (line.expression == Expression::kExported || line.expression == Expression::kUnused) continue;
    const std::pair reason(line.expression, line.how);
    auto group = groups.begin();
    while (group != groups.end() && group->first != reason) ++group;
    if (group == groups.end()) group = groups.insert(group, {reason, {}});
    group->second.push_back(line.parameter);
  }
  std::vector<std::string> sentences;
  for (const Expression expression : {Expression::kApproximated, Expression::kNotExpressed}) {
    const char* what = expression == Expression::kApproximated ? "approximated" : "not expressed";
    for (const auto& [reason, names] : groups) {
      if (reason.first == expression)
        sentences.push_back(fmt::format("{}: {}: {}", what, fmt::join(names, ", "), reason.second));
    }
  }
  return sentences;
}

}  // namespace sonarcal::exporting
