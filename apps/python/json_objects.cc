#include "apps/python/json_objects.h"

#include <pybind11/stl/filesystem.h>

#include <filesystem>

#include <nlohmann/json.hpp>

#include "data_io/parameters/parameters_io.h"

namespace sonarcal::python {
namespace {

namespace py = pybind11;

constexpr const char* kGiven = "the parameters given";  // in messages, in place of a file

py::object PlainValue(const py::object& value) {
  if (py::hasattr(value, "tolist")) return value.attr("tolist")();
  throw py::type_error(std::string(py::str(py::type::of(value).attr("__name__"))) + " is no JSON value");
}

}  // namespace

py::object ObjectFromJson(const std::string& text) {
  return py::module_::import("json").attr("loads")(text);
}

std::string JsonFromObject(const py::object& value) {
  const py::object dumps = py::module_::import("json").attr("dumps");
  return dumps(value, py::arg("default") = py::cpp_function(&PlainValue), py::arg("indent") = 1)
      .cast<std::string>();
}

py::object DictFromParameters(const ParameterSet& parameters) {
  return ObjectFromJson(data_io::ParametersJson(parameters).dump());
}

bool IsMapping(const py::handle& value) {
  return py::isinstance(value, py::module_::import("collections.abc").attr("Mapping"));
}

bool IsPath(const py::handle& value) {
  return py::isinstance<py::str>(value) || py::hasattr(value, "__fspath__");
}

ParameterSet ParametersFromObject(const py::object& source) {
  if (py::isinstance<ParameterSet>(source)) return source.cast<ParameterSet>();
  if (IsMapping(source)) return data_io::ParseParameters(JsonFromObject(source), kGiven);
  if (!IsPath(source)) {
    throw py::type_error("parameters: expected a dict, a path or Parameters, not " +
                         std::string(py::str(py::type::of(source).attr("__name__"))));
  }
  return data_io::ReadParameters(source.cast<std::filesystem::path>());
}

ParameterSet StartFromObject(const py::object& source, const std::vector<NamedMaterial>& materials) {
  if (IsMapping(source)) return data_io::ParseStartParameters(JsonFromObject(source), kGiven, materials);
  if (IsPath(source)) return data_io::ReadStartParameters(source.cast<std::filesystem::path>(), materials);
  return ParametersFromObject(source);
}

}  // namespace sonarcal::python
