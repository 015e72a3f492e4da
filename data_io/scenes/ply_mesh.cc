#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <utility>

#include "core/types/error.h"
#include "core/types/parse_number.h"
#include "core/types/printable.h"
#include "data_io/files/text_words.h"
#include "data_io/scenes/cad_mesh.h"
#include "data_io/scenes/polygon.h"
#include "data_io/scenes/scene_assembler.h"

namespace sonarcal::data_io {
namespace {

struct Type {
  std::string_view name;
  std::string_view sized_name;
  std::size_t bytes;
  bool is_float;
  bool is_signed;
};

constexpr std::array kTypes = {
    Type{"char", "int8", 1, false, true},    Type{"uchar", "uint8", 1, false, false},
    Type{"short", "int16", 2, false, true},  Type{"ushort", "uint16", 2, false, false},
    Type{"int", "int32", 4, false, true},    Type{"uint", "uint32", 4, false, false},
    Type{"float", "float32", 4, true, true}, Type{"double", "float64", 8, true, true},
};

struct Property {
  std::string name;
  const Type* type = nullptr;
  const Type* count_type = nullptr;  // set for lists

  std::size_t min_bytes() const { return count_type != nullptr ? count_type->bytes : type->bytes; }
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

enum class Storage { kText, kLittleEndian, kBigEndian };

class PlyReader {
 public:
  PlyReader(std::string_view bytes, std::string file) : bytes_(bytes), file_(std::move(file)) {}

  CadMesh Read() {
    ReadHeader();
    for (const Element& element : elements_) ReadElement(element);
    if (bytes_.find_first_not_of(kBlanks, at_) != std::string_view::npos)
      throw DataError("{}: data follow the last element, at byte {}", file_, at_);
    std::vector<Eigen::Vector3f> corners = Triangles();
    if (corners.empty()) throw DataError("{}: no faces, expected a mesh", file_);
    return {{"default"}, {std::move(corners)}};
  }

 private:
  template <typename... Args>
  [[noreturn]] void Refuse(fmt::format_string<Args...> format, Args&&... args) const {
    const std::string what = fmt::format(format, std::forward<Args>(args)...);
    if (storage_ != Storage::kText) throw DataError("{}: byte {}: {}", file_, at_, what);
    const auto line = 1 + std::count(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(at_), '\n');
    throw DataError("{}:{}: {}", file_, line, what);
  }

  // Header.

  std::string_view TakeHeaderLine() {
    const std::size_t end = bytes_.find('\n', at_);
    if (end == std::string_view::npos || end - at_ > kMaxPlyHeaderLine)
      Refuse("the header does not end, expected 'end_header'");
    std::string_view line = bytes_.substr(at_, end - at_);
    next_line_ = end + 1;
    return line;
  }

  void ReadHeader() {
    std::string_view line = TakeHeaderLine();
    if (TakeWord(line) != "ply") Refuse("does not begin with 'ply'");
    bool has_format = false;
    Storage storage = Storage::kText;  // takes effect behind the header, which is text
    for (std::size_t lines = 0;; ++lines) {
      at_ = next_line_;
      if (lines == kMaxPlyHeaderLines) Refuse("a header of more than {} lines", kMaxPlyHeaderLines);
      line = TakeHeaderLine();
      const std::string_view word = TakeWord(line);
      if (word == "end_header") break;
      if (word == "comment" || word == "obj_info" || word.empty()) continue;
      if (word == "format") {
        storage = StorageOf(line);
        has_format = true;
      } else if (word == "element") {
        AddElement(line);
      } else if (word == "property") {
        AddProperty(line);
      } else {
        Refuse("'{}', which is no line of a PLY header", Printable(word, 30));
      }
    }
    if (!has_format) Refuse("the header has no format, expected ascii or binary");
    at_ = next_line_;
    storage_ = storage;
  }

  Storage StorageOf(std::string_view line) const {
    const std::string_view name = TakeWord(line);
    const std::string_view version = TakeWord(line);
    if (version != "1.0") Refuse("version '{}', expected 1.0", Printable(version, 30));
    if (name == "ascii") return Storage::kText;
    if (name == "binary_little_endian") return Storage::kLittleEndian;
    if (name == "binary_big_endian") return Storage::kBigEndian;
    Refuse("format '{}', expected ascii, binary_little_endian or binary_big_endian", Printable(name, 30));
  }

  void AddElement(std::string_view line) {
    Element element;
    element.name = TakeWord(line);
    const std::string_view count = TakeWord(line);
    if (element.name.empty() || !ParseNumber(count, element.count))
      Refuse("'{}', expected the number of elements", Printable(count, 30));
    const auto same = [&](const Element& other) { return other.name == element.name; };
    if (std::ranges::any_of(elements_, same)) Refuse("a second element '{}'", Printable(element.name, 30));
    elements_.push_back(std::move(element));
  }

