#include "data_io/files/pickle.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <iterator>
#include <limits>
#include <optional>
#include <string_view>
#include <system_error>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <variant>

#include "core/types/error.h"
#include "core/types/parse_number.h"
#include "core/types/printable.h"

namespace sonarcal::data_io {
namespace {

using Bytes = std::shared_ptr<const std::string>;
using Index = std::uint32_t;  // of a node

enum class Function { kReconstruct, kFromBuffer, kNdarray, kDtype, kEncode, kBytes };

struct KnownFunction {
  std::string_view module;
  std::string_view name;
  Function function;
};

constexpr std::array kFunctions = {
    KnownFunction{"numpy.core.multiarray", "_reconstruct", Function::kReconstruct},
    KnownFunction{"numpy._core.multiarray", "_reconstruct", Function::kReconstruct},
    KnownFunction{"numpy.core.numeric", "_frombuffer", Function::kFromBuffer},
    KnownFunction{"numpy._core.numeric", "_frombuffer", Function::kFromBuffer},
    KnownFunction{"numpy", "ndarray", Function::kNdarray},
    KnownFunction{"numpy", "dtype", Function::kDtype},
    KnownFunction{"_codecs", "encode", Function::kEncode},
    KnownFunction{"builtins", "bytes", Function::kBytes},
    KnownFunction{"builtins", "bytearray", Function::kBytes},
    KnownFunction{"__builtin__", "bytes", Function::kBytes},
    KnownFunction{"__builtin__", "bytearray", Function::kBytes},
};

struct None {};
struct Text {
  std::string utf8;
};
struct Sequence {  // tuple or list
  bool is_tuple = true;
  std::vector<Index> items;
};
struct Dict {
  std::vector<std::pair<Index, Index>> items;
};
struct Dtype {
  NumpyArray::Kind kind;
  std::size_t item_bytes;
  bool big_endian;
};
// Each value is a node in one list, and refers to others by their index. Values that contain themselves need
// no care then, nor do deep ones.
using Node =
    std::variant<None, bool, std::int64_t, double, Text, Bytes, Sequence, Dict, Function, Dtype, NumpyArray>;

// Number of bytes of an array; nothing if it is beyond a size_t.
std::optional<std::size_t> ByteCount(const std::vector<std::size_t>& shape, std::size_t item_bytes) {
  std::size_t count = item_bytes;
  for (const std::size_t length : shape) {
    if (length != 0 && count > std::numeric_limits<std::size_t>::max() / length) return std::nullopt;
    count *= length;
  }
  return count;
}

// Code points below 256 as bytes; nothing if there are others.
std::optional<std::string> Latin1FromUtf8(std::string_view utf8) {
  std::string latin1;
  for (std::size_t i = 0; i < utf8.size(); ++i) {
    const auto byte = static_cast<unsigned char>(utf8[i]);
    if (byte < 0x80) {
      latin1 += utf8[i];
      continue;
    }
    if ((byte != 0xC2 && byte != 0xC3) || i + 1 == utf8.size()) return std::nullopt;
    const auto next = static_cast<unsigned char>(utf8[++i]);
    if ((next & 0xC0) != 0x80) return std::nullopt;
    latin1 += static_cast<char>((byte & 0x03) << 6 | (next & 0x3F));
  }
  return latin1;
}

void AppendUtf8(std::uint32_t code_point, std::string& utf8) {
  if (code_point < 0x80) {
    utf8 += static_cast<char>(code_point);
  } else if (code_point < 0x800) {
    utf8 += static_cast<char>(0xC0 | code_point >> 6);
    utf8 += static_cast<char>(0x80 | (code_point & 0x3F));
  } else if (code_point < 0x10000) {
    utf8 += static_cast<char>(0xE0 | code_point >> 12);
    utf8 += static_cast<char>(0x80 | (code_point >> 6 & 0x3F));
    utf8 += static_cast<char>(0x80 | (code_point & 0x3F));
  } else {
    utf8 += static_cast<char>(0xF0 | (code_point >> 18 & 0x07));
    utf8 += static_cast<char>(0x80 | (code_point >> 12 & 0x3F));
    utf8 += static_cast<char>(0x80 | (code_point >> 6 & 0x3F));
    utf8 += static_cast<char>(0x80 | (code_point & 0x3F));
  }
}

// Text of protocol 0: Latin-1 with \uXXXX and \UXXXXXXXX. Nothing if it is malformed.
std::optional<std::string> FromRawUnicodeEscape(std::string_view line) {
  std::string utf8;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const bool escape = line[i] == '\\' && i + 1 < line.size() && (line[i + 1] == 'u' || line[i + 1] == 'U');
    if (!escape) {
      AppendUtf8(static_cast<unsigned char>(line[i]), utf8);
      continue;
    }
    const std::size_t digits = line[i + 1] == 'u' ? 4 : 8;
    const std::string_view hex = line.substr(i + 2, digits);
    std::uint32_t code_point = 0;
    const auto [end, error] = std::from_chars(hex.data(), hex.data() + hex.size(), code_point, 16);
    if (hex.size() != digits || error != std::errc() || end != hex.data() + digits || code_point > 0x10FFFF)
      return std::nullopt;
    AppendUtf8(code_point, utf8);
    i += 1 + digits;
  }
  return utf8;
}

class Unpickler {
 public:
  Unpickler(const std::string& bytes, std::string file) : bytes_(bytes), file_(std::move(file)) {}

