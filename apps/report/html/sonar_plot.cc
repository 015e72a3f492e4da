#include "apps/report/html/sonar_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>

#include "apps/report/html/axis_ticks.h"
#include "apps/report/html/html_text.h"
#include "core/imaging/fan_image.h"
#include "core/types/error.h"
#include "core/types/units.h"
#include "data_io/pictures/picture.h"

namespace sonarcal::report {
namespace {

// Sizes in units of the drawing, which the page scales.
constexpr double kSonarPlotWidth = 220.0;
constexpr double kMaxPlotHeight = 300.0;
constexpr double kSonarLeft = 36.0;
constexpr double kSonarRight = 14.0;
constexpr double kSonarTop = 20.0;
constexpr double kSonarBottom = 38.0;
constexpr double kBarHeight = 7.0;

template <typename... Args>
void AppendSvg(std::string& out, fmt::format_string<Args...> format, Args&&... args) {
  fmt::format_to(std::back_inserter(out), format, std::forward<Args>(args)...);
}

constexpr int kFanRows = 480;

struct Size {
  double width = 0.0;
  double height = 0.0;
};

// Returns the largest plot within the limits. A polar plot is 3 wide and 4 high.
Size SizeWithin(const PolarAxes& axes, SonarView view, double max_width, double max_height) {
  double aspect = 0.75;
  if (view == SonarView::kFan) {
    const FanAxes fan = FanAxesFor(axes, {.height_px = kFanRows});
    aspect = static_cast<double>(fan.cols) / fan.rows;
  }
  const double height = std::min(max_width / aspect, max_height);
  return {height * aspect, height};
}

// Places ranges and azimuths in a box of this size.
class Layout {
 public:
  Layout(const PolarAxes& axes, SonarView view, const Size& size)
      : axes_(axes), view_(view), edges_rad_(axes.BeamEdgesRad()), size_(size) {
    if (view != SonarView::kFan) return;
    const FanAxes fan = FanAxesFor(axes, {.height_px = kFanRows});
    left_m_ = fan.x_min_m;
    top_m_ = fan.y_max_m;
    unit_m_ = fan.pixel_m * fan.rows / size.height;
  }

  double first_rad() const { return edges_rad_.front(); }
  double last_rad() const { return edges_rad_.back(); }

  std::array<double, 2> At(double range_m, double azimuth_rad) const {
    if (view_ == SonarView::kFan) {
      return {(range_m * std::sin(azimuth_rad) - left_m_) / unit_m_,
              (top_m_ - range_m * std::cos(azimuth_rad)) / unit_m_};
    }
    return {size_.width * BeamAt(azimuth_rad) / axes_.beam_count(),
            size_.height * (range_m - axes_.range_min_m) / (axes_.range_max_m - axes_.range_min_m)};
  }

  // Path along a range from the left edge to the right one, or backwards.
  std::string Arc(double range_m, bool backwards = false) const {
    const auto [x, y] = At(range_m, backwards ? first_rad() : last_rad());
    if (view_ == SonarView::kPolar) return fmt::format("L{:.1f} {:.1f}", x, y);
    return fmt::format("A{0:.1f} {0:.1f} 0 {1} {2} {3:.1f} {4:.1f}", range_m / unit_m_,
                       last_rad() - first_rad() > kPi ? 1 : 0, backwards ? 0 : 1, x, y);
  }

  std::string Move(char command, double range_m, double azimuth_rad) const {
    const auto [x, y] = At(range_m, azimuth_rad);
    return fmt::format("{}{:.1f} {:.1f}", command, x, y);
  }

  std::string Outline() const {
    return Move('M', axes_.range_max_m, first_rad()) + Arc(axes_.range_max_m) +
           Move('L', axes_.range_min_m, last_rad()) + Arc(axes_.range_min_m, true) + "Z";
  }

