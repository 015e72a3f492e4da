// Options that describe themselves. Each option stands once: name, unit, default, limits and help text. The
// command line (apps/cli/add_options.h) and Python (apps/python/bind_options.h) are made from it.
//
// A struct of options has a static member that visits each of them:
//
//   struct RayOptions {
//     NormalSource normals = NormalSource::kGeometric;
//     int threads = 0;
//
//     template <typename Self, typename Visitor>
//     static void Visit(Self& self, Visitor&& visit) {
//       visit(OptionInfo{.name = "normals", .help = "Source of the surface normals"}, self.normals);
//       visit(OptionInfo{.name = "threads", .help = "Threads, 0 for all cores", .min = 0}, self.threads);
//     }
//   };
//
// The default is the value of a default-constructed struct. A member may be a bool, a number, text, a path,
// an enumeration with words (core/types/words.h), one of the types below, or std::optional or std::vector of
// these.
#pragma once

#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>

namespace sonarcal {

struct OptionInfo {
  std::string name;             // "region_range"; on the command line "--region-range"
  std::string help;             // one sentence without full stop, without unit and default
  std::string unit = {};        // "m", "deg", "dB"; empty: none
  std::string by_default = {};  // what happens without the option, if the member holds no default
  std::string type = {};        // placeholder of the value, such as "PNG"; empty: by unit and type
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
};

// True if a number is finite and within the limits of its option, or absent. Other values have no limits.
template <typename T>
bool IsWithin(const OptionInfo& info, const T& value) {
  if constexpr (std::is_arithmetic_v<T>) {
    const auto number = static_cast<double>(value);
    return std::isfinite(number) && number >= info.min && number <= info.max;
  } else {
    return true;
  }
}
template <typename T>
bool IsWithin(const OptionInfo& info, const std::optional<T>& value) {
  return !value || IsWithin(info, *value);
}

// Rows x columns of an image: range bins x beams. Text: "7x3".
template <typename T>
struct GridSize {
  T rows{};
  T cols{};

  bool operator==(const GridSize&) const = default;
};

// Columns x rows of rays. Text: "1500x1200".
struct RayGridSize {
  int cols = 0;
  int rows = 0;

  bool operator==(const RayGridSize&) const = default;
};

// Interval with low below high. Text: "0.5:3".
struct Interval {
  double low = 0.0;
  double high = 0.0;

  bool Contains(double value) const { return value >= low && value <= high; }
  bool operator==(const Interval&) const = default;
};

// Value that the command line reads from a file, and other programs pass as an object.
template <typename T>
struct FromFile {
  std::optional<T> value = {};
  std::filesystem::path file = {};  // source of `value`; empty: passed as an object, or absent

  explicit operator bool() const { return value.has_value(); }
};

}  // namespace sonarcal