  void AddProperty(std::string_view line) {
    if (elements_.empty()) Refuse("a property before the first element");
    Property property;
    std::string_view word = TakeWord(line);
    if (word == "list") {
      property.count_type = &TypeOf(TakeWord(line));
      if (property.count_type->is_float) Refuse("a list counted in floating-point numbers");
      word = TakeWord(line);
    }
    property.type = &TypeOf(word);
    property.name = TakeWord(line);
    if (property.name.empty()) Refuse("a property without a name");
    elements_.back().properties.push_back(std::move(property));
  }

  const Type& TypeOf(std::string_view name) const {
    const auto* const found = std::ranges::find_if(
        kTypes, [&](const Type& type) { return type.name == name || type.sized_name == name; });
    if (found == kTypes.end()) Refuse("type '{}', expected one of PLY", Printable(name, 30));
    return *found;
  }

  // Elements.

  void ReadElement(const Element& element) {
    CheckSize(element);
    const bool is_vertex = element.name == "vertex";
    const bool is_face = element.name == "face";
    const std::array<std::size_t, 3> xyz = is_vertex ? Coordinates(element) : std::array<std::size_t, 3>{};
    const std::size_t corners = is_face ? CornersOf(element) : 0;
    if (element.properties.empty()) return;  // no data, however many there are
    std::vector<double> values(element.properties.size());
    for (std::uint64_t i = 0; i < element.count; ++i) {
      for (std::size_t k = 0; k < element.properties.size(); ++k) {
        const Property& property = element.properties[k];
        if (property.count_type == nullptr) {
          values[k] = TakeNumber(*property.type);
        } else if (is_face && k == corners) {
          ReadFace(property);
        } else {
          SkipList(property);
        }
      }
      if (is_vertex) AddVertex(values[xyz[0]], values[xyz[1]], values[xyz[2]]);
    }
  }

  // A count cannot promise more than the bytes that follow. In a text each number takes two, with its blank.
  void CheckSize(const Element& element) const {
    std::uint64_t bytes_each = 0;
    for (const Property& property : element.properties)
      bytes_each += storage_ == Storage::kText ? 2 : property.min_bytes();
    const std::uint64_t left = bytes_.size() - at_ + 1;  // the last number of a text needs no blank
    if (bytes_each > 0 && element.count > left / bytes_each) {
      Refuse("{} elements '{}' take at least {} bytes each, but {} follow", element.count,
             Printable(element.name, 30), bytes_each, left - 1);
    }
    if (element.name == "vertex" && element.count > kMaxSceneVertices)
      Refuse("more than {} vertices", kMaxSceneVertices);
    if (element.name == "face" && element.count > kMaxSceneTriangles)
      Refuse("more than {} faces", kMaxSceneTriangles);
  }

  std::array<std::size_t, 3> Coordinates(const Element& element) const {
    std::array<std::size_t, 3> places{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::string name(1, "xyz"[axis]);
      const auto found = std::ranges::find_if(element.properties, [&](const Property& property) {
        return property.name == name && property.count_type == nullptr;
      });
      if (found == element.properties.end()) Refuse("vertices have no property '{}', expected one", name);
      places[axis] = static_cast<std::size_t>(found - element.properties.begin());
    }
    return places;
  }

  std::size_t CornersOf(const Element& element) const {
    const auto found = std::ranges::find_if(element.properties, [](const Property& property) {
      return property.count_type != nullptr &&
             (property.name == "vertex_indices" || property.name == "vertex_index");
    });
    if (found == element.properties.end())
      Refuse("faces have no list 'vertex_indices' or 'vertex_index', expected one");
    if (found->type->is_float) Refuse("corners are floating-point numbers, expected integers");
    return static_cast<std::size_t>(found - element.properties.begin());
  }

  void AddVertex(double x, double y, double z) {
    const Eigen::Vector3f vertex = Eigen::Vector3d(x, y, z).cast<float>();
    if (!vertex.allFinite()) Refuse("vertex {} is not finite", vertices_.size());
    vertices_.push_back(vertex);
  }

  void ReadFace(const Property& property) {
    const std::uint64_t count = TakeCount(property);
    if (count < 3) Refuse("face {} has {} corners, expected 3 or more", face_sizes_.size(), count);
    if (count > kMaxFaceCorners)
      Refuse("face {} has more than {} corners", face_sizes_.size(), kMaxFaceCorners);
    triangle_count_ += count - 2;
    if (triangle_count_ > kMaxSceneTriangles) Refuse("more than {} triangles", kMaxSceneTriangles);
    face_sizes_.push_back(static_cast<std::uint16_t>(count));
    for (std::uint64_t i = 0; i < count; ++i) {
      const double index = TakeNumber(*property.type);
      if (index < 0.0) Refuse("face {} has vertex {}, expected 0 or more", face_sizes_.size() - 1, index);
      corners_.push_back(static_cast<std::uint32_t>(index));
    }
  }

