// Frames of a recording as a user names them, counted from 0.
//
//   FrameList::Parse("3,80:116")   frame 3, and frame 80 up to, but not including, 116
//   FrameList::Parse("80:")        frame 80 up to the last
//   FrameList::Parse(":20")        the first 20 frames
//   FrameList::Parse("all")        every frame
//
// This is the only parser of such texts.
#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace sonarcal {

// End of a message about a text that is no list of frames.
inline constexpr const char* kFrameListExpected =
    "frames K and ranges A:B (up to, but not including, B), A: or :B, separated by commas";

// Kind of a frame in messages.
inline constexpr const char* kHeldOutFrame = "held-out frame";

class FrameList {
 public:
  FrameList() = default;
  FrameList(const std::vector<int>& frames);  // NOLINT(google-explicit-constructor)
  FrameList(std::initializer_list<int> frames) : FrameList(std::vector<int>(frames)) {}

  // Returns nothing if `text` is no list of frames.
  static std::optional<FrameList> Parse(std::string_view text);

  bool empty() const { return ranges_.empty(); }

  // As Parse. Throws UsageError that names `option` and the text.
  static FrameList Read(std::string_view option, const std::string& text);

  // Inverse of Parse. Neighbouring frames appear as a range.
  std::string Text() const;

  // The frames in their order. Nothing if a range is open to the last frame.
  std::optional<std::vector<int>> Numbers() const;

  // The frames, in their order, of a recording with `frame_count` frames. `kind` names one of them in
  // messages. Throws DataError for a frame that does not exist, and UsageError for a frame that is named
  // twice.
  std::vector<int> In(int frame_count, std::string_view kind = "frame") const;

  bool operator==(const FrameList&) const = default;

 private:
  struct Range {
    int begin = 0;
    std::optional<int> end = {};  // one past the last; absent: up to the last frame

    std::string Text() const;
    bool operator==(const Range&) const = default;
  };

  static std::optional<Range> ParseRange(std::string_view text);

  // Extends the last range if `range` continues it.
  void Add(const Range& range);

  std::vector<Range> ranges_;
};

}  // namespace sonarcal
