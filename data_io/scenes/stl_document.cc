#include "data_io/scenes/stl_document.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <utility>

#include "core/types/error.h"
#include "core/types/printable.h"
#include "data_io/scenes/scene_assembler.h"

namespace sonarcal::data_io {
namespace {

constexpr std::size_t kHeaderBytes = 80;
constexpr std::size_t kFirstTriangleByte = kHeaderBytes + 4;
constexpr std::size_t kTriangleBytes = 50;

bool IsBlank(char c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\f' || c == '\v';
}

void RequireCount(std::size_t triangles, const std::string& file) {
  if (triangles > kMaxSceneTriangles) throw DataError("{}: more than {} triangles", file, kMaxSceneTriangles);
}

// Words of a text with their line numbers.
class Words {
 public:
  Words(std::string_view text, const std::string& file) : text_(text), file_(file) {}

  std::string_view Take() {
    while (at_ < text_.size() && IsBlank(text_[at_])) line_ += text_[at_++] == '\n' ? 1 : 0;
    const std::size_t begin = at_;
    while (at_ < text_.size() && !IsBlank(text_[at_])) ++at_;
    return text_.substr(begin, at_ - begin);
  }

  void Expect(std::string_view expected) { Require(Take(), expected); }

  void Require(std::string_view found, std::string_view expected) const {
    if (found == expected) return;
    if (found.empty()) throw DataError("{}: ends in line {}, expected '{}'", file_, line_, expected);
    throw DataError("{}:{}: '{}', expected '{}'", file_, line_, Printable(found, 30), expected);
  }

  // Checks that a word looks like a number; the parser evaluates it.
  void ExpectNumber() {
    const std::string_view word = Take();
    static constexpr std::string_view kLetters = "0123456789+-.eEnNaAiIfFtTyY";  // including inf and nan
    const bool looks_right =
        !word.empty() && word.size() <= 64 && word.find_first_not_of(kLetters) == std::string_view::npos;
    if (!looks_right) {
      Require(word.empty() ? word : word.substr(0, 64), "a number");
    }
  }

  void SkipLine() { at_ = std::min(text_.find('\n', at_), text_.size()); }

 private:
  std::string_view text_;
  std::string file_;
  std::size_t at_ = 0;
  std::size_t line_ = 1;
};

std::size_t CountTextTriangles(std::string_view text, const std::string& file) {
  Words words(text, file);
  std::size_t triangles = 0;
  std::size_t solids = 0;
  for (std::string_view word = words.Take(); !word.empty(); word = words.Take()) {
    words.Require(word, "solid");
    if (++solids > kMaxStlSolids) throw DataError("{}: more than {} solids", file, kMaxStlSolids);
    words.SkipLine();
    for (word = words.Take(); word == "facet"; word = words.Take()) {
      words.Expect("normal");
      for (int i = 0; i < 3; ++i) words.ExpectNumber();
      words.Expect("outer");
      words.Expect("loop");
      for (int corner = 0; corner < 3; ++corner) {
        words.Expect("vertex");
        for (int i = 0; i < 3; ++i) words.ExpectNumber();
      }
      words.Expect("endloop");
      words.Expect("endfacet");
      RequireCount(++triangles, file);
    }
    words.Require(word, "endsolid");
    words.SkipLine();
  }
  return triangles;
}

}  // namespace

StlDocument CheckStl(std::string bytes, const std::string& file) {
  if (bytes.size() >= kFirstTriangleByte) {
    std::uint32_t count = 0;
    std::memcpy(&count, bytes.data() + kHeaderBytes, sizeof(count));
    if (bytes.size() == kFirstTriangleByte + std::size_t{count} * kTriangleBytes) {
      RequireCount(count, file);
      std::fill_n(bytes.begin(), kHeaderBytes, ' ');
      if (count == 0) throw DataError("{}: no triangles, expected a mesh", file);
      return {std::move(bytes), count};
    }
    if (!bytes.starts_with("solid")) {
      throw DataError("{}: claims {} triangles, which takes {} bytes, but has {}", file, count,
                      kFirstTriangleByte + std::size_t{count} * kTriangleBytes, bytes.size());
    }
  }
  if (!bytes.starts_with("solid")) {
    throw DataError("{}: neither begins with 'solid' nor has the {} bytes of a binary STL's header", file,
                    kFirstTriangleByte);
  }
  const std::size_t triangles = CountTextTriangles(bytes, file);
  if (triangles == 0) throw DataError("{}: no triangles, expected a mesh", file);
  return {std::move(bytes), triangles};
}

}  // namespace sonarcal::data_io