  void SkipList(const Property& property) {
    const std::uint64_t count = TakeCount(property);
    if (storage_ != Storage::kText) {
      TakeBytes(count * property.type->bytes);  // below 2^35
      return;
    }
    for (std::uint64_t i = 0; i < count; ++i) TakeNumber(*property.type);
  }

  std::uint64_t TakeCount(const Property& property) {
    const double count = TakeNumber(*property.count_type);
    if (count < 0.0) Refuse("a list of {} items, expected 0 or more", count);
    return static_cast<std::uint64_t>(count);
  }

  // Any value of these types is exact as a double.
  double TakeNumber(const Type& type) {
    if (storage_ == Storage::kText) return TakeTextNumber(type);
    const std::string_view taken = TakeBytes(type.bytes);
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < taken.size(); ++i) {
      const std::size_t from_first = storage_ == Storage::kBigEndian ? i : taken.size() - 1 - i;
      bits = bits << 8 | static_cast<unsigned char>(taken[from_first]);
    }
    if (type.is_float) {
      return type.bytes == 4 ? std::bit_cast<float>(static_cast<std::uint32_t>(bits))
                             : std::bit_cast<double>(bits);
    }
    const std::uint64_t sign = std::uint64_t{1} << (8 * type.bytes - 1);
    const auto value = static_cast<double>(bits);
    return type.is_signed && (bits & sign) != 0 ? value - 2.0 * static_cast<double>(sign) : value;
  }

  double TakeTextNumber(const Type& type) {
    std::string_view rest = bytes_.substr(at_);
    const std::string_view word = TakeWord(rest);
    at_ = bytes_.size() - rest.size() - word.size();  // behind blanks and ends of lines
    const std::string_view digits = word.substr(word.starts_with('+') ? 1 : 0);
    double number = 0.0;
    std::int64_t integer = 0;
    if (word.empty()) Refuse("the text ends, expected a number");
    if (!(type.is_float ? ParseNumber(digits, number) : ParseNumber(digits, integer)))
      Refuse("'{}', expected {}", Printable(word, 30), type.is_float ? "a number" : "an integer");
    at_ = bytes_.size() - rest.size();
    if (type.is_float) return number;
    const double span = std::ldexp(1.0, static_cast<int>(8 * type.bytes));
    const double min = type.is_signed ? -0.5 * span : 0.0;
    number = static_cast<double>(integer);
    if (number < min || number >= min + span)
      Refuse("'{}', expected a number of type {}", Printable(word, 30), type.name);
    return number;
  }

  std::string_view TakeBytes(std::uint64_t count) {
    if (count > bytes_.size() - at_)
      Refuse("the data end at byte {}, expected {} more bytes", bytes_.size(), count - (bytes_.size() - at_));
    const std::string_view taken = bytes_.substr(at_, count);
    at_ += count;
    return taken;
  }

  // Faces may stand before the vertices, so they are divided at the end.
  std::vector<Eigen::Vector3f> Triangles() const {
    std::vector<Eigen::Vector3f> triangles;
    triangles.reserve(3 * triangle_count_);
    std::vector<Eigen::Vector3d> polygon;
    auto corner = corners_.begin();
    for (std::size_t face = 0; face < face_sizes_.size(); ++face) {
      const std::size_t size = face_sizes_[face];
      polygon.clear();
      for (std::size_t i = 0; i < size; ++i) {
        if (corner[i] >= vertices_.size())
          throw DataError("{}: face {} has vertex {}, but there are {}", file_, face, corner[i],
                          vertices_.size());
        polygon.emplace_back(vertices_[corner[i]].cast<double>());
      }
      const auto divided = DividePolygon(polygon);
      if (!divided) throw DataError("{}: face {} has {} corners whose sides cross", file_, face, size);
      for (const auto& triangle : *divided) {
        for (const int place : triangle) triangles.push_back(vertices_[corner[place]]);
      }
      corner += static_cast<std::ptrdiff_t>(size);
    }
    return triangles;
  }

  std::string_view bytes_;
  std::string file_;
  std::size_t at_ = 0;
  std::size_t next_line_ = 0;
  Storage storage_ = Storage::kText;
  std::vector<Element> elements_;
  std::vector<Eigen::Vector3f> vertices_;
  std::vector<std::uint16_t> face_sizes_;
  std::vector<std::uint32_t> corners_;  // of all faces, one after the other
  std::uint64_t triangle_count_ = 0;
};

}  // namespace

CadMesh ReadPlyMesh(std::string_view bytes, const std::string& file) {
  return PlyReader(bytes, file).Read();
}

}  // namespace sonarcal::data_io
