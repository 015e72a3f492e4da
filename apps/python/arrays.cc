#include "apps/python/arrays.h"

#include <algorithm>

#include "core/types/error.h"

namespace sonarcal::python {
namespace {

namespace py = pybind11;

std::string ShapeText(const py::array& array) {
  std::string text;
  for (py::ssize_t axis = 0; axis < array.ndim(); ++axis)
    text += fmt::format("{}{}", axis > 0 ? " x " : "", array.shape(axis));
  return text.empty() ? std::string("a single number") : text;
}

void CheckShape(const py::array& array, int rows, int cols, const std::string& what) {
  if (array.ndim() == 2 && array.shape(0) == rows && array.shape(1) == cols) return;
  throw DataError("{}: shape {}, expected {} x {} (range bins x beams)", what, ShapeText(array), rows, cols);
}

}  // namespace

void MakeReadOnly(py::array& array) {
  array.attr("setflags")(py::arg("write") = false);
}

Grid<float> GridFrom(const FloatArray& array, int rows, int cols, const std::string& what) {
  CheckShape(array, rows, cols, what);
  Grid<float> grid(rows, cols);
  std::copy_n(array.data(), grid.size(), grid.values().begin());
  return grid;
}

Mask MaskFrom(const py::array& array, int rows, int cols, const std::string& what) {
  CheckShape(array, rows, cols, what);
  // As NumPy has it: whatever is not zero is true.
  const py::array_t<bool, py::array::c_style | py::array::forcecast> set(array);
  Mask mask(rows, cols);
  std::transform(set.data(), set.data() + mask.size(), mask.values().begin(),
                 [](bool value) { return std::uint8_t{value}; });
  return mask;
}

std::vector<double> VectorFrom(const DoubleArray& array, const std::string& what) {
  if (array.ndim() != 1) throw DataError("{}: shape {}, expected one dimension", what, ShapeText(array));
  return {array.data(), array.data() + array.size()};
}

}  // namespace sonarcal::python
