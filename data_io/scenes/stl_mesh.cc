#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <utility>

#include "core/types/error.h"
#include "core/types/parse_number.h"
#include "core/types/printable.h"
#include "data_io/files/text_words.h"
#include "data_io/scenes/cad_mesh.h"
#include "data_io/scenes/scene_assembler.h"

namespace sonarcal::data_io {
namespace {

constexpr std::size_t kStlHeaderBytes = 80;
constexpr std::size_t kFirstTriangleByte = kStlHeaderBytes + 4;
constexpr std::size_t kTriangleBytes = 50;  // normal, three corners, two bytes of attributes
constexpr std::size_t kNormalBytes = 12;

void RequireCount(std::size_t triangles, const std::string& file) {
  if (triangles > kMaxSceneTriangles) throw DataError("{}: more than {} triangles", file, kMaxSceneTriangles);
}

class TextStl {
 public:
  TextStl(std::string_view text, std::string file) : text_(text), rest_(text), file_(std::move(file)) {}

  std::vector<Eigen::Vector3f> ReadCorners() {
    std::size_t solids = 0;
    for (std::string_view word = TakeWord(rest_); !word.empty(); word = TakeWord(rest_)) {
      Require(word, "solid");
      if (++solids > kMaxStlSolids) throw DataError("{}: more than {} solids", file_, kMaxStlSolids);
      SkipLine();
      for (word = TakeWord(rest_); word == "facet"; word = TakeWord(rest_)) ReadFacet();
      Require(word, "endsolid");
      SkipLine();
    }
    return std::move(corners_);
  }

 private:
  void ReadFacet() {
    Expect("normal");
    for (int i = 0; i < 3; ++i) TakeWord(rest_);
    Expect("outer");
    Expect("loop");
    for (int corner = 0; corner < 3; ++corner) {
      Expect("vertex");
      const double x = TakeNumber();
      const double y = TakeNumber();
      const double z = TakeNumber();
      corners_.emplace_back(Eigen::Vector3d(x, y, z).cast<float>());
    }
    Expect("endloop");
    Expect("endfacet");
    RequireCount(corners_.size() / 3, file_);
  }

  void Expect(std::string_view expected) { Require(TakeWord(rest_), expected); }

  void Require(std::string_view found, std::string_view expected) const {
    if (found != expected) Refuse(found, expected);
  }

  double TakeNumber() {
    const std::string_view word = TakeWord(rest_);
    double number = 0.0;
    if (!ParseNumber(word.substr(word.starts_with('+') ? 1 : 0), number)) Refuse(word, "a number");
    return number;
  }

  [[noreturn]] void Refuse(std::string_view found, std::string_view expected) const {
    const auto line = 1 + std::count(text_.begin(), text_.end() - rest_.size(), '\n');
    if (found.empty()) throw DataError("{}: ends in line {}, expected '{}'", file_, line, expected);
    throw DataError("{}:{}: '{}', expected '{}'", file_, line, Printable(found, 30), expected);
  }

  void SkipLine() { rest_.remove_prefix(std::min(rest_.find('\n'), rest_.size())); }

  std::string_view text_;
  std::string_view rest_;
  std::string file_;
  std::vector<Eigen::Vector3f> corners_;
};

std::vector<Eigen::Vector3f> BinaryCorners(std::string_view triangles) {
  std::vector<Eigen::Vector3f> corners;
  corners.reserve(3 * (triangles.size() / kTriangleBytes));
  for (; !triangles.empty(); triangles.remove_prefix(kTriangleBytes)) {
    std::array<float, 9> values{};
    std::memcpy(values.data(), triangles.data() + kNormalBytes, sizeof(values));
    for (std::size_t i = 0; i < values.size(); i += 3) corners.emplace_back(&values[i]);
  }
  return corners;
}

std::vector<Eigen::Vector3f> ReadCorners(std::string_view bytes, const std::string& file) {
  if (bytes.size() >= kFirstTriangleByte) {
    std::uint32_t count = 0;
    std::memcpy(&count, bytes.data() + kStlHeaderBytes, sizeof(count));
    const std::size_t expected_bytes = kFirstTriangleByte + std::size_t{count} * kTriangleBytes;
    if (bytes.size() == expected_bytes) {
      RequireCount(count, file);
      return BinaryCorners(bytes.substr(kFirstTriangleByte));
    }
    if (!bytes.starts_with("solid")) {
      throw DataError("{}: claims {} triangles, which takes {} bytes, but has {}", file, count,
                      expected_bytes, bytes.size());
    }
  }
  if (!bytes.starts_with("solid")) {
    throw DataError("{}: neither begins with 'solid' nor has the {} bytes of a binary STL's header", file,
                    kFirstTriangleByte);
  }
  return TextStl(bytes, file).ReadCorners();
}

}  // namespace

CadMesh ReadStlMesh(std::string_view bytes, const std::string& file) {
  std::vector<Eigen::Vector3f> corners = ReadCorners(bytes, file);
  if (corners.empty()) throw DataError("{}: no triangles, expected a mesh", file);
  return {{"default"}, {std::move(corners)}};
}

}  // namespace sonarcal::data_io
