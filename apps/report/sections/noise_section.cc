#include "apps/report/sections/noise_section.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include <nlohmann/json.hpp>

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

// Mean grey along one axis, without the cells that were left out.
LineChart MeanChart(const calib::NoiseAgreement& agreement, const calib::NoiseCells& cells_of, bool by_range,
                    const std::string& real) {
  ChartSeries recorded{.name = real, .x = {}, .y = {}, .style = SeriesStyle::kPoints};
  ChartSeries predicted{.name = "predicted", .x = {}, .y = {}};
  const int count = by_range ? cells_of.bands() : cells_of.beams();
  const int across = by_range ? cells_of.beams() : cells_of.bands();
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
    const double at = by_range ? cells_of.RangeM(i) : i;
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

Picture ResidualMap(const calib::NoiseAgreement& agreement, const calib::NoiseCells& cells_of,
                    bool is_synthetic) {
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
  PolarAxes axes = cells_of.axes;
  axes.range_min_m = cells_of.axes.range_edge_m(cells_of.first_bin);
  axes.range_max_m = cells_of.axes.range_edge_m(cells_of.last_bin);
  axes.range_bins = cells_of.last_bin - cells_of.first_bin;
  Grid<float> pixels(axes.range_bins, axes.beam_count());  // the last band can be narrower
  for (int bin = 0; bin < pixels.rows(); ++bin) {
    for (int beam = 0; beam < pixels.cols(); ++beam)
      pixels(bin, beam) = residual(bin / cells_of.band_bins, beam);
  }
  return {
      .png = data_io::EncodePng(data_io::Diverging(pixels, limit)),
      .caption = fmt::format("{} minus predicted mean grey level of each cell{}", RealCaption(is_synthetic),
                             cells < static_cast<int>(residual.size()) ? "; cells left out are white" : ""),
      .alt = "map of residuals by range band and beam",
      .plot = SonarPlot{.axes = axes,
                        .view = SonarView::kPolar,
                        .colours = SonarColours::kDifference,
                        .bar = {FormatNumber(-limit, 2), "grey levels", FormatNumber(limit, 2)}}};
}

std::string Pings(std::size_t count) {
  return fmt::format("{} ping{}", count, count == 1 ? "" : "s");
}

std::string Others(std::size_t count) {
  return fmt::format("{} other{}", count, count == 1 ? "" : "s");
}

void AddGreyCharts(HtmlReport& report, const calib::NoiseAgreement& agreement, const calib::NoiseCells& cells,
                   const std::string& on, bool is_synthetic) {
  const std::string real = RealWord(is_synthetic);
  report.Section(fmt::format("Grey values {} and predicted", real));
  report.Add({HistogramChart(agreement, real), MeanChart(agreement, cells, true, real),
              MeanChart(agreement, cells, false, real)},
             RealCaption(is_synthetic) + " " + on + ", and predicted by the law");
  report.Add(PictureRow{.caption = "Residuals of the law",
                        .pictures = {ResidualMap(agreement, cells, is_synthetic)},
                        .columns = 1});
}

void AddNoiseFigures(HtmlReport& report, const calib::NoiseAgreement& agreement, const std::string& on) {
  report.KeyFigures(
      {{.label = "KS, all pixels", .value = FormatNumber(agreement.ks, 4), .note = on},
       {.label = "Wasserstein-1",
        .value = FormatNumber(agreement.wasserstein_grey, 3),
        .unit = "grey",
        .note = on},
       {.label = "KS by cell, median",
        .value = FormatNumber(agreement.cell_ks_median, 3),
        .note = fmt::format("cells of {} bins x {} beams", calib::kJudgeBins, calib::kJudgeBeams)},
       {.label = "Whitened residual",
        .value = FormatNumber(agreement.whitened.spread, 3),
        .note = fmt::format("spread over pixels, mean {}; 1 and 0 for a true law",
                            FormatNumber(agreement.whitened.mean, 3))}});
}

void AddDrift(HtmlReport& report, const calib::NoiseJudgement& judgement) {
  report.Section("Level over time");
  report.Paragraph(NoiseDriftText(judgement));
  ChartSeries pings{.name = "pings", .x = {}, .y = {}, .style = SeriesStyle::kPoints};
  for (const calib::NoisePing& ping : judgement.pings) {
    pings.x.push_back(ping.frame);
    pings.y.push_back(ping.level_db);
  }
  if (pings.x.size() < 2) return;
  report.Add({LineChart{.title = "Level of each ping",
                        .x = {.label = "frame, counted from 0"},
                        .y = {.label = "level relative to the law", .unit = "dB"},
                        .series = {pings}}},
             "Level of the noise of each ping, relative to the law");
  if (!judgement.drift) return;
  Table table{.caption =
                  "Mean level of each part, relative to the law; the standard errors include the "
                  "correlation of neighbouring pings",
              .columns = {{"Frames"}, {"Level", "dB"}, {"Standard error", "dB"}},
              .rows = {}};
  for (const calib::NoiseDrift::Part& part : judgement.drift->parts) {
    table.rows.push_back({{fmt::format("{} to {}", part.first_frame, part.last_frame),
                           fmt::format("{:.3f}", part.level_db), fmt::format("{:.3f}", part.sigma_db)}});
  }
  report.Add(table);
}

using Json = nlohmann::ordered_json;

Json ResidualJson(const calib::ResidualSummary& residual) {
  return {{"mean", residual.mean}, {"spread", residual.spread}};
}

// The items with the largest KS, worst first.
template <typename T>
std::vector<T> Worst(std::vector<T> items) {
  constexpr std::size_t kShown = 5;
  std::ranges::stable_sort(items, std::ranges::greater{}, &T::ks);
  if (items.size() > kShown) items.resize(kShown);
  return items;
}

std::string BlockRange(const calib::NoiseBlock& block, const PolarAxes& axes) {
  return fmt::format("{:.2f} to {:.2f}", axes.range_edge_m(block.first_bin),
                     axes.range_edge_m(block.end_bin));
}

std::string BlockBeams(const calib::NoiseBlock& block) {
  return fmt::format("{} to {}", block.first_beam, block.end_beam - 1);
}

std::string PingsBeyondText(const calib::NoiseJudgement& judgement) {
  return fmt::format(
      "{} of {} pings have a KS beyond {:.4f}, which independent pixels of the law exceed in "
      "1 % of all pings",
      judgement.pings_beyond_chance(), judgement.pings.size(),
      calib::ChanceKs(judgement.pings.front().pixels));
}

std::string CellsBeyondText(const calib::NoiseJudgement& judgement) {
  const std::vector<calib::NoiseBlock>& blocks = judgement.agreement.blocks;
  return fmt::format(
      "{} of {} cells have a KS beyond chance ({:.3f} for the first), which independent pixels "
      "of the law exceed in 1 % of all cells",
      judgement.cells_beyond_chance(), blocks.size(), calib::ChanceKs(blocks.front().pixels));
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

std::string NoiseResultText(const calib::NoiseFit& fit) {
  if (!fit.refitted) {
    return fit.judged_on_held_out ? "the law of the evaluation, because the fit to all pings did not converge"
                                  : "the law of the evaluation, which was fitted to all pings";
  }
  return fmt::format(
      "params.json holds the law fitted again to all {}, with KS {:.4f} on these; the figures "
      "above are those of the law fitted to the others, params_evaluated.json",
      Pings(fit.all.frames.size()), fit.all.agreement.ks);
}

std::string NoiseDriftText(const calib::NoiseJudgement& judgement) {
  if (!judgement.drift) {
    return fmt::format("drift of the level not determined: {}, expected {} or more",
                       Pings(judgement.pings.size()), calib::kMinPingsForDrift);
  }
  const calib::NoiseDrift& drift = *judgement.drift;
  return fmt::format(
      "level over frames {} to {}: trend {:+.3f} +- {:.3f} dB in all, {}; pings scatter by {:.3f} "
      "dB about it, neighbours with correlation {:.2f} (speckle alone: {:.3f} dB)",
      drift.first_frame, drift.last_frame, drift.change_db(), drift.change_sigma_db(),
      drift.significant ? "significant at 5 %" : "not significant at 5 %", drift.spread_db, drift.lag_one,
      judgement.pings.front().level_sigma_db);
}

Json NoiseAgreementJson(const calib::NoiseAgreement& agreement) {
  return {{"ks", agreement.ks},
          {"wasserstein_1_grey", agreement.wasserstein_grey},
          {"cell_ks_median", agreement.cell_ks_median},
          {"cell_ks_p95", agreement.cell_ks_p95},
          {"cell", fmt::format("{} bins x {} beams", calib::kJudgeBins, calib::kJudgeBeams)},
          {"whitened_residual", ResidualJson(agreement.whitened)},
          {"nats_per_pixel", agreement.nats_per_pixel}};
}

Json NoiseDriftJson(const calib::NoiseJudgement& judgement) {
  Json levels = Json::array();
  for (const calib::NoisePing& ping : judgement.pings) levels.push_back(ping.level_db);
  Json json = {{"frames", judgement.frames}, {"level_db", levels}};
  if (!judgement.drift) return json;
  const calib::NoiseDrift& drift = *judgement.drift;
  Json parts = Json::array();
  for (const calib::NoiseDrift::Part& part : drift.parts) {
    parts.push_back({{"first_frame", part.first_frame},
                     {"last_frame", part.last_frame},
                     {"level_db", part.level_db},
                     {"sigma_db", part.sigma_db}});
  }
  json.update({{"trend_db_per_ping", drift.trend_db_per_ping},
               {"trend_sigma_db_per_ping", drift.trend_sigma},
               {"significant", drift.significant},
               {"spread_db", drift.spread_db},
               {"correlation_of_neighbours", drift.lag_one},
               {"speckle_db", judgement.pings.front().level_sigma_db},
               {"parts", parts}});
  return json;
}

Json NoiseJudgementJson(const calib::NoiseJudgement& judgement) {
  Json pings = Json::array();
  for (const calib::NoisePing& ping : judgement.pings) {
    pings.push_back({{"frame", ping.frame},
                     {"ks", ping.ks},
                     {"chance_ks", calib::ChanceKs(ping.pixels)},
                     {"wasserstein_1_grey", ping.wasserstein_grey},
                     {"whitened_residual", ResidualJson(ping.whitened)},
                     {"level_db", ping.level_db}});
  }
  const PolarAxes& axes = judgement.cells.axes;
  Json cells = Json::array();
  for (const calib::NoiseBlock& block : judgement.agreement.blocks) {
    cells.push_back({{"range_m", {axes.range_edge_m(block.first_bin), axes.range_edge_m(block.end_bin)}},
                     {"beams", {block.first_beam, block.end_beam - 1}},
                     {"ks", block.ks},
                     {"chance_ks", calib::ChanceKs(block.pixels)},
                     {"recorded_mean_grey", block.recorded_mean},
                     {"predicted_mean_grey", block.predicted_mean}});
  }
  return {{"frames", judgement.frames},
          {"agreement", NoiseAgreementJson(judgement.agreement)},
          {"pings_beyond_chance", judgement.pings_beyond_chance()},
          {"cells_beyond_chance", judgement.cells_beyond_chance()},
          {"drift", NoiseDriftJson(judgement)},
          {"pings", pings},
          {"cells", cells}};
}

Json NoiseJudgementFileJson(const calib::NoiseJudgement& judgement) {
  Json json = {{"format", "sonar-noise-judgement/1"}};
  json.update(NoiseJudgementJson(judgement));
  return json;
}

std::string NoiseAgreementText(const calib::NoiseAgreement& agreement) {
  return fmt::format(
      "  KS {:.4f}, Wasserstein-1 {:.3f} grey, KS by cell {:.3f} median, {:.3f} at 95 %\n"
      "  whitened residual {:.3f} +- {:.3f}, 0 +- 1 for a true law\n",
      agreement.ks, agreement.wasserstein_grey, agreement.cell_ks_median, agreement.cell_ks_p95,
      agreement.whitened.mean, agreement.whitened.spread);
}

std::string NoiseJudgementText(const calib::NoiseJudgement& judgement, bool is_synthetic) {
  std::string text = NoiseAgreementText(judgement.agreement);
  text += "  " + PingsBeyondText(judgement) + "; worst:\n";
  for (const calib::NoisePing& ping : Worst(judgement.pings)) {
    text += fmt::format("    frame {:<5} KS {:.4f}  Wasserstein-1 {:.3f} grey  level {:+.3f} dB\n",
                        ping.frame, ping.ks, ping.wasserstein_grey, ping.level_db);
  }
  text += "  " + CellsBeyondText(judgement) + "; worst:\n";
  for (const calib::NoiseBlock& block : Worst(judgement.agreement.blocks)) {
    text += fmt::format("    range {} m, beams {:<9} KS {:.4f}  mean grey {:.2f} {}, {:.2f} predicted\n",
                        BlockRange(block, judgement.cells.axes), BlockBeams(block), block.ks,
                        block.recorded_mean, RealWord(is_synthetic), block.predicted_mean);
  }
  return text + "  " + NoiseDriftText(judgement) + "\n";
}

void AddNoiseJudgement(HtmlReport& report, const calib::NoiseJudgement& judgement, bool is_synthetic) {
  AddNoiseFigures(report, judgement.agreement, "on " + Pings(judgement.pings.size()));
  report.Section("Where the law fails");
  Table pings{.caption = "Pings with the largest KS. " + PingsBeyondText(judgement),
              .columns = {{"Frame"}, {"KS"}, {"Wasserstein-1", "grey"}, {"Level relative to the law", "dB"}},
              .rows = {}};
  for (const calib::NoisePing& ping : Worst(judgement.pings)) {
    pings.rows.push_back({{fmt::format("{}", ping.frame), FormatNumber(ping.ks, 4),
                           FormatNumber(ping.wasserstein_grey, 3), fmt::format("{:+.3f}", ping.level_db)}});
  }
  report.Add(pings);
  Table cells{.caption = "Cells with the largest KS, all pings together. " + CellsBeyondText(judgement),
              .columns = {{"Range", "m"},
                          {"Beams"},
                          {"KS"},
                          {RealCaption(is_synthetic), "mean grey"},
                          {"Predicted", "mean grey"}},
              .rows = {}};
  for (const calib::NoiseBlock& block : Worst(judgement.agreement.blocks)) {
    cells.rows.push_back(
        {{BlockRange(block, judgement.cells.axes), BlockBeams(block), FormatNumber(block.ks, 4),
          FormatNumber(block.recorded_mean, 2), FormatNumber(block.predicted_mean, 2)}});
  }
  report.Add(cells);
  AddGreyCharts(report, judgement.agreement, judgement.cells, "in these pings", is_synthetic);
  AddDrift(report, judgement);
}

void AddNoiseSections(HtmlReport& report, const calib::NoiseFit& fit, bool is_synthetic) {
  const std::string on = fit.bands_held_out       ? "on bands that were not fitted"
                         : fit.judged_on_held_out ? "on pings that were not fitted"
                                                  : "on the pings fitted";
  AddNoiseFigures(report, fit.judged, on);
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
  report.Paragraph("Result: " + NoiseResultText(fit) + ".");
  AddGreyCharts(report, fit.judged, fit.cells, on, is_synthetic);
  AddDrift(report, fit.all);
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