  PickledDict Read() {
    for (std::size_t count = 0; !stopped_; ++count) {
      if (count == kMaxPickleOperations) Fail("more than {} operations", kMaxPickleOperations);
      operation_at_ = at_;
      Execute(static_cast<unsigned char>(Take(1)[0]));
    }
    return Result();
  }

 private:
  template <typename... Args>
  [[noreturn]] void Fail(fmt::format_string<Args...> format, Args&&... args) const {
    throw DataError("{}: byte {}: {}", file_, operation_at_,
                    fmt::format(format, std::forward<Args>(args)...));
  }

  // Reading the file.

  std::string_view Take(std::uint64_t count) {
    if (count > bytes_.size() - at_)
      Fail("the data end at byte {}, expected {} more bytes", bytes_.size(), count - (bytes_.size() - at_));
    const std::string_view taken = std::string_view(bytes_).substr(at_, count);
    at_ += count;
    return taken;
  }

  std::uint64_t Unsigned(std::size_t count) {
    std::uint64_t value = 0;
    const std::string_view taken = Take(count);
    for (std::size_t i = 0; i < count; ++i)
      value |= std::uint64_t{static_cast<unsigned char>(taken[i])} << (8 * i);
    return value;
  }

  // Two's complement of up to 8 bytes.
  std::int64_t Signed(std::uint64_t count) {
    if (count > 8) Fail("an integer of {} bytes, expected at most 8", count);
    if (count == 0) return 0;
    const int unused = static_cast<int>(64 - 8 * count);
    return static_cast<std::int64_t>(Unsigned(count) << unused) >> unused;
  }

  std::string_view TakeLine() {
    const std::size_t end = bytes_.find('\n', at_);
    if (end == std::string::npos) Fail("a line without an end");
    const std::string_view line = Take(end - at_);
    Take(1);
    return line;
  }

  template <typename T>
  T NumberInLine() {
    std::string_view line = TakeLine();
    if (line.ends_with('L')) line.remove_suffix(1);  // a long integer of protocol 0
    T number{};
    if (!ParseNumber(line, number)) Fail("'{}', expected a number", Printable(line, 30));
    return number;
  }

  // The stack.

  void Push(Node node) {
    nodes_.push_back(std::move(node));
    stack_.push_back(static_cast<Index>(nodes_.size() - 1));
  }

  // Number of values above the last mark.
  std::size_t Above() const { return stack_.size() - (marks_.empty() ? 0 : marks_.back()); }

  Index Top() const {
    if (Above() == 0) Fail("a value is missing on the stack");
    return stack_.back();
  }
  Index Pop() {
    const Index top = Top();
    stack_.pop_back();
    return top;
  }
  std::vector<Index> PopLast(std::size_t count) {
    if (Above() < count) Fail("{} values are on the stack, expected {}", Above(), count);
    std::vector<Index> items(stack_.end() - static_cast<std::ptrdiff_t>(count), stack_.end());
    stack_.resize(stack_.size() - count);
    return items;
  }
  std::vector<Index> PopToMark() {
    if (marks_.empty()) Fail("a mark is missing on the stack");
    std::vector<Index> items = PopLast(Above());
    marks_.pop_back();
    return items;
  }

