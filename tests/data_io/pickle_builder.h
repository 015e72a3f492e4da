// Pickles of NumPy arrays put together by hand, protocol 4. A value is the operations that leave it on the
// stack.
#pragma once

#include <cstdint>
#include <string>

namespace sonarcal::testing {

// Value of protocol 4 that is a str.
inline std::string Str(const std::string& text) {
  return std::string("\x8c") + static_cast<char>(text.size()) + text;
}

// Pickle of a dict; `items` are its keys and values in turn.
inline std::string DictOf(const std::string& items) {
  return "\x80\x04}(" + items + "u.";
}

// "module.name" as a function on the stack.
inline std::string Global(const std::string& module, const std::string& name) {
  return Str(module) + Str(name) + "\x93";
}

// numpy.dtype(name), with a byte order.
inline std::string DtypeValue(const std::string& name, const std::string& order = "<") {
  return Global("numpy", "dtype") + Str(name) + "\x89\x88\x87R(K\x03" + Str(order) +
         "NNNJ\xff\xff\xff\xffJ\xff\xff\xff\xffK" + std::string(1, '\0') + "tb";
}

// An array; `shape` is a value, such as "K\2K\3\x86" for (2, 3).
inline std::string ArrayValue(const std::string& shape, const std::string& dtype, const std::string& bytes,
                              bool column_major = false) {
  std::string length;
  for (unsigned bit = 0; bit < 32; bit += 8) length += static_cast<char>(bytes.size() >> bit & 0xff);
  return Global("numpy.core.multiarray", "_reconstruct") + Global("numpy", "ndarray") +
         std::string("K\0\x85", 3) + "C\x01" + "b\x87R(K\x01" + shape + dtype +
         (column_major ? "\x88" : "\x89") + "B" + length + bytes + "tb";
}

}  // namespace sonarcal::testing
