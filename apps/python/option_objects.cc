#include "apps/python/option_objects.h"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <cmath>
#include <filesystem>

#include "apps/python/arrays.h"
#include "data_io/files/file_bytes.h"
#include "data_io/images/image_io.h"
#include "data_io/parameters/parameters_io.h"

namespace sonarcal::python {
namespace {

namespace py = pybind11;

constexpr std::size_t kMaxTextBytes = std::size_t{1} << 30;

bool IsBool(const py::object& object) {
  return py::isinstance<py::bool_>(object) ||
         py::isinstance(object, py::module_::import("numpy").attr("bool_"));
}

// operator.index(object); null if it has none.
py::object IndexOf(const py::object& object) {
  if (IsBool(object)) return {};
  auto index = py::reinterpret_steal<py::object>(PyNumber_Index(object.ptr()));
  if (!index) PyErr_Clear();
  return index;
}

// Returns false, and forgets the exception, if the last call raised one.
bool Succeeded() {
  if (PyErr_Occurred() == nullptr) return true;
  PyErr_Clear();
  return false;
}

std::filesystem::path PathOf(const py::object& object) {
  return object.cast<std::filesystem::path>();
}

}  // namespace

bool ReadNumber(const py::object& object, double& value) {
  if (IsBool(object) || py::isinstance<py::str>(object) || py::isinstance<py::bytes>(object)) return false;
  const auto number = py::reinterpret_steal<py::object>(PyNumber_Float(object.ptr()));
  if (!number) PyErr_Clear();
  if (!number) return false;
  value = PyFloat_AsDouble(number.ptr());
  return !std::isnan(value);
}

bool ReadInteger(const py::object& object, std::int64_t& value) {
  const py::object index = IndexOf(object);
  if (!index) return false;
  value = PyLong_AsLongLong(index.ptr());
  return Succeeded();
}

bool ReadUnsigned(const py::object& object, std::uint64_t& value) {
  const py::object index = IndexOf(object);
  if (!index) return false;
  value = PyLong_AsUnsignedLongLong(index.ptr());
  return Succeeded();
}

std::optional<std::vector<py::object>> ItemsOf(const py::object& object) {
  if (py::isinstance<py::str>(object) || py::isinstance<py::bytes>(object) || IsMapping(object)) return {};
  const auto iterator = py::reinterpret_steal<py::object>(PyObject_GetIter(object.ptr()));
  if (!iterator) PyErr_Clear();
  if (!iterator) return {};
  std::vector<py::object> items;
  for (const py::handle item : py::reinterpret_borrow<py::iterator>(iterator))
    items.push_back(py::reinterpret_borrow<py::object>(item));
  return items;
}

std::string ShortText(const py::object& object) {
  constexpr std::size_t kMaxLetters = 60;
  std::string text = py::str(object);
  if (text.size() > kMaxLetters) text = text.substr(0, kMaxLetters) + "...";
  return text;
}

bool OptionObject<bool>::From(const py::object& object, bool& value) {
  if (!IsBool(object)) return false;
  value = PyObject_IsTrue(object.ptr()) != 0;
  return true;
}

bool OptionObject<FrameList>::From(const py::object& object, FrameList& value) {
  std::vector<int> frames;
  if (!OptionObject<std::vector<int>>::From(object, frames)) return false;
  value = frames;
  return true;
}

py::object OptionObject<FrameList>::To(const FrameList& value) {
  const std::optional<std::vector<int>> numbers = value.Numbers();
  return numbers ? OptionObject<std::vector<int>>::To(*numbers) : py::object(py::str(value.Text()));
}

bool OptionObject<FromFile<ParameterSet>>::From(const py::object& object, FromFile<ParameterSet>& value) {
  const bool is_path = IsPath(object);
  if (!is_path && !IsMapping(object) && !py::isinstance<ParameterSet>(object)) return false;
  value = {.value = ParametersFromObject(object), .file = {}};
  if (is_path) value.file = PathOf(object);
  return true;
}

py::object OptionObject<FromFile<ParameterSet>>::To(const FromFile<ParameterSet>& value) {
  return py::cast(value.value);
}

bool OptionObject<FromFile<calib::FitConfig>>::From(const py::object& object,
                                                    FromFile<calib::FitConfig>& value) {
  if (IsPath(object)) {
    value = {.value = calib::ReadFitConfig(PathOf(object)), .file = PathOf(object)};
    return true;
  }
  if (!IsMapping(object)) return false;
  value = {.value = calib::ParseFitConfig(JsonFromObject(object), "config"), .file = {}};
  return true;
}

// In the form that calib/parameters/fit_config.h describes.
py::object OptionObject<FromFile<calib::FitConfig>>::To(const FromFile<calib::FitConfig>& value) {
  if (!value) return py::none();
  const calib::FitConfig& config = *value.value;
  py::dict priors;
  for (const auto& [name, prior] : config.priors)
    priors[py::str(name)] = prior ? py::cast(*prior) : py::object(py::str("none"));
  py::dict dict;
  dict["format"] = "sonar-fit-config/1";
  if (config.free) dict["free"] = *config.free;
  dict["fixed"] = config.fixed;
  dict["bounds"] = config.bounds;
  dict["priors"] = priors;
  py::dict pose_prior;
  pose_prior["position_m"] = config.pose_prior.position_m;
  pose_prior["angle_deg"] = config.pose_prior.angle_deg;
  dict["pose_prior"] = pose_prior;
  if (config.held_out) dict["held_out"] = *config.held_out;
  return dict;
}

bool OptionObject<FromFile<std::string>>::From(const py::object& object, FromFile<std::string>& value) {
  if (IsPath(object)) {
    value = {.value = data_io::ReadFileBytes(PathOf(object), kMaxTextBytes), .file = PathOf(object)};
    return true;
  }
  if (!IsMapping(object)) return false;
  value = {.value = JsonFromObject(object), .file = {}};
  return true;
}

py::object OptionObject<FromFile<std::string>>::To(const FromFile<std::string>& value) {
  return value ? ObjectFromJson(*value.value) : py::object(py::none());
}

bool OptionObject<FromFile<Mask>>::From(const py::object& object, FromFile<Mask>& value) {
  if (IsPath(object)) {
    value = {.value = data_io::ReadMask(PathOf(object)), .file = PathOf(object)};
    return true;
  }
  const py::array array = py::array::ensure(object);
  if (!array) PyErr_Clear();
  if (!array || array.ndim() != 2) return false;
  value = {
      .value = MaskFrom(array, static_cast<int>(array.shape(0)), static_cast<int>(array.shape(1)), "region"),
      .file = {}};
  return true;
}

py::object OptionObject<FromFile<Mask>>::To(const FromFile<Mask>& value) {
  if (!value) return py::none();
  const Mask& mask = *value.value;
  py::array_t<std::uint8_t> array({mask.rows(), mask.cols()}, mask.values().data());
  return array;
}

}  // namespace sonarcal::python
