#include "apps/report/sections/standard_target_section.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "apps/report/html/html_text.h"
#include "apps/report/pictures/sonar_picture.h"
#include "apps/report/sections/fit_section.h"
#include "core/types/units.h"
#include "data_io/json/json_writer.h"

namespace sonarcal::report {
namespace {

using Json = nlohmann::ordered_json;

std::string StrengthText(const calib::SphereStrength& strength) {
  return fmt::format("{:.2f} +- {:.2f} dB re 1 m^2, {}", strength.db, strength.sigma_db,
                     strength.front_face
                         ? "front face alone"
                         : fmt::format("whole sphere over {:.0f} kHz", 1e-3 * strength.bandwidth_hz));
}

std::string ValueText(const calib::FittedParameter& parameter) {
  return parameter.sigma ? fmt::format("{:.4g} +- {:.2g}", parameter.value, *parameter.sigma)
                         : fmt::format("{:.4g}", parameter.value);
}

std::string GreyLevelsText(const calib::StandardTargetFit& fit) {
  if (!fit.display_slope)
    return fmt::format("grey levels per dB, of the display as given: {:.3f}", *fit.grey_levels_per_db);
  const auto& [slope, sigma] = *fit.display_slope;
  const std::string shown = fmt::format("the display as given shows {:.3f} +- {:.3f} dB per dB", 1.0 / slope,
                                        sigma / (slope * slope));
  if (fit.display_slope->AgreesWithDisplay())
    return fmt::format("grey levels per dB: {:.3f}; by both targets {}, so it is kept",
                       *fit.grey_levels_per_db, shown);
  return fmt::format("grey levels per dB, by both targets: {:.3f} +- {:.3f}; {}", *fit.grey_levels_per_db,
                     *fit.grey_levels_per_db * sigma / slope, shown);
}

bool IsSensitivity(const calib::FittedParameter& parameter) {
  return parameter.name.starts_with("beam.sensitivity_db.");
}

struct LeftOutReason {
  std::string why;
  std::vector<int> frames;
};

// Reasons for which frames were left out, in the order of their first frames.
std::vector<LeftOutReason> LeftOutByReason(const calib::StandardTargetFit& fit) {
  std::vector<LeftOutReason> reasons;
  for (const calib::FrameLeftOut& frame : fit.left_out) {
    auto of = std::find_if(reasons.begin(), reasons.end(),
                           [&](const LeftOutReason& reason) { return reason.why == frame.why; });
    if (of == reasons.end()) of = reasons.insert(of, {frame.why, {}});
    of->frames.push_back(frame.frame);
  }
  return reasons;
}

PolarAxes AxesOf(const calib::EchoWindow& window, const PolarAxes& axes) {
  const auto bins = static_cast<int>(window.bin_range_m.size());
  return {.range_min_m = axes.range_edge_m(window.first_bin),
          .range_max_m = axes.range_edge_m(window.first_bin + bins),
          .range_bins = bins,
          .beam_azimuth_rad = window.beam_azimuth_rad};
}

PolarImage LevelImage(const std::vector<double>& power, const PolarAxes& axes) {
  PolarImage image{axes, ImageScale(), Grid<float>(axes.range_bins, axes.beam_count())};
  image.scale.quantity = Quantity::kDecibel;
  for (std::size_t i = 0; i < power.size(); ++i)
    image.value.values()[i] = static_cast<float>(DbFromPower(std::max(power[i], 1e-300)));
  return image;
}

void AddPictures(HtmlReport& report, const calib::StandardTargetFit& fit, const PolarAxes& axes,
                 bool is_synthetic) {
  const PolarAxes window = AxesOf(fit.shown, axes);
  const auto [least, most] = std::minmax_element(fit.shown_model.begin(), fit.shown_model.end());
  const ColourLimits limits_db{.low = DbFromPower(*least) - 10.0, .high = DbFromPower(*most) + 1.0};
  report.Add(PictureRow{
      .caption =
          fmt::format("The sphere in frame {}, whose level is the median: received power about its peak.",
                      fit.shown.frame),
      .pictures = {SonarPicture(LevelImage(fit.shown.power, window), SonarView::kPolar,
                                RealCaption(is_synthetic),
                                RealCaption(is_synthetic) + " powers about the sphere", limits_db),
                   SonarPicture(LevelImage(fit.shown_model, window), SonarView::kPolar,
                                "Fitted, with the mean noise", "Expected powers about the sphere",
                                limits_db)},
      .columns = 2});
}

// Recorded (or synthetic) and fitted powers along a line of the shown window through its peak.
LineChart ProfileChart(const calib::StandardTargetFit& fit, bool along_beams, bool is_synthetic) {
  const calib::EchoWindow& window = fit.shown;
  const std::size_t beams = window.beam_azimuth_rad.size();
  const auto peak = static_cast<std::size_t>(
      std::max_element(fit.shown_model.begin(), fit.shown_model.end()) - fit.shown_model.begin());
  LineChart chart{
      .title = along_beams ? "Across the beams" : "Along the range",
      .x = along_beams ? ChartAxis{.label = "azimuth", .unit = "deg"}
                       : ChartAxis{.label = "range", .unit = "m"},
      .y = {.label = "received power", .unit = "dB"},
      .series = {{.name = "fitted, with the mean noise", .x = {}, .y = {}},
                 {.name = RealWord(is_synthetic), .x = {}, .y = {}, .style = SeriesStyle::kPoints}},
      .alt = RealCaption(is_synthetic) + " and fitted echo of the sphere"};
  const std::size_t count = along_beams ? beams : window.bin_range_m.size();
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t pixel = along_beams ? peak / beams * beams + i : i * beams + peak % beams;
    const double x = along_beams ? DegFromRad(window.beam_azimuth_rad[i]) : window.bin_range_m[i];
    for (ChartSeries& series : chart.series) series.x.push_back(x);
    chart.series[0].y.push_back(DbFromPower(fit.shown_model[pixel]));
    chart.series[1].y.push_back(DbFromPower(std::max(window.power[pixel], 1e-300)));
  }
  return chart;
}

// Levels that the frames show by themselves, over one of their coordinates.
template <typename Coordinate>
LineChart LevelChart(const calib::StandardTargetFit& fit, const std::string& label, const std::string& unit,
                     const Coordinate& coordinate) {
  ChartSeries points{.name = "frame", .x = {}, .y = {}, .style = SeriesStyle::kPoints};
  for (const calib::TargetFrame& frame : fit.frames) {
    points.x.push_back(coordinate(frame));
    points.y.push_back(frame.level_db);
  }
  const auto [low, high] = std::minmax_element(points.x.begin(), points.x.end());
  const std::vector<double> ends = {*low, *high};
  const std::vector<double> level(2, fit.level_db);
  return {.title = "Level over " + label,
          .x = {.label = label, .unit = unit},
          .y = {.label = "source level + gain", .unit = "dB"},
          .series = {points, {.name = "all frames", .x = ends, .y = level}},
          .alt = "Level of each frame over " + label};
}

void AddLevels(HtmlReport& report, const calib::StandardTargetFit& fit) {
  std::vector<LineChart> charts = {
      LevelChart(fit, "range", "m", [](const calib::TargetFrame& frame) { return frame.range_m; }),
      LevelChart(fit, "azimuth", "deg",
                 [](const calib::TargetFrame& frame) { return DegFromRad(frame.azimuth_rad); })};
  if (fit.position) {
    charts.push_back(LevelChart(fit, "elevation", "deg", [](const calib::TargetFrame& frame) {
      return DegFromRad(frame.elevation_rad.value_or(0.0));
    }));
  }
  report.Add(
      charts,
      "Level that each frame shows by itself, after the fitted responses. A trend is what the fit does not "
      "explain.");
}

void AddSensitivities(HtmlReport& report, const calib::StandardTargetFit& fit) {
  ChartSeries series{.name = "fitted, 95 %", .x = {}, .y = {}, .style = SeriesStyle::kPoints};
  for (const calib::FittedParameter& parameter : fit.report.parameters) {
    if (!IsSensitivity(parameter)) continue;
    series.x.push_back(std::stod(parameter.name.substr(parameter.name.rfind('.') + 1)));
    series.y.push_back(parameter.value);
    const double half_db = calib::kSigmasOf95 * parameter.sigma.value_or(0.0);
    series.low.push_back(parameter.value - half_db);
    series.high.push_back(parameter.value + half_db);
  }
  if (series.x.empty()) return;
  report.Add(
      {LineChart{.title = "Sensitivity of the beams",
                 .x = {.label = "beam"},
                 .y = {.label = "sensitivity", .unit = "dB"},
                 .series = {series},
                 .alt = "Sensitivity of each beam with its error"}},
      "Sensitivity of the beams that the sphere came near, about their mean. Other beams take that of the "
      "nearest.");
}

void AddParameters(HtmlReport& report, const calib::StandardTargetFit& fit) {
  Table table{
      .caption = "Fitted values.",
      .columns = {{"Parameter", "", false}, {"Start"}, {"Fitted"}, {"Standard error"}, {"", "Unit", false}},
      .rows = {}};
  for (const calib::FittedParameter& parameter : fit.report.parameters) {
    if (IsSensitivity(parameter)) continue;
    table.rows.push_back(
        {{parameter.name, fmt::format("{:.4g}", parameter.initial), fmt::format("{:.4g}", parameter.value),
          parameter.sigma ? fmt::format("{:.2g}", *parameter.sigma) : std::string(ToString(parameter.status)),
          parameter.unit}});
  }
  report.Add(table);
  for (const std::string& sentence : fit.report.gauge)
    report.Callout(CalloutKind::kLimit, "As given", sentence + ".");
}

}  // namespace

