// JSON form of groups of parameters (core/types/parameter_info.h): an object with one key per member.
// Limits, and the keys that are required, are those of the table.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/types/parameter_info.h"
#include "core/types/parameters.h"
#include "core/types/words.h"
#include "data_io/json/json_reader.h"

namespace sonarcal::data_io {

inline NumberRange RangeOf(const ParameterInfo& info) {
  return {.min = info.min, .max = info.max, .min_excluded = info.above_min};
}

namespace internal {

inline void ReadMember(const JsonReader& json, const ParameterInfo& info, double& value) {
  value = json.Number(RangeOf(info));
}

inline void ReadMember(const JsonReader& json, const ParameterInfo& info, std::optional<double>& value) {
  value = json.Number(RangeOf(info));
}

inline void ReadMember(const JsonReader& json, const ParameterInfo& info, std::optional<int>& value) {
  value = static_cast<int>(json.Integer(static_cast<int>(info.min), static_cast<int>(info.max)));
}

inline void ReadMember(const JsonReader& json, const ParameterInfo& info, std::vector<double>& values) {
  values = json.Numbers(RangeOf(info));
}

inline void ReadMember(const JsonReader& json, const ParameterInfo&, std::string& text) {
  text = json.String();
}

template <HasWords E>
void ReadMember(const JsonReader& json, const ParameterInfo&, E& value) {
  value = json.Word<E>();
}

template <typename Group>
void ReadMember(const JsonReader& json, const ParameterGroupInfo&, Group& group) {
  ReadGroup(json, group);
}

// Whether a value is there. An empty text counts as absent, and an empty list that could not be read back.
template <typename Info, typename T>
bool IsPresent(const Info& info, const T& value) {
  if constexpr (requires { value.has_value(); }) {
    return value.has_value();
  } else if constexpr (std::is_same_v<T, std::vector<double>>) {
    return static_cast<int>(value.size()) >= info.min_items;
  } else if constexpr (std::is_same_v<T, std::string>) {
    return !value.empty();
  } else {
    return true;
  }
}

}  // namespace internal

// Reads the keys that are there; the other members keep their values. Throws DataError with file, line and
// key for a required key that is missing and a value out of its limits.
template <typename Group>
void ReadGroup(const JsonReader& json, Group& group) {
  VisitParameters(group, [&](const auto& info, auto& member) {
    const auto found = info.required ? std::optional(json.At(info.key)) : json.Find(info.key);
    if (found) internal::ReadMember(*found, info, member);
  });
}

template <typename Group>
void ReadGroup(const JsonReader& json, std::optional<Group>& group) {
  ReadGroup(json, group.emplace());
}

template <typename Group>
void ReadGroup(const JsonReader& json, std::map<std::string, Group>& groups) {
  for (const auto& [name, member] : json.Members(kMaxMaterials)) ReadGroup(member, groups[name]);
}

// Writes a member, or the members of a group. Absent optional members are left out.
template <typename T>
nlohmann::ordered_json MemberJson(const T& value) {
  using Json = nlohmann::ordered_json;
  if constexpr (HasWords<T>) {
    return ToString(value);
  } else if constexpr (std::is_arithmetic_v<T> || std::is_same_v<T, std::string> ||
                       std::is_same_v<T, std::vector<double>>) {
    return value;
  } else if constexpr (requires { value.has_value(); }) {
    return MemberJson(*value);
  } else if constexpr (requires { typename T::mapped_type; }) {
    Json json = Json::object();
    for (const auto& [name, member] : value) json[name] = MemberJson(member);
    return json;
  } else {
    Json json = Json::object();
    VisitParameters(value, [&](const auto& info, const auto& member) {
      if (internal::IsPresent(info, member)) json[std::string(info.key)] = MemberJson(member);
    });
    return json;
  }
}

}  // namespace sonarcal::data_io
