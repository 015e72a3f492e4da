#include "apps/report/sections/noise_section.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "apps/report/html/html_text.h"
#include "data_io/images/image_io.h"
#include "data_io/parameters/parameters_io.h"
#include "data_io/pictures/picture.h"

namespace sonarcal::report {
namespace {

Table ChoiceTable(const calib::NoiseFit& fit) {
  Table table{.caption = fmt::format(
                  "Candidates, by -log likelihood of the pings that select; the smallest is best, but each "
                  "step to a richer law must gain {:.5f}, and one that has not converged is never selected",
                  calib::kRelevantNats),
              .columns = {{"Display law"},
                          {"Speckle", {}, false},
                          {"Time-varied gain", {}, false},
                          {"Floor behind the gain", {}, false},
                          {"-log likelihood", "nats a pixel"}},
              .rows = {}};
  for (const calib::NoiseModelChoice& choice : fit.choices) {
    table.rows.push_back(
        {{std::string(ToString(choice.display)), std::string(ToString(choice.speckle)),
          std::string(ToString(choice.time_varied_gain)), choice.floor_after_gain ? "yes" : "no",
          FormatNumber(choice.nats_per_pixel, 5) + (choice.converged ? "" : ", not converged")},
         choice.chosen ? RowStyle::kStrong : RowStyle::kPlain});
  }
  return table;
}

Table ValueTable(const calib::NoiseFit& fit) {
  Table table{.caption = "Values; the tapers are drawn below and listed in fit.json",
              .columns = {{"Parameter"}, {"Value"}, {"Sigma"}, {"Unit", {}, false}, {"Status", {}, false}},
              .rows = {},
              .notes = fit.report.gauge};
  for (const calib::FittedParameter& p : fit.report.parameters) {
    if (p.name.find("_taper_db.") != std::string::npos) continue;
    table.rows.push_back(
        {{p.name, fmt::format("{:.4g}", p.value), p.sigma ? fmt::format("{:.2g}", *p.sigma) : "–", p.unit,
          std::string(ToString(p.status))}});
  }
  return table;
}

LineChart HistogramChart(const calib::NoiseAgreement& agreement, const std::string& real) {
  ChartSeries recorded{.name = real, .x = {}, .y = {}, .style = SeriesStyle::kPoints};
  ChartSeries predicted{.name = "predicted", .x = {}, .y = {}};
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  constexpr double kLeastShown = 1e-7;
  const auto shown = [](double share) { return share < kLeastShown ? kNone : std::log10(share); };
  for (std::size_t level = 0; level < agreement.recorded.size(); ++level) {
    if (agreement.recorded[level] < kLeastShown && agreement.predicted[level] < kLeastShown) continue;
    recorded.x.push_back(static_cast<double>(level));
    recorded.y.push_back(shown(agreement.recorded[level]));
    predicted.x.push_back(static_cast<double>(level));
    predicted.y.push_back(shown(agreement.predicted[level]));
  }
  return {.title = "Grey values",
          .x = {.label = "grey level"},
          .y = {.label = "log10 of the share of pixels"},
          .series = {recorded, predicted}};
}

// Mean grey along one axis, with cells that were left out as a separate series.
LineChart MeanChart(const calib::NoiseFit& fit, bool by_range, const std::string& real) {
  const calib::NoiseAgreement& agreement = fit.judged;
  ChartSeries recorded{.name = real, .x = {}, .y = {}, .style = SeriesStyle::kPoints};
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
          .x = {.label = by_range ? "range" : "beam, counted from 0", .unit = by_range ? "m" : ""},
          .y = {.label = "mean grey level"},
          .series = {recorded, predicted}};
}

LineChart TaperChart(const calib::NoiseFit& fit) {
  LineChart chart{
      .title = "Tapers", .x = {.label = "beam, counted from 0"}, .y = {.label = "taper", .unit = "dB"}};
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

Picture ResidualMap(const calib::NoiseFit& fit, bool is_synthetic) {
  const calib::NoiseAgreement& agreement = fit.judged;
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
  return {.png = data_io::EncodePng(data_io::StretchPolar(
              data_io::Colorize(residual, {-limit, limit}, data_io::ColorMap::kViridis))),
          .caption = fmt::format(
              "{} minus predicted mean grey level of each cell, from {:.2f} (dark) to {:.2f} (bright); beams "
              "from left to right, range from {:.2f} m at the top to {:.2f} m at the bottom{}",
              RealCaption(is_synthetic), -limit, limit, fit.cells.RangeM(0),
              fit.cells.RangeM(fit.cells.bands() - 1),
              cells < static_cast<int>(residual.size()) ? "; cells left out are darkest" : ""),
          .alt = "map of residuals by range band and beam",
          .crisp = true};
}

std::string Pings(std::size_t count) {
  return fmt::format("{} ping{}", count, count == 1 ? "" : "s");
}

std::string Others(std::size_t count) {
  return fmt::format("{} other{}", count, count == 1 ? "" : "s");
}

}  // namespace

std::string NoiseWindowText(const calib::NoiseFit& fit) {
  const PolarAxes& axes = fit.cells.axes;
  return fmt::format(
      "window {:.2f} to {:.2f} m, found by rule: the longest of those that one floor with a trend describes "
      "about as well as any",
      axes.range_edge_m(fit.cells.first_bin), axes.range_edge_m(fit.cells.last_bin));
}

std::string NoiseJudgedText(const calib::NoiseFit& fit) {
  if (!fit.judged_on_held_out) return "evaluated on the fitted frames, because none is held out";
  if (fit.bands_held_out) {
    std::string text =
        fmt::format("evaluated on every second band of {} range bins, not fitted, of ", fit.cells.band_bins);
    const bool same_pings = fit.frames_judged_on == fit.report.frames_used;
    text += same_pings ? "the " + std::string(fit.frames_judged_on.size() == 1 ? "ping" : "pings") + " fitted"
                       : Pings(fit.frames_judged_on.size()) + " not fitted";
    if (fit.judged_apart_from_choice)
      return text + fmt::format("; {} chose", Others(fit.frames_chosen_on.size()));
    return text + "; it also selected the candidate";
  }
  if (fit.judged_apart_from_choice) {
    return fmt::format("evaluated on {} that neither the fit nor the selection used; {} selected",
                       Pings(fit.frames_judged_on.size()), Others(fit.frames_chosen_on.size()));
  }
  return fmt::format("evaluated on {} that were not fitted, but that selected the candidate",
                     Pings(fit.frames_judged_on.size()));
}

void AddNoiseSections(HtmlReport& report, const calib::NoiseFit& fit, bool is_synthetic) {
  const std::string on = fit.bands_held_out       ? "on bands that were not fitted"
                         : fit.judged_on_held_out ? "on pings that were not fitted"
                                                  : "on the pings fitted";
  report.KeyFigures(
      {{.label = "KS, all pixels", .value = FormatNumber(fit.judged.ks, 4), .note = on},
       {.label = "Wasserstein-1",
        .value = FormatNumber(fit.judged.wasserstein_grey, 3),
        .unit = "grey",
        .note = on},
       {.label = "KS by cell, median",
        .value = FormatNumber(fit.judged.cell_ks_median, 3),
        .note = fmt::format("cells of {} bins x {} beams", calib::kJudgeBins, calib::kJudgeBeams)},
       {.label = "Whitened residual",
        .value = FormatNumber(fit.judged.whitened.spread, 3),
        .note = fmt::format("spread over pixels, mean {}; 1 and 0 for a true law",
                            FormatNumber(fit.judged.whitened.mean, 3))}});
  const std::string judged =
      fmt::format("Noise law of {}, {}.", Pings(fit.report.frames_used.size()), NoiseJudgedText(fit));
  if (!fit.judged_on_held_out) {
    report.Callout(
        CalloutKind::kLimit, "Evaluated on fitted data",
        judged + " Agreement is better than on other data, and richer candidates have an advantage.");
  } else if (!fit.judged_apart_from_choice) {
    report.Callout(
        CalloutKind::kLimit, "Selected and evaluated on the same data",
        judged + " With four or more held-out pings, half of them only select and half only evaluate.");
  } else {
    report.Paragraph(judged);
  }
  if (fit.window_found) report.Paragraph("Background: " + NoiseWindowText(fit) + ".");
  const std::string real = RealWord(is_synthetic);
  report.Section(fmt::format("Grey values {} and predicted", real));
  report.Add({HistogramChart(fit.judged, real), MeanChart(fit, true, real), MeanChart(fit, false, real)},
             RealCaption(is_synthetic) + " " + on + ", and predicted by the law");
  report.Add(PictureRow{
      .caption = "Residuals of the law", .pictures = {ResidualMap(fit, is_synthetic)}, .columns = 1});
  report.Section("The law");
  report.Add(ChoiceTable(fit));
  report.Add(ValueTable(fit));
  report.Add({TaperChart(fit)}, "Level of each beam's noise, relative to the mean over beams");
  if (!fit.report.unidentifiable_directions.empty()) {
    report.Callout(CalloutKind::kLimit, "Not determined by the pings",
                   "Unidentifiable values have no sigma: together with the others they describe these pings, "
                   "alone they have no meaning.");
    report.List(fit.report.unidentifiable_directions);
  }
}

}  // namespace sonarcal::report