std::vector<std::string> StandardTargetInWords(const calib::StandardTargetFit& fit) {
  std::vector<std::string> sentences = {
      fmt::format("Source level plus gain is {:.2f} +- {:.2f} dB.", fit.level_db, fit.level_sigma_db),
      fmt::format("The sphere was found in {} of {} frames; its target strength is {}.", fit.frames.size(),
                  fit.frames.size() + fit.left_out.size(), StrengthText(fit.strength))};
  if (fit.grey_levels_per_db) {
    std::string text = GreyLevelsText(fit) + ".";
    text.front() = 'G';
    sentences.push_back(text);
  }
  if (fit.level_spread_db > 0.0) {
    sentences.push_back(
        fmt::format("The levels of the frames scatter by {:.2f} dB beyond noise.", fit.level_spread_db));
  }
  return sentences;
}

std::string StandardTargetText(const calib::StandardTargetFit& fit) {
  std::string text;
  for (const std::string& warning : fit.report.warnings) text += "warning: " + warning + "\n";
  text += fmt::format("  frames with the sphere: {} of {}\n", fit.frames.size(),
                      fit.frames.size() + fit.left_out.size());
  for (const auto& [why, frames] : LeftOutByReason(fit))
    text += fmt::format("    left out {}: {}\n", FrameList(frames), why);
  text += fmt::format("  target strength: {}\n", StrengthText(fit.strength));
  text += fmt::format("  source level + gain: {:.2f} +- {:.2f} dB\n", fit.level_db, fit.level_sigma_db);
  if (fit.level_spread_db > 0.0)
    text += fmt::format("    levels of frames scatter by {:.2f} dB beyond noise\n", fit.level_spread_db);
  if (fit.grey_levels_per_db) text += "  " + GreyLevelsText(fit) + "\n";
  for (const calib::FittedParameter& parameter : fit.report.parameters) {
    if (IsSensitivity(parameter) || parameter.name == "source_level_db") continue;
    text += fmt::format("  {:<27} {:>22}  {}{}\n", parameter.name, ValueText(parameter), parameter.unit,
                        parameter.status == calib::ParameterStatus::kFree
                            ? ""
                            : "  " + std::string(ToString(parameter.status)));
  }
  if (!fit.beams_determined.empty())
    text +=
        fmt::format("  sensitivity of {} beams: in fit.json and the report\n", fit.beams_determined.size());
  for (const std::string& sentence : fit.report.gauge) text += "  " + sentence + "\n";
  return text;
}