  template <typename T>
  T* As(Index index) {
    return std::get_if<T>(&nodes_[index]);
  }
  template <typename T>
  T& Expect(Index index, std::string_view what) {
    T* const value = As<T>(index);
    if (value == nullptr) Fail("a value of another type, expected {}", what);
    return *value;
  }

  // Operations.

  void Execute(unsigned char code) {
    struct Operation {
      unsigned char code;
      void (*execute)(Unpickler&);
    };
    // In the order of pickletools.opcodes, without those that no pickle of arrays has.
    static constexpr Operation kOperations[] = {
        {'I', [](Unpickler& p) { p.PushIntegerOrBool(); }},
        {'J', [](Unpickler& p) { p.Push(p.Signed(4)); }},
        {'K', [](Unpickler& p) { p.Push(static_cast<std::int64_t>(p.Unsigned(1))); }},
        {'M', [](Unpickler& p) { p.Push(static_cast<std::int64_t>(p.Unsigned(2))); }},
        {'L', [](Unpickler& p) { p.Push(p.NumberInLine<std::int64_t>()); }},
        {0x8a, [](Unpickler& p) { p.Push(p.Signed(p.Unsigned(1))); }},
        {0x8b, [](Unpickler& p) { p.Push(p.Signed(p.Unsigned(4))); }},
        {'B', [](Unpickler& p) { p.PushBytes(p.Unsigned(4)); }},
        {'C', [](Unpickler& p) { p.PushBytes(p.Unsigned(1)); }},
        {0x8e, [](Unpickler& p) { p.PushBytes(p.Unsigned(8)); }},
        {0x96, [](Unpickler& p) { p.PushBytes(p.Unsigned(8)); }},
        {0x97, [](Unpickler& p) { p.Fail("an out-of-band buffer, expected the data in the file"); }},
        {'N', [](Unpickler& p) { p.Push(None{}); }},
        {0x88, [](Unpickler& p) { p.Push(true); }},
        {0x89, [](Unpickler& p) { p.Push(false); }},
        {'V', [](Unpickler& p) { p.PushEscapedText(); }},
        {0x8c, [](Unpickler& p) { p.PushText(p.Unsigned(1)); }},
        {'X', [](Unpickler& p) { p.PushText(p.Unsigned(4)); }},
        {0x8d, [](Unpickler& p) { p.PushText(p.Unsigned(8)); }},
        {'F', [](Unpickler& p) { p.Push(p.NumberInLine<double>()); }},
        {'G', [](Unpickler& p) { p.PushBigEndianDouble(); }},
        {']',
         [](Unpickler& p) {
           p.Push(Sequence{false, {}});
         }},
        {'a', [](Unpickler& p) { p.Append(p.PopLast(1)); }},
        {'e', [](Unpickler& p) { p.Append(p.PopToMark()); }},
        {'l',
         [](Unpickler& p) {
           p.Push(Sequence{false, p.PopToMark()});
         }},
        {')', [](Unpickler& p) { p.Push(Sequence{}); }},
        {'t',
         [](Unpickler& p) {
           p.Push(Sequence{true, p.PopToMark()});
         }},
        {0x85,
         [](Unpickler& p) {
           p.Push(Sequence{true, p.PopLast(1)});
         }},
        {0x86,
         [](Unpickler& p) {
           p.Push(Sequence{true, p.PopLast(2)});
         }},
        {0x87,
         [](Unpickler& p) {
           p.Push(Sequence{true, p.PopLast(3)});
         }},
        {'}', [](Unpickler& p) { p.Push(Dict{}); }},
        {'d', [](Unpickler& p) { p.PushDict(p.PopToMark()); }},
        {'s', [](Unpickler& p) { p.SetItems(p.PopLast(2)); }},
        {'u', [](Unpickler& p) { p.SetItems(p.PopToMark()); }},
        {'0', [](Unpickler& p) { p.Pop(); }},
        {'2', [](Unpickler& p) { p.stack_.push_back(p.Top()); }},
        {'(', [](Unpickler& p) { p.marks_.push_back(p.stack_.size()); }},
        {'1', [](Unpickler& p) { p.PopToMark(); }},
        {'g', [](Unpickler& p) { p.Recall(p.NumberInLine<std::uint64_t>()); }},
        {'h', [](Unpickler& p) { p.Recall(p.Unsigned(1)); }},
        {'j', [](Unpickler& p) { p.Recall(p.Unsigned(4)); }},
        {'p', [](Unpickler& p) { p.Store(p.NumberInLine<std::uint64_t>()); }},
        {'q', [](Unpickler& p) { p.Store(p.Unsigned(1)); }},
        {'r', [](Unpickler& p) { p.Store(p.Unsigned(4)); }},
        {0x94, [](Unpickler& p) { p.Store(p.memo_.size()); }},
        {'c', [](Unpickler& p) { p.PushGlobalOfLines(); }},
        {0x93, [](Unpickler& p) { p.PushGlobalOfStack(); }},
        {'R', [](Unpickler& p) { p.Reduce(); }},
        {'b', [](Unpickler& p) { p.Build(); }},
        {0x80, [](Unpickler& p) { p.CheckProtocol(p.Unsigned(1)); }},
        {0x95, [](Unpickler& p) { p.CheckFrame(p.Unsigned(8)); }},
        {'.', [](Unpickler& p) { p.stopped_ = true; }},
    };
    const auto* const found = std::ranges::find(kOperations, code, &Operation::code);
    if (found == std::end(kOperations)) Fail("operation 0x{:02x}, which no pickle of arrays has", code);
    found->execute(*this);
  }

