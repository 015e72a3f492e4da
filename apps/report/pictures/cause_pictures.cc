#include "apps/report/pictures/cause_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>

#include <opencv2/imgproc.hpp>

#include "data_io/pictures/picture.h"

namespace sonarcal::report {
namespace {

using Rgb = std::array<std::uint8_t, 3>;

constexpr Rgb kDark = {24, 26, 30};
constexpr Rgb kRed = {213, 40, 40};
// Colours of Okabe and Ito 2008 without black, and two greys.
constexpr std::array<Rgb, 9> kCauses = {{{110, 115, 122},
                                         {86, 180, 233},
                                         {230, 159, 0},
                                         {0, 158, 115},
                                         {240, 228, 66},
                                         {204, 121, 167},
                                         {0, 114, 178},
                                         {213, 94, 0},
                                         {200, 200, 205}}};

Rgb ColourOf(std::size_t name) {
  if (name == workflow::kNotBright) return kDark;
  if (name == workflow::kUnexplained) return kRed;
  return kCauses[(name - 2) % kCauses.size()];
}

}  // namespace

std::vector<std::string> CauseColours(std::size_t names) {
  std::vector<std::string> colours;
  for (std::size_t name = 0; name < names; ++name) {
    const auto [r, g, b] = ColourOf(name);
    colours.push_back(fmt::format("#{:02x}{:02x}{:02x}", r, g, b));
  }
  return colours;
}

RgbImage CausePicture(const Grid<std::uint8_t>& cause) {
  RgbImage picture(cause.rows(), cause.cols());
  for (std::size_t i = 0; i < picture.size(); ++i) picture.values()[i] = ColourOf(cause.values()[i]);
  return data_io::StretchPolar(picture);
}

RgbImage WithLegend(const RgbImage& picture, const Grid<std::uint8_t>& cause,
                    const std::vector<std::string>& names) {
  constexpr int kLine = 22;
  constexpr int kMargin = 8;
  constexpr int kSwatch = 14;
  constexpr int kWidest = 420;  // width of a name
  const std::set<std::uint8_t> present(cause.values().begin(), cause.values().end());
  const int width = std::max(picture.cols(), kWidest);
  const int height = picture.rows() + 2 * kMargin + kLine * static_cast<int>(present.size());
  cv::Mat3b canvas(height, width, cv::Vec3b(255, 255, 255));
  for (int row = 0; row < picture.rows(); ++row) {
    for (int col = 0; col < picture.cols(); ++col) {
      const auto [r, g, b] = picture(row, col);
      canvas(row, col) = cv::Vec3b(r, g, b);
    }
  }
  int top = picture.rows() + kMargin;
  for (const std::uint8_t name : present) {
    const auto [r, g, b] = ColourOf(name);
    cv::rectangle(canvas, cv::Rect(kMargin, top, kSwatch, kSwatch), cv::Scalar(r, g, b), cv::FILLED);
    cv::putText(canvas, names[name], cv::Point(2 * kMargin + kSwatch, top + kSwatch - 2),
                cv::FONT_HERSHEY_SIMPLEX, 0.45, cv::Scalar(20, 24, 28), 1, cv::LINE_AA);
    top += kLine;
  }
  RgbImage drawn(height, width);
  for (int row = 0; row < height; ++row) {
    for (int col = 0; col < width; ++col) {
      const cv::Vec3b& pixel = canvas(row, col);
      drawn(row, col) = {pixel[0], pixel[1], pixel[2]};
    }
  }
  return drawn;
}

std::vector<LegendEntry> CauseLegend(const std::vector<workflow::CauseMap>& maps,
                                     const std::vector<std::string>& names) {
  std::set<std::uint8_t> present;
  for (const workflow::CauseMap& map : maps)
    present.insert(map.cause.values().begin(), map.cause.values().end());
  const std::vector<std::string> colours = CauseColours(names.size());
  std::vector<LegendEntry> legend;
  for (const std::uint8_t name : present) legend.push_back({colours[name], names[name]});
  return legend;
}

}  // namespace sonarcal::report