std::string StandardTargetMember(const calib::StandardTargetFit& fit) {
  const auto number = [](const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); };
  Json frames = Json::array();
  for (const calib::TargetFrame& frame : fit.frames) {
    frames.push_back(
        {{"frame", frame.frame},
         {"range_m", frame.range_m},
         {"azimuth_deg", DegFromRad(frame.azimuth_rad)},
         {"elevation_deg", frame.elevation_rad ? Json(DegFromRad(*frame.elevation_rad)) : Json(nullptr)},
         {"level_db", frame.level_db},
         {"level_sigma_db", frame.level_sigma_db},
         {"noise_db", frame.noise_db}});
  }
  Json left_out = Json::array();
  for (const calib::FrameLeftOut& frame : fit.left_out)
    left_out.push_back(
        {{"frame", frame.frame},
         {"why", frame.detail.empty() ? frame.why : fmt::format("{}: {}", frame.why, frame.detail)}});
  Json position = nullptr;
  if (fit.position) {
    const Eigen::Vector3d& at = fit.position->position_m;
    position = {{"position_m", {at.x(), at.y(), at.z()}},
                {"range_error_m", fit.position->range_error_m},
                {"azimuth_error_deg", DegFromRad(fit.position->azimuth_error_rad)}};
  }
  Json slope = nullptr;
  if (fit.display_slope)
    slope = {{"db_per_shown_db", fit.display_slope->db_per_shown_db}, {"sigma", fit.display_slope->sigma}};
  const Json member = {{"target_strength_db", fit.strength.db},
                       {"target_strength_sigma_db", fit.strength.sigma_db},
                       {"front_face_alone", fit.strength.front_face},
                       {"bandwidth_hz", fit.strength.bandwidth_hz},
                       {"first_internal_echo_m", fit.strength.first_internal_echo_m},
                       {"level_db", fit.level_db},
                       {"level_sigma_db", fit.level_sigma_db},
                       {"level_spread_db", fit.level_spread_db},
                       {"received_db", fit.received_db},
                       {"reference_range_m", fit.reference_range_m},
                       {"time_varied_gain", ToString(fit.parameters.receiver.time_varied_gain)},
                       {"grey_levels_per_db", number(fit.grey_levels_per_db)},
                       {"display_slope", slope},
                       {"beams_determined", fit.beams_determined},
                       {"target_in_world", position},
                       {"frames", frames},
                       {"frames_left_out", left_out}};
  return fmt::format(R"("standard_target": {})", data_io::JsonLine(member));
}