  void CheckProtocol(std::uint64_t protocol) const {
    if (protocol > 5) Fail("protocol {}, expected at most 5", protocol);
  }

  void CheckFrame(std::uint64_t count) const {
    if (count > bytes_.size() - at_) Fail("a frame of {} bytes, but {} follow", count, bytes_.size() - at_);
  }

  // "I01" and "I00" are the booleans of protocol 0.
  void PushIntegerOrBool() {
    const std::size_t start = at_;
    const std::string_view line = TakeLine();
    if (line == "00" || line == "01") return Push(line == "01");
    at_ = start;
    Push(NumberInLine<std::int64_t>());
  }

  void PushBigEndianDouble() {
    std::uint64_t bits = 0;
    for (const char byte : Take(8)) bits = bits << 8 | static_cast<unsigned char>(byte);
    Push(std::bit_cast<double>(bits));
  }

  void PushEscapedText() {
    std::optional<std::string> text = FromRawUnicodeEscape(TakeLine());
    if (!text) Fail("a malformed text");
    Push(Text{std::move(*text)});
  }

  void PushText(std::uint64_t count) { Push(Text{std::string(Take(count))}); }
  void PushBytes(std::uint64_t count) { Push(std::make_shared<const std::string>(Take(count))); }

  void Append(const std::vector<Index>& items) {
    auto& list = Expect<Sequence>(Top(), "a list");
    if (list.is_tuple) Fail("items are appended to a tuple, expected a list");
    list.items.insert(list.items.end(), items.begin(), items.end());
  }

  void PushDict(const std::vector<Index>& items) {
    Push(Dict{});
    SetItems(items);
  }

  void SetItems(const std::vector<Index>& items) {
    if (items.size() % 2 != 0) Fail("{} keys and values, expected pairs", items.size());
    Dict& dict = Expect<Dict>(Top(), "a dict");
    for (std::size_t i = 0; i < items.size(); i += 2) dict.items.emplace_back(items[i], items[i + 1]);
  }

  void Store(std::uint64_t number) { memo_[number] = Top(); }

  void Recall(std::uint64_t number) {
    const auto found = memo_.find(number);
    if (found == memo_.end()) Fail("value {} of the memo, which was not stored", number);
    stack_.push_back(found->second);
  }

  void PushGlobalOfLines() {
    const std::string_view module = TakeLine();
    PushGlobal(module, TakeLine());
  }

  void PushGlobalOfStack() {
    const std::vector<Index> names = PopLast(2);
    const std::string module = Expect<Text>(names[0], "the name of a module").utf8;
    PushGlobal(module, Expect<Text>(names[1], "the name of a function").utf8);
  }

  void PushGlobal(std::string_view module, std::string_view name) {
    const auto* const found = std::ranges::find_if(
        kFunctions, [&](const KnownFunction& known) { return known.module == module && known.name == name; });
    if (found == kFunctions.end()) {
      Fail("the pickle calls {}.{}, which is not executed: expected a dict of NumPy arrays",
           Printable(module), Printable(name));
    }
    Push(found->function);
  }

  // Calls.

