#include "apps/report/figure_words.h"

#include <fmt/format.h>

#include "apps/report/html_text.h"

namespace sonarcal {
namespace {

constexpr int kDecimals = 3;
constexpr const char* kNoValue = "–";

}  // namespace

std::string FigureText(const std::optional<double>& value) {
  return value ? FormatNumber(*value, kDecimals) : kNoValue;
}

std::string IntervalText(const Statistic& statistic) {
  if (!statistic.ci) return kNoValue;
  return fmt::format("{} to {}", FormatNumber(statistic.ci->lo, kDecimals),
                     FormatNumber(statistic.ci->hi, kDecimals));
}

std::string UnitText(FigureUnit unit) {
  switch (unit) {
    case FigureUnit::kNone:
      return {};
    case FigureUnit::kFullScale:
      return "part of full scale";
    case FigureUnit::kDecibel:
      return "dB";
    case FigureUnit::kBins:
      return "bins";
    case FigureUnit::kBeams:
      return "beams";
    case FigureUnit::kMetres:
      return "m";
  }
  return {};
}

std::string DomainText(IntensityDomain domain) {
  switch (domain) {
    case IntensityDomain::kWhole:
      return "the whole image";
    case IntensityDomain::kOverlap:
      return "the pixels that both object regions share";
    case IntensityDomain::kUnion:
      break;
  }
  return "the union of the two object regions";
}

std::string FloorNote(const NoiseFloor& floor) {
  switch (floor.source()) {
    case FloorSource::kRealAgainstReal:
      return fmt::format(
          "Floor: {} pair{} of real frames of {} against each other.", floor.real_against_real.pairs.size(),
          floor.real_against_real.pairs.size() == 1 ? "" : "s",
          floor.real_against_real.assumed_still ? "a scene taken to be still" : "a still scene");
    case FloorSource::kDrawn:
      return "Floor: " + floor.drawn->law + ".";
    case FloorSource::kNone:
      break;
  }
  return {};
}

}  // namespace sonarcal