void AddStandardTarget(HtmlReport& report, const calib::StandardTargetFit& fit, const PolarAxes& axes,
                       bool is_synthetic) {
  for (const std::string& warning : fit.report.warnings)
    report.Callout(CalloutKind::kWarning, "Reason to doubt the fit", warning + ".");
  report.KeyFigures(
      {{.label = "Source level + gain",
        .value = fmt::format("{:.2f} +- {:.2f}", fit.level_db, fit.level_sigma_db),
        .unit = "dB"},
       {.label = "Target strength",
        .value = fmt::format("{:.2f} +- {:.2f}", fit.strength.db, fit.strength.sigma_db),
        .unit = "dB re 1 m^2"},
       {.label = "Frames with the sphere",
        .value = fmt::format("{} of {}", fit.frames.size(), fit.frames.size() + fit.left_out.size())}});
  report.Section("The sphere");
  for (const std::string& sentence : StandardTargetInWords(fit)) report.Paragraph(sentence);
  AddPictures(report, fit, axes, is_synthetic);
  report.Add({ProfileChart(fit, true, is_synthetic), ProfileChart(fit, false, is_synthetic)},
             "The echo of the picture above, on lines through its peak.");
  std::vector<std::string> left_out;
  for (const auto& [why, frames] : LeftOutByReason(fit))
    left_out.push_back(fmt::format("Frames {}: {}.", FrameList(frames), why));
  if (!left_out.empty()) {
    report.Subsection("Frames left out");
    report.List(left_out);
  }
  report.Section("Levels");
  AddLevels(report, fit);
  AddSensitivities(report, fit);
  report.Section("Parameters");
  AddParameters(report, fit);
}

}  // namespace sonarcal::report
