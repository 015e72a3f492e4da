#include "data_io/parameters/parameter_reference.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <type_traits>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/types/parameter_table.h"
#include "data_io/parameters/parameters_io.h"

namespace sonarcal::data_io {
namespace {

using Json = nlohmann::ordered_json;

template <typename T>
constexpr bool kIsList = std::is_same_v<T, std::vector<double>>;

// A group of which each material has one, and a group that may be absent, as their members.
template <typename Group>
const Group& Prototype(const Group& group) {
  return group;
}
template <typename Group>
Group Prototype(const std::map<std::string, Group>&) {
  return {};
}
template <typename Group>
Group Prototype(const std::optional<Group>&) {
  return {};
}

// "-500", "0.125", "1e30", "1e-7".
std::string NumberText(double value) {
  const double size = std::abs(value);
  if (size == 0.0 || (size > 1e-4 && size < 1e9)) return fmt::format("{}", value);
  const int exponent = static_cast<int>(std::floor(std::log10(size)));
  return fmt::format("{:g}e{}", value / std::pow(10.0, exponent), exponent);
}

std::string UnitText(std::string_view unit) {
  return unit == "C" ? "°C" : std::string(unit);
}

// --- Markdown

std::string ModelsText(const ModelUse& use) {
  std::string text = use.paper ? "P " : "";
  if (use.acoustic) text += "A ";
  if (use.coherent) text += "C ";
  return text.substr(0, text.size() - 1);
}

template <typename T>
std::string DefaultText(const ParameterInfo& info, const T& value) {
  if (info.required) return "required";
  if constexpr (HasWords<T>) {
    return fmt::format("`{}`", ToString(value));
  } else if constexpr (std::is_arithmetic_v<T>) {
    return NumberText(value) + (value == 0.0 && !info.zero.empty() ? fmt::format(": {}", info.zero) : "");
  } else {
    return fmt::format("{}: {}", kIsList<T> && info.min_items == 0 ? "empty" : "absent", info.by_default);
  }
}

template <typename T>
std::string LimitsText(const ParameterInfo& info, const T&) {
  if constexpr (HasWords<T>) {
    return fmt::format("`{}`", JoinedWords<T>("`, `"));
  } else if constexpr (std::is_same_v<T, std::string>) {
    return "text";
  } else {
    std::string text = kIsList<T> ? "list, " : "";
    if (info.min_items > 0) text += fmt::format("{} or more, ", info.min_items);
    return text +
           fmt::format("{}{} .. {}", info.above_min ? "> " : "", NumberText(info.min), NumberText(info.max));
  }
}

std::string Row(std::string_view key, std::string_view meaning, std::string_view unit,
                std::string_view by_default, std::string_view limits, const ModelUse& models) {
  std::string row = fmt::format("| `{}` |", key);
  for (const std::string_view cell : {meaning, unit, by_default, limits}) {
    row += cell.empty() ? " |" : fmt::format(" {} |", cell);
  }
  return row + fmt::format(" {} |\n", ModelsText(models));
}

// Rows of the members of a group. Groups below it are listed, or replaced by their members.
template <typename Group>
std::string Rows(const Group& group, bool list_groups = false) {
  std::string rows;
  VisitParameters(group, [&]<typename Info, typename T>(const Info& info, const T& value) {
    if constexpr (std::is_same_v<Info, ParameterInfo>) {
      rows += Row(info.key, info.meaning, UnitText(info.unit), DefaultText(info, value),
                  LimitsText(info, value), info.models);
    } else if (list_groups) {
      std::string count;
      if constexpr (requires { typename T::mapped_type; })
        count = fmt::format("{} to {}", info.required ? 1 : 0, kMaxMaterials);
      rows +=
          Row(info.key, info.meaning, "", info.required ? "required" : info.by_default, count, info.models);
    } else {
      rows += Rows(Prototype(value));
    }
  });
  return rows;
}

// --- JSON Schema

// Sentences in plain text.
template <typename Info>
std::string Description(const Info& info) {
  std::string text = fmt::format("{}.", info.meaning);
  if constexpr (std::is_same_v<Info, ParameterInfo>) {
    if (!info.unit.empty() && info.unit != "1") text += fmt::format(" Unit: {}.", info.unit);
    if (!info.required && !info.zero.empty()) text += fmt::format(" 0: {}.", info.zero);
  }
  if (!info.models.paper)
    text += info.models.coherent ? " Acoustic and coherent models." : " Acoustic model.";
  if (!info.models.acoustic) text += " Paper model.";
  if (!info.by_default.empty()) text += fmt::format(" Absent: {}.", info.by_default);
  std::erase(text, '`');
  return text;
}

Json TypeOf(const char* type, bool required) {
  return required ? Json(type) : Json::array({type, "null"});
}

void AddLimits(const ParameterInfo& info, Json& json) {
  json[info.above_min ? "exclusiveMinimum" : "minimum"] = info.min;
  json["maximum"] = info.max;
}

template <typename Group>
Json Schema(const ParameterGroupInfo& info, const Group& group);

template <typename T>
Json Schema(const ParameterInfo& info, const T& value) {
  Json json = Json::object();
  if constexpr (HasWords<T>) {
    for (const auto& [word, meaning] : WordsOf(std::type_identity<T>{})) json["enum"].push_back(word);
    if (!info.required) {
      json["enum"].push_back(nullptr);
      json["default"] = ToString(value);
    }
  } else if constexpr (kIsList<T>) {
    json["type"] = TypeOf("array", info.required);
    json["items"] = {{"type", "number"}};
    AddLimits(info, json["items"]);
    if (info.min_items > 0) json["minItems"] = info.min_items;
  } else if constexpr (std::is_same_v<T, std::string>) {
    json["type"] = TypeOf("string", info.required);
  } else {
    json["type"] = TypeOf("number", info.required);
    AddLimits(info, json);
    if constexpr (std::is_arithmetic_v<T>) {
      if (!info.required) json["default"] = value;
    }
  }
  json["description"] = Description(info);
  return json;
}

// Adds the members of a group, and which of them are required.
template <typename Group>
void AddMembers(const Group& group, Json& json) {
  Json required = json.value("required", Json::array());
  Json properties = json.value("properties", Json::object());
  VisitParameters(group, [&](const auto& info, const auto& value) {
    if (info.required) required.push_back(info.key);
    properties[std::string(info.key)] = Schema(info, value);
  });
  if (!required.empty()) json["required"] = required;
  json["additionalProperties"] = false;
  json["properties"] = properties;
}

template <typename Group>
Json Schema(const ParameterGroupInfo& info, const Group& group) {
  Json json = {{"type", TypeOf("object", info.required)}};
  json["description"] = Description(info);
  if constexpr (requires { typename Group::mapped_type; }) {
    Json member = {{"type", "object"}};
    AddMembers(typename Group::mapped_type(), member);
    if (info.required) json["minProperties"] = 1;
    json["maxProperties"] = kMaxMaterials;
    json["additionalProperties"] = member;
  } else {
    AddMembers(Prototype(group), json);
  }
  return json;
}

// --- limits of a fit

std::string LimitUnitText(const ParameterInfo& info) {
  switch (info.acoustic_fit->unit) {
    case LimitUnit::kValue:
      break;
    case LimitUnit::kBeamSpacings:
      return "beam spacings";
    case LimitUnit::kRangeBins:
      return "range bins";
    case LimitUnit::kPerWindow:
      return "dB over the range window";
    case LimitUnit::kBeyondBeams:
      return "deg beyond the outer beam";
  }
  return std::string(info.unit);
}

template <typename Group>
void AddFitLimits(const Group& group, const std::string& prefix, std::string& text) {
  VisitParameters(group, [&]<typename Info, typename T>(const Info& info, const T& value) {
    if constexpr (std::is_same_v<Info, ParameterInfo>) {
      if (!info.acoustic_fit) return;
      text += fmt::format("| `{}{}` | {} | {} | {} | {} |\n", prefix, info.key, LimitUnitText(info),
                          NumberText(info.acoustic_fit->lower), NumberText(info.acoustic_fit->upper),
                          info.scale == ParameterScale::kLogarithmic ? "yes" : "no");
    } else {
      std::string below = fmt::format("{}{}.", prefix, info.fit_name.empty() ? info.key : info.fit_name);
      if constexpr (requires { typename T::mapped_type; }) below += "<name>.";
      AddFitLimits(Prototype(value), below, text);
    }
  });
}

}  // namespace

Json ParametersSchema() {
  Json json = {
      {"$schema", "https://json-schema.org/draft/2020-12/schema"},
      {"title", fmt::format("params.json, {}", kParametersFormat)},
      {"description",
       "Physical parameters of a simulation (docs/reference/parameters.md). Unknown keys are refused. A key "
       "whose value is null counts as absent. The reader also refuses what a schema cannot state: db_max not "
       "above db_min, transmit_end_deg below transmit_even_deg, an even number of values in "
       "azimuth_table_db, a key given twice."},
      {"type", "object"},
      {"required", {"format"}},
      {"properties",
       {{"format", {{"const", kParametersFormat}, {"description", "Name and version of the format."}}}}}};
  const ParameterSet defaults;
  AddMembers(defaults, json);
  // Only the start of a fit may lack it.
  Json& material = json["properties"]["materials"]["additionalProperties"];
  material["required"] = Json::array({"gsab"});
  material["properties"]["gsab"]["type"] = "object";
  Json& beam = json["properties"]["beam"];
  beam["if"] = {{"properties", {{"azimuth_pattern", {{"const", ToString(AzimuthPattern::kTable)}}}}},
                {"required", {"azimuth_pattern"}}};
  beam["then"] = {{"properties", {{"azimuth_table_db", {{"type", "array"}}}}},
                  {"required", {"azimuth_table_db"}}};
  return json;
}

std::string ParametersTables() {
  constexpr const char* kHead =
      "| key | meaning | unit | default | limits | models |\n|---|---|---|---|---|---|\n";
  const ParameterSet defaults;
  std::string text = fmt::format("## Root\n\n{}", kHead);
  text += Row("format", fmt::format("Name and version of the format: `{}`", kParametersFormat), "",
              "required", "", kAllModels);
  text += Rows(defaults, true);
  VisitParameters(defaults, [&]<typename Info>(const Info& info, const auto& value) {
    if constexpr (std::is_same_v<Info, ParameterGroupInfo>) {
      text += fmt::format("\n## {}\n\n{}{}", info.key, kHead, Rows(Prototype(value)));
    }
  });
  return text;
}

std::string AcousticFitLimitsTable() {
  std::string text = "| parameter | unit | lower | upper | fitted as logarithm |\n|---|---|---|---|---|\n";
  const ParameterSet defaults;
  AddFitLimits(defaults, "", text);
  return text;
}

}  // namespace sonarcal::data_io
