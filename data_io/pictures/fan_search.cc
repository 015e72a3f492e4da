#include "data_io/pictures/fan_search.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <numeric>
#include <string>
#include <utility>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/types/error.h"
#include "core/types/units.h"

namespace sonarcal::data_io {
namespace {

using Color = std::array<std::uint8_t, 3>;

constexpr int kMaxSearchedFrames = 32;
constexpr int kLossyTolerance = 24;                 // for ringing at edges in a compressed picture
constexpr std::size_t kMaxOverlayPixels = 1 << 24;  // larger pictures are searched whole, for lack of memory

int MaxDifference(const Color& a, const Color& b) {
  int most = 0;
  for (int i = 0; i < 3; ++i) most = std::max(most, std::abs(int{a[i]} - int{b[i]}));
  return most;
}

// Colour of most of the border; black if no colour has half of it.
Color BackgroundOf(const RgbImage& picture, int tolerance) {
  std::vector<Color> border;
  for (int col = 0; col < picture.cols(); ++col) {
    border.push_back(picture(0, col));
    border.push_back(picture(picture.rows() - 1, col));
  }
  for (int row = 0; row < picture.rows(); ++row) {
    border.push_back(picture(row, 0));
    border.push_back(picture(row, picture.cols() - 1));
  }
  Color median = {0, 0, 0};
  for (int i = 0; i < 3; ++i) {
    std::vector<std::uint8_t> channel;
    for (const Color& color : border) channel.push_back(color[i]);
    const auto middle = channel.begin() + static_cast<std::ptrdiff_t>(channel.size() / 2);
    std::ranges::nth_element(channel, middle);
    median[i] = *middle;
  }
  const auto alike = std::ranges::count_if(
      border, [&](const Color& color) { return MaxDifference(color, median) <= tolerance; });
  return 2 * alike >= std::ssize(border) ? median : Color{0, 0, 0};
}

// A mask as a picture of OpenCV that shares its pixels.
cv::Mat MatOf(Mask& mask) {
  return {mask.rows(), mask.cols(), CV_8UC1, mask.values().data()};
}

// Pixels up to `reach` pixels from a set one.
Mask Widened(Mask mask, int reach) {
  if (reach == 0) return mask;
  const cv::Mat picture = MatOf(mask);
  const int side = 2 * reach + 1;
  cv::dilate(picture, picture, cv::getStructuringElement(cv::MORPH_RECT, {side, side}));
  return mask;
}

// Connected parts of a mask.
struct Parts {
  cv::Mat label;  // number of the part of each pixel; 0: none
  cv::Mat box;    // row of each part: OpenCV's left, top, width, height, area
  int count = 0;  // with number 0