 private:
  // Beam and fraction of a beam, from the left edge of the first one.
  double BeamAt(double azimuth_rad) const {
    const auto above = std::upper_bound(edges_rad_.begin() + 1, edges_rad_.end() - 1, azimuth_rad);
    const double low = *(above - 1);
    return static_cast<double>(above - 1 - edges_rad_.begin()) + (azimuth_rad - low) / (*above - low);
  }

  const PolarAxes& axes_;
  SonarView view_;
  std::vector<double> edges_rad_;
  Size size_;
  double left_m_ = 0.0;
  double top_m_ = 0.0;
  double unit_m_ = 1.0;
};

double RangeStep(const PolarAxes& axes) {
  return NiceStep(axes.range_max_m - axes.range_min_m, 6);
}

// Space for the longest range at the left.
double LeftOf(const PolarAxes& axes) {
  constexpr std::size_t kShortText = 3;  // such as 9.5
  constexpr double kCharacter = 5.5;
  std::size_t longest = kShortText;
  const double step = RangeStep(axes);
  for (const double range : TicksWithin(axes.range_min_m, axes.range_max_m, step))
    longest = std::max(longest, FormatNumber(range, DecimalsOf(step)).size());
  return kSonarLeft + kCharacter * static_cast<double>(longest - kShortText);
}

// Rings with their ranges, rays with their azimuths, and the outline.
std::string Axes(const PolarAxes& axes, SonarView view, const Size& size) {
  const Layout layout(axes, view, size);
  std::string lines;
  std::string texts;
  const double range_step = RangeStep(axes);
  for (const double range : TicksWithin(axes.range_min_m, axes.range_max_m, range_step)) {
    lines += layout.Move('M', range, layout.first_rad()) + layout.Arc(range);
    const auto [x, y] = layout.At(range, layout.first_rad());
    AppendSvg(texts,
              R"svg(<text class="range" x="{:.1f}" y="{:.1f}" text-anchor="end" )svg"
              R"svg(dy="0.35em">{} m</text>)svg",
              x - 5.0, y, FormatNumber(range, DecimalsOf(range_step)));
  }
  const double first_deg = DegFromRad(layout.first_rad());
  const double last_deg = DegFromRad(layout.last_rad());
  const double azimuth_step = NiceStep(last_deg - first_deg, 6);
  for (const double azimuth : TicksWithin(first_deg, last_deg, azimuth_step)) {
    const double azimuth_rad = RadFromDeg(azimuth);
    lines +=
        layout.Move('M', axes.range_min_m, azimuth_rad) + layout.Move('L', axes.range_max_m, azimuth_rad);
    const bool is_fan = view == SonarView::kFan;
    const auto [x, y] = layout.At(is_fan ? axes.range_max_m : axes.range_min_m, azimuth_rad);
    constexpr double kApart = 9.0;
    AppendSvg(texts,
              R"svg(<text class="azimuth" x="{:.1f}" y="{:.1f}" text-anchor="middle" )svg"
              R"svg(dy="0.35em">{}°</text>)svg",
              is_fan ? x + kApart * std::sin(azimuth_rad) : x,
              is_fan ? y - kApart * std::cos(azimuth_rad) : y - kApart,
              FormatNumber(azimuth, DecimalsOf(azimuth_step)));
  }
  return fmt::format(R"svg(<path class="ring" d="{}"/><path class="edge" d="{}"/>{})svg", lines,
                     layout.Outline(), texts);
}

std::string_view GradientOf(SonarColours colours) {
  switch (colours) {
    case SonarColours::kOverlay:
      return "overlay";
    case SonarColours::kDifference:
      return "difference";
    default:
      return "inferno";
  }
}

std::string Bar(std::string_view gradient, const std::array<std::string, 3>& texts, double width) {
  std::string svg = fmt::format(R"svg(<rect class="bar" width="{}" height="{}" fill="url(#bar-{})"/>)svg",
                                width, kBarHeight, gradient);
  constexpr std::array<std::string_view, 3> kAnchors = {"start", "middle", "end"};
  for (std::size_t i = 0; i < texts.size(); ++i) {
    if (texts[i].empty()) continue;
    AppendSvg(svg, R"svg(<text x="{:.1f}" y="{}" text-anchor="{}">{}</text>)svg",
              0.5 * width * static_cast<double>(i), kBarHeight + 11.0, kAnchors[i], EscapeHtml(texts[i]));
  }
  return svg;
}

std::string Image(const StoredPicture& picture, const Size& size, std::string_view filter) {
  return fmt::format(R"svg(<use href="#{}" transform="scale({:.6g} {:.6g})"{}/>)svg", picture.id,
                     size.width / picture.cols, size.height / picture.rows,
                     filter.empty() ? std::string() : fmt::format(R"svg( filter="url(#{})")svg", filter));
}

std::string Images(SonarColours colours, const std::vector<StoredPicture>& pictures, const Size& size) {
  if (colours == SonarColours::kOverlay) {
    SONARCAL_CHECK(pictures.size() == 2, "an overlay of {} pictures", pictures.size());
    return fmt::format(R"svg(<g class="overlay">{}{}</g>)svg", Image(pictures[0], size, "in-blue"),
                       Image(pictures[1], size, "in-orange"));
  }
  SONARCAL_CHECK(pictures.size() == 1, "{} pictures in one", pictures.size());
  const std::string_view filter = !pictures[0].is_grey                ? ""
                                  : colours == SonarColours::kRegions ? "regions"
                                                                      : "inferno";
  return Image(pictures[0], size, filter);
}

std::string Gradient(std::string_view name, std::span<const data_io::Rgb> colours) {
  std::string svg = fmt::format(R"svg(<linearGradient id="bar-{}">)svg", name);
  for (std::size_t i = 0; i < colours.size(); ++i) {
    const auto& [r, g, b] = colours[i];
    AppendSvg(svg, R"svg(<stop offset="{:.4g}" stop-color="#{:02x}{:02x}{:02x}"/>)svg",
              static_cast<double>(i) / static_cast<double>(colours.size() - 1), r, g, b);
  }
  return svg + "</linearGradient>";
}

// Filter whose three channels look up a table.
std::string TableFilter(std::string_view name, std::string_view before, std::string_view type,
                        std::span<const data_io::Rgb> colours) {
  std::string svg = fmt::format(
      R"svg(<filter id="{}" color-interpolation-filters="sRGB" x="0" y="0" width="1" height="1">{})svg"
      "<feComponentTransfer>",
      name, before);
  constexpr std::string_view kChannels = "RGB";
  for (std::size_t channel = 0; channel < 3; ++channel) {
    AppendSvg(svg, R"svg(<feFunc{} type="{}" tableValues=")svg", kChannels[channel], type);
    for (std::size_t i = 0; i < colours.size(); ++i)
      AppendSvg(svg, "{}{:.5g}", i > 0 ? " " : "", colours[i][channel] / 255.0);
    svg += "\"/>";
  }
  return svg + "</feComponentTransfer></filter>";
}

// Filter that multiplies a grey level by a factor for each channel.
std::string TintFilter(std::string_view name, double r, double g, double b) {
  return fmt::format(
      R"svg(<filter id="{}" color-interpolation-filters="sRGB" x="0" y="0" width="1" height="1">)svg"
      R"svg(<feColorMatrix values="{} 0 0 0 0 0 {} 0 0 0 0 0 {} 0 0 0 0 0 1 0"/></filter>)svg",
      name, r, g, b);
}

}  // namespace

std::string SonarPlotSvg(const SonarPlot& plot, const std::vector<StoredPicture>& pictures, int number,
                         std::string_view alt) {
  const Size size = SizeWithin(plot.axes, plot.view, kSonarPlotWidth, kMaxPlotHeight);
  const double left = LeftOf(plot.axes);
  std::string svg = fmt::format(
      R"svg(<svg class="sonar" viewBox="0 0 {:.1f} {:.1f}" role="img" aria-label="{}">)svg"
      R"svg(<clipPath id="clip-{}"><path d="{}"/></clipPath><g transform="translate({:.1f} {})">)svg"
      R"svg(<g clip-path="url(#clip-{})"><g{}>{}</g></g>{}</g>)svg",
      left + kSonarPlotWidth + kSonarRight, kSonarTop + size.height + kSonarBottom, EscapeHtml(alt), number,
      Layout(plot.axes, plot.view, size).Outline(), left + 0.5 * (kSonarPlotWidth - size.width), kSonarTop,
      number,
      plot.view == SonarView::kPolar || plot.colours == SonarColours::kRegions ? R"svg( class="crisp")svg"
                                                                               : "",
      Images(plot.colours, pictures, size), Axes(plot.axes, plot.view, size));
  if (std::ranges::any_of(plot.bar, [](const std::string& text) { return !text.empty(); })) {
    AppendSvg(svg, R"svg(<g transform="translate({} {:.1f})">{}</g>)svg", left,
              kSonarTop + size.height + 13.0, Bar(GradientOf(plot.colours), plot.bar, kSonarPlotWidth));
  }
  return svg + "</svg>";
}

std::string SonarAxesSvg(const PolarAxes& axes, SonarView view, double max_width, double max_height,
                         std::string_view attributes) {
  const Size size = SizeWithin(axes, view, max_width, max_height);
  return fmt::format(R"svg(<svg class="sonar" viewBox="0 0 {:.1f} {:.1f}" aria-hidden="true"{}>{}</svg>)svg",
                     size.width, size.height, attributes, Axes(axes, view, size));
}

std::string ColourBarSvg(std::string_view gradient, const std::array<std::string, 3>& texts,
                         std::string_view attributes) {
  constexpr double kWidth = 320.0;
  return fmt::format(R"svg(<svg class="sonar" viewBox="0 0 {} {}" role="img" )svg"
                     R"svg(aria-label="{}, {}, {}"{}>{}</svg>)svg",
                     kWidth, kBarHeight + 16.0, EscapeHtml(texts[0]), EscapeHtml(texts[1]),
                     EscapeHtml(texts[2]), attributes, Bar(gradient, texts, kWidth));
}

std::string SonarDefinitionsSvg() {
  Grid<float> ramp(1, 256);
  for (int i = 0; i < 256; ++i) ramp(0, i) = static_cast<float>(i);
  const RgbImage inferno = data_io::Colorize(ramp, {0.0, 255.0});
  std::vector<data_io::Rgb> stops;
  for (int i = 0; i < 256; i += 15) stops.push_back(inferno(0, i));
  constexpr auto kAlike = static_cast<std::uint8_t>(data_io::kAlikeGrey);
  const std::array<data_io::Rgb, 2> grey = {{{0, 0, 0}, {255, 255, 255}}};
  const std::array<data_io::Rgb, 3> overlay = {{{0, 128, 255}, {128, 128, 128}, {255, 128, 0}}};
  const std::array<data_io::Rgb, 3> difference = {
      {data_io::kRealOnlyColor, {kAlike, kAlike, kAlike}, data_io::kSimulatedOnlyColor}};
  const std::array<data_io::Rgb, 4> regions = {
      {data_io::kNeitherColor, data_io::kRealOnlyColor, data_io::kSimulatedOnlyColor, data_io::kBothColor}};
  // Spreads the values 0 .. 3 of a picture of regions over the full scale.
  constexpr std::string_view kSpread =
      R"svg(<feColorMatrix values="85 0 0 0 0 0 85 0 0 0 0 0 85 0 0 0 0 0 1 0"/>)svg";
  return R"svg(<svg class="data" width="0" height="0" aria-hidden="true"><defs>)svg" +
         TableFilter("inferno", "", "table", inferno.values()) +
         TableFilter("regions", kSpread, "discrete", regions) + TintFilter("in-blue", 0.0, 0.5, 1.0) +
         TintFilter("in-orange", 1.0, 0.5, 0.0) + Gradient("inferno", stops) + Gradient("grey", grey) +
         Gradient("overlay", overlay) + Gradient("difference", difference) + "</defs></svg>\n";
}

}  // namespace sonarcal::report
