// Reads NumPy arrays from a Python pickle, without Python.
//
// A pickle is a program for a stack machine that may call any function. This reader executes only what
// `pickle.dump` of a dict of NumPy arrays needs, protocols 0 to 5:
//
//   values     None, bool, int of up to 64 bits, float, str, bytes, bytearray, tuple, list, dict
//   functions  numpy.ndarray, numpy.dtype, numpy.core.multiarray._reconstruct,
//              numpy.core.numeric._frombuffer (both also in numpy._core), _codecs.encode to Latin-1,
//              bytes and bytearray of nothing or of bytes (builtins, __builtin__)
//
// Any other function is refused by name and never looked up. Arrays have a boolean, integer or floating-point
// type of 1 to 8 bytes, except 16-bit floats. Refused too: objects of other classes, out-of-band buffers,
// references to other pickles, and more than kMaxPickleOperations operations. The result of each operation
// is checked against the bytes of the file, so memory stays in proportion to the file.
//
// Source: Python's pickletools.py and NumPy's array_reduce, dtype.__reduce__ and array_reduce_ex.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace sonarcal::data_io {

inline constexpr std::size_t kMaxPickleOperations = 200'000;
inline constexpr std::size_t kMaxPickledDimensions = 32;  // as in NumPy

struct NumpyArray {
  enum class Kind { kBool, kSigned, kUnsigned, kFloat };

  Kind kind = Kind::kFloat;
  std::size_t item_bytes = 0;
  bool big_endian = false;
  bool column_major = false;
  std::vector<std::size_t> shape;
  std::shared_ptr<const std::string> bytes;  // shape[0] * shape[1] * ... * item_bytes

  // Element (row, col) of an array of two dimensions (SONARCAL_CHECK). Integers beyond 2^53 are rounded.
  double At(std::size_t row, std::size_t col) const;
  std::string TypeName() const;   // "float32", "uint8", as in NumPy
  std::string ShapeText() const;  // "256 x 96"
};

struct PickledDict {
  std::map<std::string, NumpyArray> arrays;  // by key
  std::vector<std::string> keys;             // all keys that are str, those of other values too, each once
};

// Reads a pickled dict. `file` is the name used in error messages. Throws DataError, with the byte, for data
// that end early, anything not listed above, and arrays whose bytes do not match their shape.
PickledDict ReadPickledArrays(const std::string& bytes, const std::string& file);

}  // namespace sonarcal::data_io
