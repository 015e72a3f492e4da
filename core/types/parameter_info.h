// Physical parameters that describe themselves. Each key of params.json stands once, in
// core/types/parameter_table.h: meaning, unit, limits, scale and label. The reader and the writer of the
// file, the catalogue of a fit, the controls of the live view, the reference page and the schema are made
// from it.
//
//   VisitParameters(set.beam, [](const auto& info, const auto& value) { ... });   // ParameterInfo, member
//
// Visitors also get the groups below a group: ParameterGroupInfo, and a struct, a std::optional of one, or a
// std::map of them by name.
#pragma once

#include <concepts>
#include <limits>
#include <optional>
#include <string_view>
#include <type_traits>

#include "core/types/error.h"
#include "core/types/words.h"

namespace sonarcal {

// Image models that use a parameter.
struct ModelUse {
  bool paper = false;
  bool acoustic = false;
  bool coherent = false;
};
inline constexpr ModelUse kAllModels = {.paper = true, .acoustic = true, .coherent = true};
inline constexpr ModelUse kPaperModel = {.paper = true};
inline constexpr ModelUse kAcousticModel = {.acoustic = true};
inline constexpr ModelUse kEchoPowerModels = {.acoustic = true, .coherent = true};

// Logarithmic: a fit and a slider move the logarithm of the value, which stays positive.
enum class ParameterScale { kLinear, kLogarithmic };

// Meaning of the two limits of a fit.
enum class LimitUnit {
  kValue,         // the parameter's own unit
  kBeamSpacings,  // multiples of the mean beam spacing
  kRangeBins,     // multiples of a range bin
  kPerWindow,     // change over the whole range window; applies to the step too
  kBeyondBeams,   // deg beyond the outer edge of the beams
};

struct FitLimits {
  double lower = 0.0;
  double upper = 0.0;
  LimitUnit unit = LimitUnit::kValue;
};

// Limits and step of a control of the live view that do not follow from those of a fit or of the file.
struct ControlRange {
  double lower = 0.0;
  double upper = 0.0;
  double step = 1.0;
};

struct ParameterInfo {
  std::string_view key = {};         // in its group of params.json
  std::string_view meaning = {};     // one sentence without full stop, without unit and default
  std::string_view unit = {};        // "m", "deg", "dB"; "1" for a number without unit, empty for words
  std::string_view label = {};       // of the live view's control; empty: no control
  ModelUse models = kAllModels;      // without these, the key has no effect
  bool required = false;             // the reader refuses a group without the key
  std::string_view by_default = {};  // what happens without the key, if the member then holds no value
  std::string_view zero = {};        // meaning of 0, if 0 lies outside the limits of a fit
  double min = -std::numeric_limits<double>::infinity();  // limits of the file; of each item of a list
  double max = std::numeric_limits<double>::infinity();
  bool above_min = false;  // the limit `min` itself is refused
  int min_items = 0;       // of a list
  ParameterScale scale = ParameterScale::kLinear;
  double step = 1.0;                        // a surprising change of the value, or of its natural logarithm
  std::optional<FitLimits> paper_fit = {};  // absent: no fit of this model changes the parameter
  std::optional<FitLimits> acoustic_fit = {};
  std::optional<ControlRange> control = {};
};

// Groups of controls in the live view, in the order of the page.
enum class ParameterTopic { kLevels, kMaterials, kErrors, kReceiver, kBeam, kMirrors, kWater, kSonar };
constexpr auto WordsOf(std::type_identity<ParameterTopic>) {
  return Words<ParameterTopic, 8>{{{"Levels and display", ParameterTopic::kLevels},
                                   {"Materials", ParameterTopic::kMaterials},
                                   {"Range and azimuth errors", ParameterTopic::kErrors},
                                   {"Receiver and noise", ParameterTopic::kReceiver},
                                   {"Beam and pulse", ParameterTopic::kBeam},
                                   {"Mirrors (ghosts)", ParameterTopic::kMirrors},
                                   {"Water", ParameterTopic::kWater},
                                   {"Sonar", ParameterTopic::kSonar}}};
}

// An object of params.json.
struct ParameterGroupInfo {
  std::string_view key;              // in the group above
  std::string_view meaning;          // one sentence without full stop
  std::string_view by_default = {};  // what holds without the group
  ModelUse models = kAllModels;
  bool required = false;
  ParameterTopic topic = ParameterTopic::kLevels;
  std::string_view fit_name = {};  // in names of fit.json, if it is not `key`
};

// Specialised for each struct of parameters: a static member Visit(self, visit).
template <typename Group>
struct ParameterTable;

// Calls visit(info, member) for each member of a group, in the order of the file.
template <typename Group, typename Visitor>
void VisitParameters(Group& group, Visitor&& visit) {
  ParameterTable<std::remove_const_t<Group>>::Visit(group, visit);
}

// The member of a group that has this key and type, or holds this type. An optional member must have a value.
template <typename T, typename Group>
T& ParameterMember(Group& group, std::string_view key) {
  T* found = nullptr;
  VisitParameters(group, [&]<typename Info, typename Member>(const Info& info, Member& member) {
    if constexpr (std::same_as<Member, T>) {
      if (info.key == key) found = &member;
    } else if constexpr (std::same_as<Member, std::optional<T>>) {
      if (info.key == key) found = &member.value();
    }
  });
  SONARCAL_CHECK(found != nullptr, "a group has no such parameter");
  return *found;
}

}  // namespace sonarcal