  void Reduce() {
    const std::vector<Index> call = PopLast(2);
    const Function function = Expect<Function>(call[0], "a function");
    const std::vector<Index>& arguments = Expect<Sequence>(call[1], "a tuple of arguments").items;
    const auto require = [&](std::size_t min, std::size_t max) {
      if (arguments.size() < min || arguments.size() > max)
        Fail("a call with {} arguments, expected {}", arguments.size(), min);
    };
    switch (function) {
      case Function::kReconstruct: {
        require(3, 3);
        if (Expect<Function>(arguments[0], "numpy.ndarray") != Function::kNdarray)
          Fail("an array of another class, expected numpy.ndarray");
        return Push(NumpyArray{});  // filled by Build
      }
      case Function::kFromBuffer: {
        require(4, 4);
        const std::string order = Expect<Text>(arguments[3], "the order of an array").utf8;
        if (order != "C" && order != "F") Fail("order '{}', expected C or F", Printable(order, 10));
        return Push(ArrayOf(arguments[2], arguments[1], order == "F", arguments[0]));
      }
      case Function::kDtype: {
        require(1, 3);
        return Push(DtypeOf(Expect<Text>(arguments[0], "the name of a type").utf8));
      }
      case Function::kEncode: {
        require(2, 2);
        return Push(Encoded(arguments));
      }
      case Function::kBytes: {
        require(0, 1);
        if (arguments.empty()) return PushBytes(0);
        return Push(Expect<Bytes>(arguments[0], "bytes"));
      }
      case Function::kNdarray:
        Fail("a call of numpy.ndarray, expected one of _reconstruct");
    }
  }

  // Bytes of protocols 0 to 2. The sum of all results is limited to the size of the file, because a text can
  // be encoded repeatedly.
  Bytes Encoded(const std::vector<Index>& arguments) {
    if (Expect<Text>(arguments[1], "the name of an encoding").utf8 != "latin1")
      Fail("an encoding, expected latin1");
    std::optional<std::string> latin1 = Latin1FromUtf8(Expect<Text>(arguments[0], "a text").utf8);
    if (!latin1) Fail("a text that is not Latin-1, expected bytes");
    encoded_bytes_ += latin1->size();
    if (encoded_bytes_ > bytes_.size()) Fail("more encoded bytes than the file has");
    return std::make_shared<const std::string>(std::move(*latin1));
  }

  Dtype DtypeOf(std::string_view name) const {
    const std::string_view whole = name;
    bool big_endian = false;
    if (!name.empty() && std::string_view("<>|=").find(name.front()) != std::string_view::npos) {
      big_endian = name.front() == '>';
      name.remove_prefix(1);
    }
    if (name == "b1") return {NumpyArray::Kind::kBool, 1, false};
    std::size_t size = 0;
    if (name.size() == 2 && ParseNumber(name.substr(1), size) && std::has_single_bit(size) && size <= 8) {
      if (name[0] == 'i') return {NumpyArray::Kind::kSigned, size, big_endian};
      if (name[0] == 'u') return {NumpyArray::Kind::kUnsigned, size, big_endian};
      if (name[0] == 'f' && size >= 4) return {NumpyArray::Kind::kFloat, size, big_endian};
    }
    Fail("an array of type '{}', expected b1, i1 to i8, u1 to u8, f4 or f8", Printable(whole, 20));
  }

  NumpyArray ArrayOf(Index shape, Index dtype, bool column_major, Index data) {
    const Dtype& type = Expect<Dtype>(dtype, "the type of an array");
    NumpyArray array{type.kind, type.item_bytes, type.big_endian, column_major, {}, nullptr};
    const Sequence& lengths = Expect<Sequence>(shape, "the shape of an array");
    if (lengths.items.size() > kMaxPickledDimensions)
      Fail("an array of {} dimensions, expected at most {}", lengths.items.size(), kMaxPickledDimensions);
    for (const Index length : lengths.items) {
      const std::int64_t value = Expect<std::int64_t>(length, "a length");
      if (value < 0) Fail("an array of length {}, expected 0 or more", value);
      array.shape.push_back(static_cast<std::size_t>(value));
    }
    array.bytes = Expect<Bytes>(data, "the bytes of an array");
    if (ByteCount(array.shape, array.item_bytes) != array.bytes->size()) {
      Fail("an array of {} {} has {} bytes", array.ShapeText(), array.TypeName(), array.bytes->size());
    }
    return array;
  }

