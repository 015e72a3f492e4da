// Options structs (core/types/option.h) as Python classes. Names, defaults, limits and help texts come from
// the struct's Visit.
//
//   BindOptions<workflow::FitOptions>(module, "FitOptions", "Options of fit().");
//
//   options = sonarcal.FitOptions({"starts": 2}, free=["materials"])
//   options.starts, options == sonarcal.FitOptions(options), sonarcal.FitOptions.describe()
#pragma once

#include <fmt/format.h>
#include <pybind11/pybind11.h>

#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "apps/python/option_objects.h"
#include "core/types/option.h"

namespace sonarcal::python {

// An option as Python knows it.
struct OptionDescription {
  OptionInfo info;
  std::string type;   // accepted values, such as "(low, high) in m"
  std::string input;  // annotations of the type stub
  std::string output;
  pybind11::object by_default;

  // "Ranges where the object may be. (low, high) in m; default None."
  std::string Text() const;
  pybind11::dict Dict() const;
};

template <typename T>
OptionDescription Describe(const OptionInfo& info, const T& by_default) {
  using Object = OptionObject<T>;
  return {.info = info,
          .type = Object::Type() + (info.unit.empty() ? "" : " in " + info.unit),
          .input = Object::Input(),
          .output = Object::Output(),
          .by_default = Object::To(by_default)};
}

// All options of a class, in the order of Visit.
template <typename Options>
std::vector<OptionDescription> DescribeOptions() {
  std::vector<OptionDescription> descriptions;
  const Options by_default{};
  Options::Visit(by_default, [&](const OptionInfo& info, const auto& value) {
    descriptions.push_back(Describe(info, value));
  });
  return descriptions;
}

// Raises TypeError for a name that is no option of `class_name`, with the nearest one that is.
[[noreturn]] void RaiseUnknownOption(const std::string& class_name, const std::string& name,
                                     const pybind11::list& names);

// Addresses of the options, in the order of Visit. Objects of one class have options of the same types in the
// same order. A visit within a visit would do as well, but it is compiled once for each type of an option.
template <typename Options>
std::vector<const void*> OptionAddresses(const Options& options) {
  std::vector<const void*> addresses;
  Options::Visit(options, [&](const OptionInfo&, const auto& value) { addresses.push_back(&value); });
  return addresses;
}

template <typename Options>
pybind11::list OptionNames() {
  pybind11::list names;
  const Options by_default{};
  Options::Visit(by_default, [&](const OptionInfo& info, const auto&) { names.append(info.name); });
  return names;
}

template <typename Options>
pybind11::object GetOption(const Options& options, std::string_view name) {
  pybind11::object object;
  Options::Visit(options, [&](const OptionInfo& info, const auto& value) {
    if (info.name == name) object = OptionObject<std::remove_cvref_t<decltype(value)>>::To(value);
  });
  return object;
}

// None stands for the default. Throws UsageError as OptionFromObject.
template <typename Options>
void SetOption(Options& options, std::string_view name, const pybind11::object& object) {
  const Options by_default{};
  const std::vector<const void*> defaults = OptionAddresses(by_default);
  auto default_value = defaults.begin();
  Options::Visit(options, [&](const OptionInfo& info, auto& value) {
    using T = std::remove_cvref_t<decltype(value)>;
    const auto* const own_default = static_cast<const T*>(*default_value++);
    if (info.name == name) value = object.is_none() ? *own_default : OptionFromObject<T>(info, object);
  });
}

// Sets the options that `values` names.
template <typename Options>
void SetOptions(Options& options, const pybind11::dict& values, const std::string& class_name) {
  const pybind11::list names = OptionNames<Options>();
  for (const auto& [key, value] : values) {
    const std::string name = pybind11::str(key);
    if (!names.contains(name)) RaiseUnknownOption(class_name, name, names);
    SetOption(options, name, pybind11::reinterpret_borrow<pybind11::object>(value));
  }
}

// Options that differ from the default, as keyword arguments: "starts=2, free=['materials']".
template <typename Options>
std::string ChangedOptions(const Options& options) {
  const Options by_default{};
  const std::vector<const void*> defaults = OptionAddresses(by_default);
  auto default_value = defaults.begin();
  std::string text;
  Options::Visit(options, [&](const OptionInfo& info, const auto& value) {
    using T = std::remove_cvref_t<decltype(value)>;
    if (!IsSame(value, *static_cast<const T*>(*default_value++)))
      text += fmt::format("{}{}={}", text.empty() ? "" : ", ", info.name, ReprOf(value));
  });
  return text;
}

template <typename Options>
bool AreSame(const Options& a, const Options& b) {
  const std::vector<const void*> others = OptionAddresses(b);
  auto other = others.begin();
  bool same = true;
  Options::Visit(a, [&](const OptionInfo&, const auto& value) {
    using T = std::remove_cvref_t<decltype(value)>;
    same = IsSame(value, *static_cast<const T*>(*other++)) && same;
  });
  return same;
}

// `source`: None, options to copy, or a dict of them.
template <typename Options>
Options MakeOptions(const pybind11::object& source, const pybind11::dict& changes,
                    const std::string& class_name) {
  Options options{};
  if (pybind11::isinstance<Options>(source)) {
    options = source.cast<const Options&>();
  } else if (IsMapping(source)) {
    SetOptions(options, pybind11::dict(source), class_name);
  } else if (!source.is_none()) {
    throw pybind11::type_error(
        fmt::format("{0}: expected {0}, a dict or None, not {1}", class_name,
                    std::string(pybind11::str(pybind11::type::of(source).attr("__name__")))));
  }
  SetOptions(options, changes, class_name);
  return options;
}

template <typename Options>
void BindOptions(pybind11::module_& module, const char* name, const char* doc) {
  namespace py = pybind11;
  const std::string class_name = name;
  const std::string made =
      "\n\nMade from keywords, a dict of them, or other options. None stands for the default.";
  py::class_<Options> options(module, name, (doc + made).c_str());
  options.def(py::init([class_name](const py::object& source, const py::kwargs& changes) {
                return MakeOptions<Options>(source, changes, class_name);
              }),
              py::arg("source") = py::none());
  for (const OptionDescription& description : DescribeOptions<Options>()) {
    const std::string& option = description.info.name;
    options.def_property(
        option.c_str(), [option](const Options& self) { return GetOption(self, option); },
        [option](Options& self, const py::object& object) { SetOption(self, option, object); },
        description.Text().c_str());
  }
  options
      .def_static(
          "describe",
          [] {
            py::list descriptions;
            for (const OptionDescription& description : DescribeOptions<Options>())
              descriptions.append(description.Dict());
            return descriptions;
          },
          "All options in their order, each a dict: name, help, type, unit, default, by_default, min, max "
          "and text.")
      .def(
          "to_dict",
          [](const Options& self) {
            py::dict dict;
            for (const py::handle option : OptionNames<Options>())
              dict[option] = GetOption(self, option.cast<std::string>());
            return dict;
          },
          "All options by name. The class takes this dict.")
      .def(
          "__eq__", [](const Options& self, const Options& other) { return AreSame(self, other); },
          py::arg("other"), py::is_operator())
      .def("__repr__",
           [class_name](const Options& self) { return class_name + "(" + ChangedOptions(self) + ")"; });
}

// A sentence for the command line with options as keywords: "--frozen-speckle" becomes "frozen_speckle".
std::string WithKeywords(const std::string& sentence);

}  // namespace sonarcal::python
