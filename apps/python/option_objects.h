// Values of options (core/types/option.h) as Python objects.
#pragma once

#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "apps/python/json_objects.h"
#include "apps/workflow/comparison_options.h"
#include "calib/parameters/fit_config.h"
#include "core/text/nearest_word.h"
#include "core/types/error.h"
#include "core/types/frame_list.h"
#include "core/types/mask.h"
#include "core/types/option.h"
#include "core/types/option_text.h"

namespace sonarcal::python {

// Specialised for each type that an option may have.
//
//   From        reads all of `object`; returns false if it cannot
//   To          the inverse of From
//   Type        the values in help texts, such as "(low, high)"
//   Input       annotation of accepted values in the type stub
//   Output      annotation of the attribute in the type stub
//
// From may throw DataError for files and dicts whose content is wrong.
template <typename T>
struct OptionObject;

// None of these takes a bool for a number, or a text.
bool ReadNumber(const pybind11::object& object, double& value);
bool ReadInteger(const pybind11::object& object, std::int64_t& value);
bool ReadUnsigned(const pybind11::object& object, std::uint64_t& value);

// Items of a list, tuple, array or other iterable; nothing for texts, dicts and what cannot be iterated.
std::optional<std::vector<pybind11::object>> ItemsOf(const pybind11::object& object);

// str(object), cut to a length that fits into a sentence.
std::string ShortText(const pybind11::object& object);

template <>
struct OptionObject<bool> {
  static bool From(const pybind11::object& object, bool& value);
  static pybind11::object To(bool value) { return pybind11::bool_(value); }
  static std::string Type() { return "bool"; }
  static std::string Input() { return "bool"; }
  static std::string Output() { return "bool"; }
};

template <typename T>
requires std::is_floating_point_v<T>
struct OptionObject<T> {
  static bool From(const pybind11::object& object, T& value) { return ReadNumber(object, value); }
  static pybind11::object To(T value) { return pybind11::float_(value); }
  static std::string Type() { return "float"; }
  static std::string Input() { return "float"; }
  static std::string Output() { return "float"; }
};

template <typename T>
requires std::is_integral_v<T>
struct OptionObject<T> {
  static bool From(const pybind11::object& object, T& value) {
    std::conditional_t<std::is_unsigned_v<T>, std::uint64_t, std::int64_t> number = 0;
    if constexpr (std::is_unsigned_v<T>) {
      if (!ReadUnsigned(object, number)) return false;
    } else {
      if (!ReadInteger(object, number)) return false;
    }
    value = static_cast<T>(number);
    return std::in_range<T>(number);
  }
  static pybind11::object To(T value) { return pybind11::int_(value); }
  static std::string Type() { return "int"; }
  static std::string Input() { return "int"; }
  static std::string Output() { return "int"; }
};

// A word. Text is read by OptionText.
template <HasWords E>
struct OptionObject<E> {
  static bool From(const pybind11::object&, E&) { return false; }
  static pybind11::object To(E value) { return pybind11::str(std::string(ToString(value))); }
  static std::string Type() { return "'" + JoinedWords<E>("', '") + "'"; }
  static std::string Input() { return "str"; }
  static std::string Output() { return "str"; }
};

// Empty text is None. Text is read by OptionText.
template <>
struct OptionObject<std::string> {
  static bool From(const pybind11::object&, std::string&) { return false; }
  static pybind11::object To(const std::string& value) {
    return value.empty() ? pybind11::object(pybind11::none()) : pybind11::str(value);
  }
  static std::string Type() { return "str"; }
  static std::string Input() { return "Optional[str]"; }
  static std::string Output() { return "Optional[str]"; }
};

namespace internal {

template <typename T>
bool ReadPair(const pybind11::object& object, T& first, T& second) {
  const auto items = ItemsOf(object);
  return items && items->size() == 2 && OptionObject<T>::From((*items)[0], first) &&
         OptionObject<T>::From((*items)[1], second);
}

}  // namespace internal

template <typename T>
struct OptionObject<GridSize<T>> {
  static bool From(const pybind11::object& object, GridSize<T>& value) {
    return internal::ReadPair(object, value.rows, value.cols);
  }
  static pybind11::object To(const GridSize<T>& value) {
    return pybind11::make_tuple(value.rows, value.cols);
  }
  static std::string Type() { return "(range bins, beams)"; }
  static std::string Input() { return "_Size"; }
  static std::string Output() { return fmt::format("tuple[{0}, {0}]", OptionObject<T>::Output()); }
};

template <>
struct OptionObject<RayGridSize> {
  static bool From(const pybind11::object& object, RayGridSize& value) {
    return internal::ReadPair(object, value.cols, value.rows) && value.cols > 0 && value.rows > 0;
  }
  static pybind11::object To(const RayGridSize& value) {
    return pybind11::make_tuple(value.cols, value.rows);
  }
  static std::string Type() { return "(columns, rows)"; }
  static std::string Input() { return "_Size"; }
  static std::string Output() { return "tuple[int, int]"; }
};

template <>
struct OptionObject<Interval> {
  static bool From(const pybind11::object& object, Interval& value) {
    return internal::ReadPair(object, value.low, value.high) && value.low < value.high;
  }
  static pybind11::object To(const Interval& value) { return pybind11::make_tuple(value.low, value.high); }
  static std::string Type() { return "(low, high)"; }
  static std::string Input() { return "_Interval"; }
  static std::string Output() { return "tuple[float, float]"; }
};

template <>
struct OptionObject<metrics::PolygonCorner> {
  static bool From(const pybind11::object& object, metrics::PolygonCorner& value) {
    return internal::ReadPair(object, value.range_m, value.azimuth_deg);
  }
  static pybind11::object To(const metrics::PolygonCorner& value) {
    return pybind11::make_tuple(value.range_m, value.azimuth_deg);
  }
  static std::string Type() { return "(range in m, azimuth in degrees)"; }
  static std::string Input() { return "Sequence[float]"; }
  static std::string Output() { return "tuple[float, float]"; }
};

template <typename T>
struct OptionObject<std::optional<T>> {
  static bool From(const pybind11::object& object, std::optional<T>& value) {
    return OptionObject<T>::From(object, value.emplace());
  }
  static pybind11::object To(const std::optional<T>& value) {
    return value ? OptionObject<T>::To(*value) : pybind11::object(pybind11::none());
  }
  static std::string Type() { return OptionObject<T>::Type(); }
  static std::string Input() { return fmt::format("Optional[{}]", OptionObject<T>::Input()); }
  static std::string Output() { return fmt::format("Optional[{}]", OptionObject<T>::Output()); }
};

// No items are None. Text, items separated by commas, is read by OptionText.
template <typename T>
struct OptionObject<std::vector<T>> {
  static bool From(const pybind11::object& object, std::vector<T>& value) {
    const auto items = ItemsOf(object);
    if (!items) return false;
    for (const pybind11::object& item : *items) {
      T read{};
      const bool is_read = pybind11::isinstance<pybind11::str>(item) && !std::is_arithmetic_v<T>
                               ? OptionText<T>::Parse(item.cast<std::string>(), read)
                               : OptionObject<T>::From(item, read);
      if (!is_read) return false;
      value.push_back(std::move(read));
    }
    return true;
  }
  static pybind11::object To(const std::vector<T>& value) {
    if (value.empty()) return pybind11::none();
    pybind11::list list;
    for (const T& item : value) list.append(OptionObject<T>::To(item));
    return list;
  }
  static std::string Type() { return "list of " + OptionObject<T>::Type(); }
  static std::string Input() {
    return fmt::format("Optional[Union[str, Sequence[{}]]]", OptionObject<T>::Input());
  }
  static std::string Output() { return fmt::format("Optional[list[{}]]", OptionObject<T>::Output()); }
};

// No frames are None, and a list that is open to the last frame is a text. Text is read by OptionText.
template <>
struct OptionObject<FrameList> {
  static bool From(const pybind11::object& object, FrameList& value);
  static pybind11::object To(const FrameList& value);
  static std::string Type() { return "list of int, or text such as '3,80:'"; }
  static std::string Input() { return "Optional[Union[str, Sequence[int]]]"; }
  static std::string Output() { return "Union[list[int], str, None]"; }
};

template <>
struct OptionObject<FromFile<ParameterSet>> {
  static bool From(const pybind11::object& object, FromFile<ParameterSet>& value);
  static pybind11::object To(const FromFile<ParameterSet>& value);
  static std::string Type() { return "Parameters, dict or path"; }
  static std::string Input() { return "Union[Parameters, Mapping[str, Any], _Path, None]"; }
  static std::string Output() { return "Optional[Parameters]"; }
};

template <>
struct OptionObject<FromFile<calib::FitConfig>> {
  static bool From(const pybind11::object& object, FromFile<calib::FitConfig>& value);
  static pybind11::object To(const FromFile<calib::FitConfig>& value);
  static std::string Type() { return "dict or path"; }
  static std::string Input() { return "Union[Mapping[str, Any], _Path, None]"; }
  static std::string Output() { return "Optional[dict[str, Any]]"; }
};

template <>
struct OptionObject<FromFile<std::string>> {
  static bool From(const pybind11::object& object, FromFile<std::string>& value);
  static pybind11::object To(const FromFile<std::string>& value);
  static std::string Type() { return "dict or path"; }
  static std::string Input() { return "Union[Mapping[str, Any], _Path, None]"; }
  static std::string Output() { return "Optional[dict[str, Any]]"; }
};

template <>
struct OptionObject<FromFile<Mask>> {
  static bool From(const pybind11::object& object, FromFile<Mask>& value);
  static pybind11::object To(const FromFile<Mask>& value);
  static std::string Type() { return "array (range bins, beams) or path"; }
  static std::string Input() { return "Union[ArrayLike, _Path, None]"; }
  static std::string Output() { return "Optional[NDArray[np.uint8]]"; }
};

// End of an error message. Numbers, words and texts are named as on the command line.
template <typename T>
std::string ExpectedObject() {
  if constexpr (std::is_same_v<T, bool>) {
    return "True or False";
  } else if constexpr (std::is_arithmetic_v<T> || HasWords<T> || std::is_same_v<T, std::string>) {
    return OptionText<T>::kExpected;
  } else if constexpr (std::is_same_v<T, RayGridSize>) {
    return OptionObject<T>::Type() + ", both above 0";
  } else if constexpr (std::is_same_v<T, Interval>) {
    return OptionObject<T>::Type() + ", low below high";
  } else {
    return OptionObject<T>::Type();
  }
}

template <typename T>
struct IsOptional : std::false_type {};
template <typename T>
struct IsOptional<std::optional<T>> : std::true_type {};

template <typename T>
struct IsFromFile : std::false_type {};
template <typename T>
struct IsFromFile<FromFile<T>> : std::true_type {};

// Throws UsageError naming option, value and what is expected; DataError as OptionObject::From.
template <typename T>
T OptionFromObject(const OptionInfo& info, const pybind11::object& object) {
  if constexpr (IsOptional<T>::value) {
    return OptionFromObject<typename T::value_type>(info, object);
  } else {
    T value{};
    bool is_read = false;
    std::string expected = ExpectedObject<T>();
    constexpr bool kReadsText = !std::is_arithmetic_v<T> && !IsFromFile<T>::value;
    if constexpr (kReadsText) {
      if (pybind11::isinstance<pybind11::str>(object)) {
        is_read = OptionText<T>::Parse(object.cast<std::string>(), value);
        expected = OptionText<T>::kExpected;
      } else {
        is_read = OptionObject<T>::From(object, value);
      }
    } else {
      is_read = OptionObject<T>::From(object, value);
    }
    if (!is_read) throw UsageError("{} {}", info.name, UnknownWord(ShortText(object), expected));
    if (!IsWithin(info, value))
      throw UsageError("{} {}{}", info.name, ShortText(object), ExpectedNumberText(info));
    return value;
  }
}

template <typename T>
bool IsSame(const T& a, const T& b) {
  return a == b;
}

template <typename T>
bool IsSame(const FromFile<T>& a, const FromFile<T>& b) {
  return a.value == b.value;
}

// As in Python code; "..." stands for values that are too long.
template <typename T>
std::string ReprOf(const T& value) {
  return pybind11::repr(OptionObject<T>::To(value)).template cast<std::string>();
}

template <typename T>
std::string ReprOf(const FromFile<T>& value) {
  if (!value.file.empty()) return fmt::format("'{}'", value.file.string());
  return std::is_same_v<T, calib::FitConfig> ? ReprOf<FromFile<T>>(value) : std::string("...");
}

}  // namespace sonarcal::python
