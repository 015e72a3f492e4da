// NumPy arrays of what C++ owns, and the other way about.
//
// A view shares the memory: it keeps `owner` alive and is read-only. What comes from Python is copied, once,
// into the library's own images.
#pragma once

#include <pybind11/numpy.h>

#include <span>
#include <string>
#include <vector>

#include "core/types/image.h"
#include "core/types/mask.h"

namespace sonarcal::python {

void MakeReadOnly(pybind11::array& array);

template <typename T>
pybind11::array_t<T> View(const T* data, std::vector<pybind11::ssize_t> shape, pybind11::handle owner) {
  pybind11::array_t<T> array(std::move(shape), data, owner);
  MakeReadOnly(array);
  return array;
}

template <typename T>
pybind11::array_t<T> View(const Grid<T>& grid, pybind11::handle owner) {
  return View(grid.values().data(), {grid.rows(), grid.cols()}, owner);
}

template <typename T>
pybind11::array_t<T> View(const std::vector<T>& values, pybind11::handle owner) {
  return View(values.data(), {static_cast<pybind11::ssize_t>(values.size())}, owner);
}

// An array that owns its memory.
template <typename T>
pybind11::array_t<T> Copy(std::span<const T> values) {
  return pybind11::array_t<T>(static_cast<pybind11::ssize_t>(values.size()), values.data());
}

using FloatArray = pybind11::array_t<float, pybind11::array::c_style | pybind11::array::forcecast>;
using DoubleArray = pybind11::array_t<double, pybind11::array::c_style | pybind11::array::forcecast>;

// Throw DataError naming `what` where the shape is not rows x cols.
Grid<float> GridFrom(const FloatArray& array, int rows, int cols, const std::string& what);
Mask MaskFrom(const pybind11::array& array, int rows, int cols, const std::string& what);

std::vector<double> VectorFrom(const DoubleArray& array, const std::string& what);

}  // namespace sonarcal::python