  // Sets the state of an array or of a type.
  void Build() {
    const std::vector<Index>& state = Expect<Sequence>(Pop(), "a state").items;
    const Index target = Top();
    if (As<NumpyArray>(target) != nullptr) {
      if (state.size() != 5) Fail("a state of {} values, expected the 5 of an array", state.size());
      const bool column_major = IsTrue(state[3]);
      nodes_[target] = ArrayOf(state[1], state[2], column_major, state[4]);
      return;
    }
    auto& dtype = Expect<Dtype>(target, "an array or its type");
    if (state.size() != 8 && state.size() != 9)  // the ninth holds remarks
      Fail("a state of {} values, expected the 8 of a type", state.size());
    const std::string order = Expect<Text>(state[1], "a byte order").utf8;
    if (order != "<" && order != ">" && order != "|" && order != "=")
      Fail("byte order '{}', expected <, >, | or =", Printable(order, 10));
    for (const std::size_t i : {2, 3, 4}) Expect<None>(state[i], "a type without fields");
    dtype.big_endian = order == ">";
  }

  bool IsTrue(Index index) {
    if (const bool* value = As<bool>(index)) return *value;
    return Expect<std::int64_t>(index, "True or False") != 0;
  }

  // The last value of a key counts. One long text may be the key of many items. It is read once.
  PickledDict Result() {
    PickledDict result;
    const auto& items = Expect<Dict>(Pop(), "a dict of arrays").items;
    std::unordered_set<Index> recalled;
    std::unordered_set<std::string_view> names;
    for (auto item = items.rbegin(); item != items.rend(); ++item) {
      if (!recalled.insert(item->first).second) continue;
      const Text* const name = As<Text>(item->first);
      if (name == nullptr || !names.insert(name->utf8).second) continue;
      result.keys.push_back(name->utf8);
      const NumpyArray* const array = As<NumpyArray>(item->second);
      if (array != nullptr && array->bytes != nullptr) result.arrays.emplace(name->utf8, *array);
    }
    std::reverse(result.keys.begin(), result.keys.end());
    return result;
  }

  const std::string& bytes_;
  std::string file_;
  std::size_t at_ = 0;
  std::size_t operation_at_ = 0;
  bool stopped_ = false;
  std::vector<Node> nodes_;
  std::vector<Index> stack_;
  std::vector<std::size_t> marks_;  // heights of the stack
  std::unordered_map<std::uint64_t, Index> memo_;
  std::size_t encoded_bytes_ = 0;
};

}  // namespace

PickledDict ReadPickledArrays(const std::string& bytes, const std::string& file) {
  return Unpickler(bytes, file).Read();
}

double NumpyArray::At(std::size_t row, std::size_t col) const {
  SONARCAL_CHECK(item_bytes > 0 && shape.size() == 2 && row < shape[0] && col < shape[1], "({}, {}) of {}",
                 row, col, ShapeText());
  const std::size_t item = column_major ? col * shape[0] + row : row * shape[1] + col;
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < item_bytes; ++i) {
    const std::size_t byte = big_endian ? i : item_bytes - 1 - i;  // from the most significant one
    bits = bits << 8 | static_cast<unsigned char>((*bytes)[item * item_bytes + byte]);
  }
  const int unused = static_cast<int>(64 - 8 * item_bytes);
  switch (kind) {
    case Kind::kBool:
      return bits != 0 ? 1.0 : 0.0;
    case Kind::kUnsigned:
      return static_cast<double>(bits);
    case Kind::kSigned:
      return static_cast<double>(static_cast<std::int64_t>(bits << unused) >> unused);
    case Kind::kFloat:
      break;
  }
  if (item_bytes == 4) return std::bit_cast<float>(static_cast<std::uint32_t>(bits));
  return std::bit_cast<double>(bits);
}

std::string NumpyArray::TypeName() const {
  switch (kind) {
    case Kind::kBool:
      return "bool";
    case Kind::kSigned:
      return fmt::format("int{}", 8 * item_bytes);
    case Kind::kUnsigned:
      return fmt::format("uint{}", 8 * item_bytes);
    case Kind::kFloat:
      break;
  }
  return fmt::format("float{}", 8 * item_bytes);
}

std::string NumpyArray::ShapeText() const {
  if (shape.empty()) return "1";
  std::string text;
  for (const std::size_t length : shape) text += fmt::format("{}{}", text.empty() ? "" : " x ", length);
  return text;
}

}  // namespace sonarcal::data_io