  int LabelAt(int row, int col) const { return label.at<int>(row, col); }
};

Parts PartsOf(Mask mask) {
  Parts parts;
  cv::Mat centres;
  parts.count = cv::connectedComponentsWithStats(MatOf(mask), parts.label, parts.box, centres, 8, CV_32S);
  return parts;
}

// Pixels of `mask` in the parts for which `chosen` is true.
Mask PixelsIn(const Mask& mask, const Parts& parts, const std::vector<bool>& chosen) {
  Mask pixels(mask.rows(), mask.cols());
  for (int row = 0; row < mask.rows(); ++row) {
    for (int col = 0; col < mask.cols(); ++col)
      pixels(row, col) = mask(row, col) != 0 && chosen[parts.LabelAt(row, col)] ? 1 : 0;
  }
  return pixels;
}

// True beside the sides of the fan, below its near arc, or beyond a far arc that is visible.
bool LiesBeside(const FanGeometry& fan, bool arc_is_visible, int row, int col) {
  constexpr double kMarginPx = 3.0;
  const double ahead = fan.apex_y_px - row;
  const double right = (col - fan.apex_x_px) / fan.x_scale;
  const double half_rad = RadFromDeg(fan.half_angle_deg);
  const double beyond_side = std::abs(right) * std::cos(half_rad) - ahead * std::sin(half_rad);
  const double radius = std::hypot(right, ahead);
  return ahead <= 0.0 || beyond_side > kMarginPx || radius < fan.radius_min_px - kMarginPx ||
         (arc_is_visible && radius > fan.radius_max_px + kMarginPx);
}

// Parts of which most pixels lie beside the fan. `size` holds the lit pixels of each part.
std::vector<bool> PartsBeside(const FanGeometry& fan, bool arc_is_visible, const Mask& lit,
                              const Parts& parts, const std::vector<std::int64_t>& size) {
  std::vector<std::int64_t> beside(parts.count);
  for (int row = 0; row < lit.rows(); ++row) {
    for (int col = 0; col < lit.cols(); ++col) {
      if (lit(row, col) != 0 && LiesBeside(fan, arc_is_visible, row, col)) ++beside[parts.LabelAt(row, col)];
    }
  }
  std::vector<bool> chosen(parts.count);
  for (int part = 1; part < parts.count; ++part) chosen[part] = 2 * beside[part] > size[part];
  return chosen;
}

// Largest letter that is expected in a picture.
int MaxLetterPx(const Mask& picture) {
  return std::max(24, std::max(picture.rows(), picture.cols()) / 20);
}

// True if no chosen part is higher than `max_px`.
bool AreLow(const Parts& parts, const std::vector<bool>& chosen, int max_px) {
  for (int part = 1; part < parts.count; ++part) {
    if (chosen[part] && parts.box.at<int>(part, cv::CC_STAT_HEIGHT) > max_px) return false;
  }
  return true;
}

// Moves pixels from `lit` to `overlay`.
void LeaveOut(const Mask& pixels, Mask& lit, Mask& overlay) {
  for (std::size_t i = 0; i < lit.size(); ++i) {
    if (pixels.values()[i] == 0) continue;
    overlay.values()[i] = 1;
    lit.values()[i] = 0;
  }
}

// Small parts that are the same in all frames, if most lit pixels change.
Mask WhatStays(const Grid<std::uint8_t>& change, const Mask& lit, bool is_lossy) {
  constexpr int kTolerance = 2;  // grey levels
  Mask stays(lit.rows(), lit.cols());
  for (std::size_t i = 0; i < lit.size(); ++i)
    stays.values()[i] = lit.values()[i] != 0 && change.values()[i] <= kTolerance ? 1 : 0;
  if (2 * CountSet(stays) > CountSet(lit)) return Mask(lit.rows(), lit.cols());  // nothing moves
  // Letters are small. A part of the fan that stays, such as a saturated one, is larger.
  const int max_side = MaxLetterPx(lit);
  const Parts parts = PartsOf(stays);
  std::vector<bool> small(parts.count);
  for (int part = 1; part < parts.count; ++part) {
    small[part] = parts.box.at<int>(part, cv::CC_STAT_WIDTH) <= max_side &&
                  parts.box.at<int>(part, cv::CC_STAT_HEIGHT) <= max_side;
  }
  // Compression blurs the edges of letters.
  return Widened(PixelsIn(stays, parts, small), is_lossy ? 1 : 0);
}

// Parts beside the fan, if the outline without them is clearer. Each of the largest parts may be the fan:
// parts between the sides of that fan belong to it, the others are left out.
Mask WhatLiesBeside(const Mask& lit) {
  constexpr int kReachPx = 2;           // joins the speckle of a dark fan to one part
  constexpr std::size_t kMaxParts = 3;  // largest parts, each of which may be the fan
  constexpr double kMinGain = 0.15;     // of the sum of visible fractions
  constexpr double kMaxLoss = 0.05;     // of that sum, for text
  constexpr double kClear = 0.5;        // visible fraction of a clear outline
  const Parts parts = PartsOf(Widened(lit, kReachPx));
  Mask overlay(lit.rows(), lit.cols());
  if (parts.count <= 2) return overlay;  // one part
  std::vector<std::int64_t> size(parts.count);
  for (int row = 0; row < lit.rows(); ++row) {
    for (int col = 0; col < lit.cols(); ++col) size[parts.LabelAt(row, col)] += lit(row, col);
  }
  std::vector<int> by_size(parts.count - 1);
  std::iota(by_size.begin(), by_size.end(), 1);
  std::ranges::stable_sort(by_size, std::greater<>(), [&](int part) { return size[part]; });
  by_size.resize(std::min(by_size.size(), kMaxParts));

  const std::optional<FanGeometry> whole = FindFanGeometry(lit);
  const FanVisibility visible_whole = whole ? VisibilityOf(*whole, lit) : FanVisibility{};
  double best = 0.0;
  for (const int part : by_size) {
    std::vector<bool> chosen(parts.count);
    chosen[part] = true;
    const Mask body = PixelsIn(lit, parts, chosen);
    const std::optional<FanGeometry> own = FindFanGeometry(body);
    if (!own) continue;
    chosen = PartsBeside(*own, VisibilityOf(*own, body).far_arc > kClear, lit, parts, size);
    chosen[part] = false;
    const Mask others = PixelsIn(lit, parts, chosen);
    Mask rest = lit;
    for (std::size_t i = 0; i < rest.size(); ++i) rest.values()[i] -= others.values()[i];
    const std::optional<FanGeometry> fan = FindFanGeometry(rest);
    if (!fan) continue;
    const FanVisibility visible = VisibilityOf(*fan, rest);
    if (visible.min() < kClear && 2 * CountSet(others) > CountSet(lit)) continue;
    // Lines of text beside a dark fan are the outline of a larger one, which is as visible.
    const bool is_text = AreLow(parts, chosen, MaxLetterPx(lit));
    const double required = whole ? visible_whole.sum() + (is_text ? -kMaxLoss : kMinGain) : 0.0;
    if (visible.sum() < required || visible.sum() <= best) continue;
    best = visible.sum();
    overlay = others;
  }
  return overlay;
}

}  // namespace

// Differences of each pixel, the largest of its channels.
struct FanSearch::Differences {
  Grid<std::uint8_t> from_background;  // largest in any frame
  Grid<std::uint8_t> between_frames;
  int frames = 0;
};

FanSearch::FanSearch(const PictureFrames& pictures) : pictures_(pictures) {
  Differences differences;
  Grid<std::uint8_t>& from_background = differences.from_background;
  RgbImage lowest;
  RgbImage highest;
  for (const int index : EvenlySpreadFrames(pictures, kMaxSearchedFrames)) {
    const RgbImage picture = pictures.ReadColors(index);
    if (from_background.empty()) {
      background_ = BackgroundOf(picture, pictures.is_lossy() ? kLossyTolerance : 0);
      from_background = Grid<std::uint8_t>(picture.rows(), picture.cols());
      if (picture.size() <= kMaxOverlayPixels) lowest = highest = picture;
    }
    if (picture.rows() != from_background.rows() || picture.cols() != from_background.cols()) {
      FailOfPictureSize(picture.rows(), picture.cols(), from_background.rows(), from_background.cols(),
                        pictures.name(index));
    }
    ++differences.frames;
    for (std::size_t i = 0; i < picture.size(); ++i) {
      const Color& color = picture.values()[i];
      const auto difference = static_cast<std::uint8_t>(MaxDifference(color, background_));
      from_background.values()[i] = std::max(from_background.values()[i], difference);
      if (lowest.empty()) continue;
      for (int channel = 0; channel < 3; ++channel) {
        lowest.values()[i][channel] = std::min(lowest.values()[i][channel], color[channel]);
        highest.values()[i][channel] = std::max(highest.values()[i][channel], color[channel]);
      }
    }
  }
  differences.between_frames = Grid<std::uint8_t>(lowest.rows(), lowest.cols());
  std::ranges::transform(
      lowest.values(), highest.values(), differences.between_frames.values().begin(),
      [](const Color& a, const Color& b) { return static_cast<std::uint8_t>(MaxDifference(a, b)); });
  overlay_ = Mask(from_background.rows(), from_background.cols());
  // A picture without losses may have been made from one with losses.
  constexpr double kMinGain = 0.15;
  TryTolerance(pictures.is_lossy() ? kLossyTolerance : 0, differences, 0.0);
  if (!pictures.is_lossy()) TryTolerance(kLossyTolerance, differences, visibility_.sum() + kMinGain);
}

void FanSearch::TryTolerance(int tolerance, const Differences& differences, double min_visibility) {
  constexpr int kMinFrames = 4;  // frames that show what changes
  Mask lit(overlay_.rows(), overlay_.cols());
  std::ranges::transform(differences.from_background.values(), lit.values().begin(),
                         [&](std::uint8_t value) { return std::uint8_t{value > tolerance}; });
  Mask overlay(lit.rows(), lit.cols());
  if (lit.size() <= kMaxOverlayPixels) {
    if (differences.frames >= kMinFrames)
      LeaveOut(WhatStays(differences.between_frames, lit, pictures_.is_lossy()), lit, overlay);
    LeaveOut(WhatLiesBeside(lit), lit, overlay);
  }
  const std::optional<FanGeometry> fan = FindFanGeometry(lit);
  if (!fan) return;
  const FanVisibility visibility = VisibilityOf(*fan, lit);
  if (fan_ && visibility.sum() < min_visibility) return;
  fan_ = fan;
  visibility_ = visibility;
  overlay_ = std::move(overlay);
  tolerance_ = tolerance;
}

Mask FanSearch::LitPixels(int index) const {
  const RgbImage picture = pictures_.ReadColors(index);
  if (picture.rows() != overlay_.rows() || picture.cols() != overlay_.cols()) {
    FailOfPictureSize(picture.rows(), picture.cols(), overlay_.rows(), overlay_.cols(),
                      pictures_.name(index));
  }
  Mask lit(picture.rows(), picture.cols());
  for (std::size_t i = 0; i < lit.size(); ++i) {
    lit.values()[i] =
        overlay_.values()[i] == 0 && MaxDifference(picture.values()[i], background_) > tolerance_ ? 1 : 0;
  }
  return lit;
}

std::vector<int> EvenlySpreadFrames(const PictureFrames& pictures, int max_count) {
  const int count = std::min(pictures.count(), max_count);
  std::vector<int> indices;
  for (int i = 0; i < count; ++i)
    indices.push_back(static_cast<int>(static_cast<std::int64_t>(i) * pictures.count() / count));
  return indices;
}

void FailOfPictureSize(int rows, int cols, int first_rows, int first_cols, const std::string& name) {
  throw DataError("{}: {} x {} pixels, expected those of the first picture, {} x {}", name, rows, cols,
                  first_rows, first_cols);
}

}  // namespace sonarcal::data_io
