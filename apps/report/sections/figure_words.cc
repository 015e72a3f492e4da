#include "apps/report/sections/figure_words.h"

#include <fmt/format.h>

#include "apps/report/html/html_text.h"

namespace sonarcal::report {
namespace {

constexpr int kDecimals = 3;
constexpr const char* kNoValue = "–";

}  // namespace

std::string FigureText(const std::optional<double>& value) {
  return FormatNumber(value, kDecimals);
}

std::string IntervalText(const metrics::Statistic& statistic) {
  if (!statistic.ci) return kNoValue;
  return fmt::format("{} to {}", FormatNumber(statistic.ci->lo, kDecimals),
                     FormatNumber(statistic.ci->hi, kDecimals));
}

std::string UnitText(metrics::FigureUnit unit) {
  switch (unit) {
    case metrics::FigureUnit::kNone:
      return {};
    case metrics::FigureUnit::kFullScale:
      return "part of full scale";
    case metrics::FigureUnit::kDecibel:
      return "dB";
    case metrics::FigureUnit::kBins:
      return "bins";
    case metrics::FigureUnit::kBeams:
      return "beams";
    case metrics::FigureUnit::kMetres:
      return "m";
  }
  return {};
}

std::string LabelWithUnit(const metrics::Figure& figure) {
  const std::string unit = UnitText(figure.unit);
  return unit.empty() ? figure.label : fmt::format("{} ({})", figure.label, unit);
}

std::string DomainText(metrics::IntensityDomain domain) {
  switch (domain) {
    case metrics::IntensityDomain::kWhole:
      return "the whole image";
    case metrics::IntensityDomain::kOverlap:
      return "the pixels that both object regions share";
    case metrics::IntensityDomain::kUnion:
      break;
  }
  return "the union of the two object regions";
}

std::string FloorNote(const metrics::NoiseFloor& floor) {
  switch (floor.source()) {
    case metrics::FloorSource::kRealAgainstReal:
      return fmt::format(
          "Floor: {} pair{} of real frames of {} against each other.", floor.real_against_real.pairs.size(),
          floor.real_against_real.pairs.size() == 1 ? "" : "s",
          floor.real_against_real.assumed_still ? "a scene assumed to be static" : "a still scene");
    case metrics::FloorSource::kDrawn:
      return "Floor: " + floor.drawn->law + ".";
    case metrics::FloorSource::kNone:
      break;
  }
  return {};
}

}  // namespace sonarcal::report
