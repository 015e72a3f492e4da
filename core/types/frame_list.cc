#include "core/types/frame_list.h"

#include <fmt/format.h>

#include <cstddef>
#include <utility>

#include "core/types/error.h"
#include "core/types/parse_number.h"
#include "core/types/printable.h"

namespace sonarcal {
namespace {

constexpr int kMaxNumber = 1'000'000'000;

bool ParseFrame(std::string_view text, int& frame) {
  return ParseNumber(text, frame) && frame >= 0 && frame <= kMaxNumber;
}

}  // namespace

FrameList::FrameList(const std::vector<int>& frames) {
  for (const int frame : frames) Add({.begin = frame, .end = frame + 1});
}

std::optional<FrameList::Range> FrameList::ParseRange(std::string_view text) {
  Range range;
  const std::size_t colon = text.find(':');
  if (colon == std::string_view::npos) {
    if (!ParseFrame(text, range.begin)) return {};
    range.end = range.begin + 1;
    return range;
  }
  const std::string_view begin = text.substr(0, colon);
  const std::string_view end = text.substr(colon + 1);
  if (!begin.empty() && !ParseFrame(begin, range.begin)) return {};
  if (end.empty()) return range;
  int last = 0;
  if (!ParseFrame(end, last) || range.begin >= last) return {};
  range.end = last;
  return range;
}

std::optional<FrameList> FrameList::Parse(std::string_view text) {
  if (text == "all") text = ":";
  FrameList list;
  for (std::string_view rest = text;;) {
    const std::size_t comma = rest.find(',');
    const std::optional<Range> range = ParseRange(rest.substr(0, comma));
    if (!range) return {};
    list.Add(*range);
    if (comma == std::string_view::npos) return list;
    rest.remove_prefix(comma + 1);
  }
}

FrameList FrameList::Read(std::string_view option, const std::string& text) {
  std::optional<FrameList> list = Parse(text);
  if (!list) throw UsageError("{} '{}', expected {}", option, Printable(text), kFrameListExpected);
  return std::move(*list);
}

void FrameList::Add(const Range& range) {
  if (!ranges_.empty() && ranges_.back().end == range.begin) {
    ranges_.back().end = range.end;
  } else {
    ranges_.push_back(range);
  }
}

std::string FrameList::Range::Text() const {
  if (!end) return begin == 0 ? ":" : fmt::format("{}:", begin);
  return *end == begin + 1 ? fmt::format("{}", begin) : fmt::format("{}:{}", begin, *end);
}

std::string FrameList::Text() const {
  std::string text;
  for (const Range& range : ranges_) {
    if (!text.empty()) text += ',';
    text += range.Text();
  }
  return text;
}

std::optional<std::vector<int>> FrameList::Numbers() const {
  std::vector<int> frames;
  for (const Range& range : ranges_) {
    if (!range.end) return {};
    for (int frame = range.begin; frame < *range.end; ++frame) frames.push_back(frame);
  }
  return frames;
}

std::vector<int> FrameList::In(int frame_count, std::string_view kind) const {
  std::vector<int> frames;
  std::vector<bool> named(static_cast<std::size_t>(frame_count));
  for (const Range& range : ranges_) {
    const int end = range.end.value_or(frame_count);
    if (range.begin < 0 || range.begin >= end || end > frame_count) {
      throw DataError("{}{} {} of a recording of {} frames (0 .. {})", kind,
                      range.end == range.begin + 1 ? "" : "s", range.Text(), frame_count, frame_count - 1);
    }
    for (int frame = range.begin; frame < end; ++frame) {
      if (named[static_cast<std::size_t>(frame)])
        throw UsageError("{}s '{}' name frame {} twice", kind, Text(), frame);
      named[static_cast<std::size_t>(frame)] = true;
      frames.push_back(frame);
    }
  }
  return frames;
}

}  // namespace sonarcal
