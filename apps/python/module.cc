// The extension module `_sonarcal` below the package `sonarcal`.
#include <fmt/format.h>

#include <exception>
#include <filesystem>

#include "apps/python/bind_options.h"
#include "apps/python/bindings.h"
#include "core/types/error.h"

namespace {

namespace py = pybind11;

// Errors that the commands report in one sentence as well (apps/cli/command.cc).
void RegisterErrors(py::module_& module) {
  static py::exception<sonarcal::DataError> data_error(module, "DataError", PyExc_ValueError);
  static py::exception<sonarcal::UsageError> usage_error(module, "UsageError", PyExc_ValueError);
  data_error.attr("__doc__") =
      "Data or files are wrong: one sentence that names file, key or line, what was found and what was "
      "expected.";
  usage_error.attr("__doc__") =
      "An argument is wrong: one sentence that names the argument, its value and what was expected.";
  // pybind11 needs a copy. NOLINTNEXTLINE(performance-unnecessary-value-param)
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const sonarcal::DataError& error) {
      PyErr_SetString(data_error.ptr(), error.what());
    } catch (const sonarcal::UsageError& error) {
      PyErr_SetString(usage_error.ptr(), sonarcal::python::WithKeywords(error.what()).c_str());
    } catch (const std::filesystem::filesystem_error& error) {
      const std::filesystem::path& path = error.path2().empty() ? error.path1() : error.path2();
      PyErr_SetString(data_error.ptr(), fmt::format("{}: {}", path.string(), error.code().message()).c_str());
    }
  });
}

}  // namespace

PYBIND11_MODULE(_sonarcal, module) {
  module.doc() = "The compiled part of sonarcal; import `sonarcal` instead.";
  module.attr("__version__") = SONARCAL_VERSION;
  RegisterErrors(module);
  sonarcal::python::BindAxes(module);
  sonarcal::python::BindScene(module);
  sonarcal::python::BindParameters(module);
  sonarcal::python::BindAllOptions(module);
  sonarcal::python::BindRecording(module);
  sonarcal::python::BindRuns(module);
  sonarcal::python::BindCalibration(module);
  sonarcal::python::BindResiduals(module);
  sonarcal::python::BindReproduce(module);
}
