#include "apps/report/noise_section.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "apps/report/html_text.h"
#include "data_io/image_io.h"
#include "data_io/parameters_io.h"
#include "data_io/picture.h"

namespace sonarcal {
namespace {

Table ChoiceTable(const NoiseFit& fit) {
  Table table{.caption = "Candidates, by -log likelihood of the pings they are judged on; the least is best",
              .columns = {{"Display law"},
                          {"Speckle", {}, false},
                          {"Time-varied gain", {}, false},
                          {"Floor behind the gain", {}, false},
                          {"-log likelihood", "nats a pixel"}},
              .rows = {}};
  for (const NoiseModelChoice& choice : fit.choices) {
    table.rows.push_back({{std::string(ToString(choice.display)), std::string(ToString(choice.speckle)),
                           std::string(ToString(choice.time_varied_gain)),
                           choice.floor_after_gain ? "yes" : "no", FormatNumber(choice.nats_per_pixel, 5)},
                          choice.chosen ? RowStyle::kStrong : RowStyle::kPlain});
  }
  return table;
}

Table ValueTable(const NoiseFit& fit) {
  Table table{.caption = "Values; the tapers are drawn below and listed in fit.json",
              .columns = {{"Parameter"}, {"Value"}, {"Sigma"}, {"Unit", {}, false}, {"Status", {}, false}},
              .rows = {},
              .notes = fit.report.gauge};
  for (const FittedParameter& p : fit.report.parameters) {
    if (p.name.find("_taper_db.") != std::string::npos) continue;
    table.rows.push_back(
        {{p.name, fmt::format("{:.4g}", p.value), p.sigma ? fmt::format("{:.2g}", *p.sigma) : "–", p.unit,
          std::string(ToString(p.status))}});
  }
  return table;
}

LineChart HistogramChart(const NoiseAgreement& agreement) {
  ChartSeries recorded{.name = "recorded", .x = {}, .y = {}, .style = SeriesStyle::kPoints};
  ChartSeries predicted{.name = "predicted", .x = {}, .y = {}};
  for (std::size_t level = 0; level < agreement.recorded.size(); ++level) {
    if (agreement.recorded[level] < 1e-7 && agreement.predicted[level] < 1e-7) continue;
    recorded.x.push_back(static_cast<double>(level));
    recorded.y.push_back(std::log10(std::max(agreement.recorded[level], 1e-7)));
    predicted.x.push_back(static_cast<double>(level));
    predicted.y.push_back(std::log10(std::max(agreement.predicted[level], 1e-7)));
  }
  return {.title = "Grey values",
          .x = {.label = "grey"},
          .y = {.label = "log10 of the share"},
          .series = {recorded, predicted}};
}

// Mean grey along one axis, cells that were left out apart.
LineChart MeanChart(const NoiseFit& fit, bool by_range) {
  const NoiseAgreement& agreement = fit.judged;
  ChartSeries recorded{.name = "recorded", .x = {}, .y = {}, .style = SeriesStyle::kPoints};
  ChartSeries predicted{.name = "predicted", .x = {}, .y = {}};
  const int count = by_range ? fit.cells.bands() : fit.cells.beams();
  const int across = by_range ? fit.cells.beams() : fit.cells.bands();
  for (int i = 0; i < count; ++i) {
    double sum_recorded = 0.0;
    double sum_predicted = 0.0;
    int cells = 0;
    for (int j = 0; j < across; ++j) {
      const int band = by_range ? i : j;
      const int beam = by_range ? j : i;
      if (std::isnan(agreement.recorded_mean(band, beam))) continue;
      sum_recorded += agreement.recorded_mean(band, beam);
      sum_predicted += agreement.predicted_mean(band, beam);
      ++cells;
    }
    if (cells == 0) continue;
    const double at = by_range ? fit.cells.RangeM(i) : i;
    recorded.x.push_back(at);
    recorded.y.push_back(sum_recorded / cells);
    predicted.x.push_back(at);
    predicted.y.push_back(sum_predicted / cells);
  }
  return {.title = by_range ? "By range" : "By beam",
          .x = {.label = by_range ? "range" : "beam", .unit = by_range ? "m" : ""},
          .y = {.label = "mean grey"},
          .series = {recorded, predicted}};
}

LineChart TaperChart(const NoiseFit& fit) {
  LineChart chart{.title = "Noise by beam", .x = {.label = "beam"}, .y = {.label = "taper", .unit = "dB"}};
  const auto add = [&chart](const char* name, const std::vector<double>& taper) {
    if (taper.empty()) return;
    ChartSeries series{.name = name, .x = {}, .y = taper};
    for (std::size_t beam = 0; beam < taper.size(); ++beam) series.x.push_back(static_cast<double>(beam));
    chart.series.push_back(series);
  };
  add("before the gain", fit.law.receiver.noise_taper_db);
  add("behind the gain", fit.law.receiver.noise_after_gain_taper_db);
  return chart;
}

Picture ResidualMap(const NoiseAgreement& agreement) {
  Grid<float> residual(agreement.recorded_mean.rows(), agreement.recorded_mean.cols());
  double square = 0.0;
  int cells = 0;
  for (std::size_t i = 0; i < residual.size(); ++i) {
    residual.values()[i] = agreement.recorded_mean.values()[i] - agreement.predicted_mean.values()[i];
    if (std::isnan(residual.values()[i])) continue;
    square += static_cast<double>(residual.values()[i]) * residual.values()[i];
    ++cells;
  }
  const double limit = std::max(1e-3, 3.0 * std::sqrt(square / std::max(1, cells)));
  return {.png = EncodePng(StretchPolar(Colorize(residual, {-limit, limit}, ColorMap::kViridis))),
          .caption =
              fmt::format("Recorded less predicted mean grey, from {:.2f} (dark) to {:.2f} (bright); cells "
                          "left out are darkest",
                          -limit, limit),
          .alt = "map of residuals by range band and beam",
          .crisp = true};
}

}  // namespace

void AddNoiseSections(HtmlReport& report, const NoiseFit& fit) {
  const std::string on = fit.judged_on_held_out ? "on pings that were not fitted" : "on the pings fitted";
  report.KeyFigures({{.label = "KS, all pixels", .value = FormatNumber(fit.judged.ks, 4), .note = on},
                     {.label = "Wasserstein-1",
                      .value = FormatNumber(fit.judged.wasserstein_grey, 3),
                      .unit = "grey",
                      .note = on},
                     {.label = "KS by cell, median",
                      .value = FormatNumber(fit.judged.cell_ks_median, 3),
                      .note = fmt::format("cells of {} bins x {} beams", kJudgeBins, kJudgeBeams)}});
  if (!fit.judged_on_held_out) {
    report.Callout(CalloutKind::kLimit, "Judged on what was fitted",
                   "No ping was held out, so agreement is better here than it will be on others.");
  }
  report.Section("Grey values recorded and predicted");
  report.Add({HistogramChart(fit.judged), MeanChart(fit, true), MeanChart(fit, false)},
             "Recorded " + on + ", and predicted by the law");
  report.Add(
      PictureRow{.caption = "What the law leaves", .pictures = {ResidualMap(fit.judged)}, .columns = 1});
  report.Section("The law");
  report.Add(ChoiceTable(fit));
  report.Add(ValueTable(fit));
  report.Add({TaperChart(fit)}, "Level of each beam's noise, relative to the mean over beams");
  if (!fit.report.unidentifiable_directions.empty()) {
    report.Callout(CalloutKind::kLimit, "Not told by the data", fit.report.unidentifiable_directions.front());
  }
}

}  // namespace sonarcal
