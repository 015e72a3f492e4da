#include "apps/report/sections/residual_section.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "apps/report/html/html_text.h"
#include "apps/report/sections/figure_words.h"
#include "core/math/statistics.h"
#include "data_io/images/image_io.h"
#include "data_io/pictures/picture.h"

namespace sonarcal::report {
namespace {

constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

double Middle(const metrics::ResidualClass& of) {
  return of.to ? 0.5 * (*of.from + *of.to) : *of.from;
}

// Mean difference and mean |difference| over the classes of a table.
LineChart ResidualChart(const metrics::ResidualTable& table, const char* title, const char* axis,
                        const std::string& real) {
  ChartSeries bias{.name = "mean difference, object regions", .x = {}, .y = {}, .colour = 1};
  ChartSeries absolute{.name = "mean |difference|, object regions", .x = {}, .y = {}, .colour = 0};
  ChartSeries whole{
      .name = "mean difference, whole image", .x = {}, .y = {}, .style = SeriesStyle::kDashed, .colour = 5};
  for (const metrics::ResidualClass& of : table.classes) {
    if (!of.from) continue;
    const double x = Middle(of);
    for (const auto& [series, value] : {std::pair{&bias, of.sums.union_region.bias()},
                                        std::pair{&absolute, of.sums.union_region.mean_absolute()},
                                        std::pair{&whole, of.sums.whole.bias()}}) {
      series->x.push_back(x);
      series->y.push_back(value.value_or(kNoNumber));
    }
  }
  return {.title = title,
          .x = {.label = axis, .unit = table.unit},
          .y = {.label = "simulated \u2212 " + real, .unit = "part of full scale"},
          .series = {std::move(bias), std::move(absolute), std::move(whole)},
          .alt = fmt::format("{}: lines of mean difference and mean absolute difference", title)};
}

Table ResidualTableOf(const metrics::ResidualTable& table) {
  Table shown{.caption = fmt::format("Difference by {}", table.by),
              .columns = {{table.by},
                          {"Pixels, object regions"},
                          {"Mean difference", "part of full scale"},
                          {"Mean |difference|", "part of full scale"},
                          {"Mean difference, whole image", "part of full scale"}},
              .rows = {}};
  for (const metrics::ResidualClass& of : table.classes) {
    if (of.sums.whole.pixels == 0) continue;
    shown.rows.push_back(
        {{of.name, fmt::format("{}", of.sums.union_region.pixels), FigureText(of.sums.union_region.bias()),
          FigureText(of.sums.union_region.mean_absolute()), FigureText(of.sums.whole.bias())}});
  }
  return shown;
}

void AddMap(HtmlReport& report, const metrics::ResidualCollector& residuals, const std::string& real) {
  const metrics::ResidualMap& map = residuals.map();
  const PolarAxes& axes = residuals.axes();
  Grid<float> bias(map.cells.rows(), map.cells.cols());
  std::vector<double> sizes;
  for (std::size_t i = 0; i < bias.size(); ++i) {
    const std::optional<double> of = map.cells.values()[i].whole.bias();
    bias.values()[i] = static_cast<float>(of.value_or(kNoNumber));
    if (of) sizes.push_back(std::abs(*of));
  }
  if (sizes.empty()) return;
  // Full colour at the 98th percentile, so that one extreme cell does not pale all others.
  const double limit = std::max(LowerQuantile(std::move(sizes), 0.98), 1e-3);
  Grid<float> pixels(axes.range_bins, axes.beam_count());  // the cells at the far edges are smaller
  for (int bin = 0; bin < pixels.rows(); ++bin) {
    for (int beam = 0; beam < pixels.cols(); ++beam)
      pixels(bin, beam) = bias(bin / map.bins, beam / map.beams);
  }
  report.Add(PictureRow{
      .caption = fmt::format(
          "Mean difference over all frames, in cells of {} bins x {} beams: near range at the top. Blue is "
          "brighter in the {} image, orange in the simulated one.",
          map.bins, map.beams, real),
      .pictures = {{.png = data_io::EncodePng(data_io::Diverging(pixels, limit)),
                    .caption = "Simulated \u2212 " + real,
                    .alt = "Map of the mean difference over range and beam",
                    .plot = SonarPlot{.axes = axes,
                                      .view = SonarView::kPolar,
                                      .colours = SonarColours::kDifference,
                                      .bar = {FormatNumber(-limit, 3), "of full scale",
                                              FormatNumber(limit, 3)}}}},
      .columns = 1});
}

}  // namespace

std::optional<WorstBand> FindWorstBand(const metrics::ResidualTable& table, int bands) {
  if (table.classes.empty() || !table.classes.front().from || !table.classes.back().to) return std::nullopt;
  const double low = *table.classes.front().from;
  const double width = (*table.classes.back().to - low) / bands;
  std::vector<metrics::DifferenceSums> sums(bands);
  std::int64_t most = 0;
  for (const metrics::ResidualClass& of : table.classes) {
    const int band = std::clamp(static_cast<int>((Middle(of) - low) / width), 0, bands - 1);
    sums[band] += of.sums.union_region;
    most = std::max(most, sums[band].pixels);
  }
  std::optional<WorstBand> worst;
  for (int band = 0; band < bands; ++band) {
    // Skips bands with few pixels, such as those at an edge.
    if (sums[band].pixels == 0 || 20 * sums[band].pixels < most) continue;
    const double error = *sums[band].mean_absolute();
    if (!worst || error > worst->mean_absolute)
      worst = WorstBand{low + band * width, low + (band + 1) * width, error, *sums[band].bias()};
  }
  return worst;
}

void AddResiduals(HtmlReport& report, const metrics::MetricsReport& metrics) {
  if (metrics.residuals.frames() == 0) return;
  const std::string real = RealWord(metrics.real_is_synthetic);
  report.Add({ResidualChart(metrics.residuals.ByRange(), "Over range", "range", real),
              ResidualChart(metrics.residuals.ByBeam(), "Over azimuth", "azimuth", real)},
             "Difference between the simulated and the " + real +
                 " image, above 0 where the simulated one is brighter; all frames.");
  AddMap(report, metrics.residuals, real);
  for (const metrics::ResidualTable& table : metrics.residuals_by_scene) {
    const bool numeric =
        std::ranges::any_of(table.classes, [](const auto& of) { return of.from.has_value(); });
    if (numeric) {
      report.Add({ResidualChart(table, "Over incidence", "incidence", real)},
                 "Differences by the mean angle between the rays and the surface normal.");
    } else {
      report.Add(ResidualTableOf(table));
    }
  }
  if (metrics.residuals.frames_left_out() > 0) {
    report.Paragraph(fmt::format("{} frames of other axes than the first are not in these figures.",
                                 metrics.residuals.frames_left_out()));
  }
}

}  // namespace sonarcal::report
