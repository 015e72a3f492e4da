#include <fmt/format.h>
#include <pybind11/stl/filesystem.h>

#include "apps/commands/scenes_command.h"
#include "apps/python/bindings.h"
#include "apps/python/json_objects.h"
#include "data_io/parameters/parameters_io.h"

namespace sonarcal::python {
namespace {

namespace py = pybind11;

std::string Materials(const ParameterSet& parameters) {
  std::string names;
  for (const auto& [name, material] : parameters.materials) names += (names.empty() ? "" : ", ") + name;
  return names;
}

}  // namespace

void BindParameters(py::module_& module) {
  py::class_<ParameterSet>(
      module, "Parameters",
      "Physical parameters of a simulation, the content of params.json. Made from a dict, from the path of a "
      "file,\n"
      "or from other Parameters. Functions that take parameters take any of these.")
      .def(py::init(&ParametersFromObject), py::arg("source"))
      .def("to_dict", &DictFromParameters, "All groups as a dict in the form of params.json, with defaults.")
      .def(
          "save",
          [](const ParameterSet& parameters, const std::filesystem::path& file) {
            data_io::WriteParameters(file, parameters);
          },
          py::arg("file"), py::call_guard<py::gil_scoped_release>(),
          "Writes params.json, whole or not at all.")
      .def(
          "__getitem__",
          [](const ParameterSet& parameters, const py::object& key) {
            return DictFromParameters(parameters)[key].cast<py::object>();
          },
          py::arg("key"))
      .def(
          "__eq__", [](const ParameterSet& a, const ParameterSet& b) { return a == b; }, py::arg("other"),
          py::is_operator())
      .def("__repr__", [](const ParameterSet& parameters) {
        return fmt::format("Parameters({} model, materials {})", ToString(parameters.model),
                           Materials(parameters));
      });
  module.def(
      "environment_parameters", [] { return DictFromParameters(commands::EnvironmentParameters()); },
      "Parameters of the paper's model for all scenes of environments(), as a dict: the paper's Table 4.");
}

}  // namespace sonarcal::python
