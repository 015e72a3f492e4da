#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "core/types/error.h"
#include "core/types/parameters.h"
#include "core/types/parse_number.h"
#include "core/types/printable.h"
#include "data_io/files/file_bytes.h"
#include "data_io/files/text_words.h"
#include "data_io/scenes/cad_mesh.h"
#include "data_io/scenes/polygon.h"

namespace sonarcal::data_io {
namespace {

// Statements that do not affect a mesh's shape.
constexpr std::array<std::string_view, 21> kIgnored = {
    "vt",       "vn",       "o",      "g",      "s",          "mg",        "l",
    "p",        "mtllib",   "usemap", "maplib", "shadow_obj", "trace_obj", "bevel",
    "c_interp", "d_interp", "lod",    "vp",     "ctech",      "stech",     "end"};
// Statements that would leave a hole if they were ignored.
constexpr std::array<std::string_view, 15> kRefused = {"curv", "curv2", "surf", "cstype", "deg",
                                                       "bmat", "step",  "parm", "trim",   "hole",
                                                       "scrv", "sp",    "con",  "call",   "csh"};

template <std::size_t N>
bool Holds(const std::array<std::string_view, N>& words, std::string_view word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

bool ParseObjNumber(std::string_view word, auto& value) {
  return ParseNumber(word.substr(word.starts_with('+') ? 1 : 0), value);
}

class ObjReader {
 public:
  explicit ObjReader(const std::string& file) : file_(file) {}

  CadMesh Read(std::string_view bytes) {
    bytes = WithoutByteOrderMark(bytes);
    std::string joined;  // lines joined by a backslash
    while (!bytes.empty()) {
      const std::size_t end = std::min(bytes.find('\n'), bytes.size());
      std::string_view line = bytes.substr(0, end);
      bytes.remove_prefix(std::min(end + 1, bytes.size()));
      ++line_;
      if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
      if (!line.empty() && line.back() == '\\') {
        joined.append(line.substr(0, line.size() - 1)).push_back(' ');
        continue;
      }
      if (joined.empty()) {
        Statement(line);
      } else {
        joined.append(line);
        Statement(joined);
        joined.clear();
      }
    }
    Statement(joined);
    if (triangle_count_ == 0) throw DataError("{}: no faces, expected a mesh", file_);
    return std::move(mesh_);
  }

 private:
  template <typename... Args>
  [[noreturn]] void Refuse(fmt::format_string<Args...> format, Args&&... args) const {
    throw DataError("{}:{}: {}", file_, line_, fmt::format(format, std::forward<Args>(args)...));
  }

  void Statement(std::string_view line) {
    std::string_view rest = line.substr(0, line.find('#'));
    const std::string_view word = TakeWord(rest);
    if (word.empty() || Holds(kIgnored, word)) return;
    if (word == "v") return Vertex(rest);
    if (word == "f" || word == "fo") return Face(rest);
    if (word == "usemtl") return UseMaterial(line);
    if (Holds(kRefused, word)) {
      Refuse("'{}', expected a mesh of plain faces: free-form geometry is not read", word);
    }
    Refuse("'{}', which is no statement of an OBJ file", Printable(word, 30));
  }

  void Vertex(std::string_view rest) {
    std::array<double, 7> numbers{};
    std::size_t count = 0;
    for (std::string_view word = TakeWord(rest); !word.empty(); word = TakeWord(rest)) {
      if (count == numbers.size()) Refuse("a vertex of more than {} numbers", numbers.size());
      if (!ParseObjNumber(word, numbers[count]) || !std::isfinite(static_cast<float>(numbers[count]))) {
        Refuse("'{}' in a vertex, expected a finite number", Printable(word, 30));
      }
      ++count;
    }
    // Three coordinates, optionally with a weight or a colour.
    if (count != 3 && count != 4 && count != 6 && count != 7) {
      Refuse("a vertex of {} numbers, expected 3 coordinates", count);
    }
    if (count == 4 && numbers[3] != 1.0) Refuse("a vertex of weight {:g}, expected none or 1", numbers[3]);
    if (vertices_.size() == kMaxObjVertices) Refuse("more than {} vertices", kMaxObjVertices);
    vertices_.emplace_back(Eigen::Vector3d(numbers[0], numbers[1], numbers[2]).cast<float>());
  }

  // The vertex that "7", "7/1", "7//3" or "7/1/3" names.
  const Eigen::Vector3f& Corner(std::string_view word) const {
    const std::string_view whole = word;
    std::array<long long, 3> index{};
    for (std::size_t part = 0; part < 3; ++part) {
      const std::size_t slash = std::min(word.find('/'), word.size());
      const std::string_view number = word.substr(0, slash);
      const bool may_be_absent = part > 0;
      if (!(number.empty() && may_be_absent) && !ParseObjNumber(number, index[part])) {
        Refuse("'{}' in a face, expected vertex indices", Printable(whole, 30));
      }
      if (slash == word.size()) break;
      if (part == 2) Refuse("'{}' in a face, expected at most 3 indices a corner", Printable(whole, 30));
      word.remove_prefix(slash + 1);
    }
    const auto count = static_cast<long long>(vertices_.size());
    if (index[0] == 0) Refuse("vertex 0 in a face, expected 1 or more, or -1 or less");
    if (index[0] < -count || index[0] > count) {
      Refuse("vertex {} in a face, but {} stand before it", index[0], count);
    }
    return vertices_[static_cast<std::size_t>(index[0] > 0 ? index[0] - 1 : count + index[0])];
  }

  void Face(std::string_view rest) {
    if (material_ == kNoMaterial) material_ = MaterialIndex("default");
    std::vector<Eigen::Vector3f> vertices;
    std::vector<Eigen::Vector3d> corners;
    for (std::string_view word = TakeWord(rest); !word.empty(); word = TakeWord(rest)) {
      if (corners.size() == kMaxFaceCorners) Refuse("a face of more than {} corners", kMaxFaceCorners);
      vertices.push_back(Corner(word));
      corners.emplace_back(vertices.back().cast<double>());
    }
    if (corners.size() < 3) Refuse("a face of {} corners, expected 3 or more", corners.size());
    const auto triangles = DividePolygon(corners);
    if (!triangles) Refuse("a face of {} corners whose sides cross", corners.size());
    triangle_count_ += triangles->size();
    if (triangle_count_ > kMaxObjTriangles) {
      Refuse("more than {} triangles, expected a glTF for a mesh of this size", kMaxObjTriangles);
    }
    for (const auto& triangle : *triangles) {
      for (const int corner : triangle) mesh_.corners[material_].push_back(vertices[corner]);
    }
  }

  void UseMaterial(std::string_view line) {
    std::string_view name = line;  // may contain blanks and '#'
    TakeWord(name);
    name.remove_prefix(std::min(name.find_first_not_of(kBlanks), name.size()));
    name = name.substr(0, name.find_last_not_of(kBlanks) + 1);
    material_ = MaterialIndex(name.empty() ? "default" : std::string(name));
  }

  std::size_t MaterialIndex(const std::string& name) {
    const auto [found, added] = material_index_.try_emplace(name, mesh_.materials.size());
    if (added) {
      if (mesh_.materials.size() == kMaxMaterials) Refuse("more than {} materials", kMaxMaterials);
      mesh_.materials.push_back(name);
      mesh_.corners.emplace_back();
    }
    return found->second;
  }

  static constexpr std::size_t kNoMaterial = static_cast<std::size_t>(-1);

  std::string file_;
  std::size_t line_ = 0;
  CadMesh mesh_;
  std::size_t triangle_count_ = 0;
  std::vector<Eigen::Vector3f> vertices_;
  std::size_t material_ = kNoMaterial;
  std::map<std::string, std::size_t> material_index_;
};

}  // namespace

CadMesh ReadObjMesh(std::string_view bytes, const std::string& file) {
  return ObjReader(file).Read(bytes);
}

}  // namespace sonarcal::data_io
