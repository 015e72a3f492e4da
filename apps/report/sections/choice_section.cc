#include "apps/report/sections/choice_section.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include <nlohmann/json.hpp>

#include "apps/report/sections/fit_section.h"
#include "data_io/json/json_writer.h"

namespace sonarcal::report {
namespace {

std::string AxisTitle(calib::ChoiceAxis axis) {
  switch (axis) {
    case calib::ChoiceAxis::kPattern:
      return "Azimuth pattern of the beams";
    case calib::ChoiceAxis::kElevation:
      return "Elevation pattern of the beams";
    case calib::ChoiceAxis::kMirrors:
      return "Lobes through which mirrors are seen";
    case calib::ChoiceAxis::kLooks:
      return "Looks";
    case calib::ChoiceAxis::kTrend:
      return "Trend of the noise floor with range";
    case calib::ChoiceAxis::kDisplay:
      break;
  }
  return "Display law";
}

std::string Verdict(const calib::JudgedVariant& variant) {
  if (!variant.usable) return "no fit";
  std::string verdict = variant.behind.mean <= 0.0 ? "best" : variant.tied ? "tie" : "worse";
  if (variant.chosen) verdict += ", chosen";
  return verdict;
}

std::string Behind(const calib::JudgedVariant& variant) {
  if (!variant.usable) return "–";
  if (variant.behind.mean <= 0.0) return "0";
  return fmt::format("{:.5f} ± {:.5f}", variant.behind.mean, variant.behind.sigma);
}

std::string Name(const calib::JudgedVariant& variant) {
  return variant.given ? variant.name + " (given)" : variant.name;
}

}  // namespace

void AddModelChoice(HtmlReport& report, const calib::ModelChoice& choice) {
  report.Subsection("Choice of the model");
  const bool by_background = choice.frames_chosen_on.empty();
  report.Paragraph(
      by_background ? "Each law was fitted to and evaluated on the background of one frame."
                    : fmt::format("Each variant was fitted to the frames used, one choice after the other, "
                                  "and evaluated by the likelihood of the grey values of the held-out {}.",
                                  NamedFrames(choice.frames_chosen_on)));
  Table table{.caption = by_background ? "Variants by likelihood of the background"
                                       : "Variants by likelihood of the held-out frames",
              .columns = {{"Variant"},
                          {"Log-likelihood", "nats a pixel"},
                          {"Behind the best", "nats a pixel"},
                          {"Verdict", {}, false}},
              .rows = {}};
  for (const calib::JudgedAxis& axis : choice.axes) {
    table.rows.push_back({{AxisTitle(axis.axis)}, RowStyle::kGroup});
    for (const calib::JudgedVariant& variant : axis.variants) {
      table.rows.push_back(
          {{Name(variant), variant.usable ? fmt::format("{:.5f}", variant.nats_per_pixel) : "–",
            Behind(variant), Verdict(variant)},
           variant.chosen ? RowStyle::kStrong : RowStyle::kPlain});
    }
    for (const std::string& note : axis.notes) table.notes.push_back(note);
  }
  table.notes.push_back(fmt::format(
      "± is one standard error of the difference, on the same {:.0f} pixels, over {} blocks that are larger "
      "than a speckle cell. Variants within {:g} standard errors of the best are equally good. Of these, the "
      "one with the fewest fitted values is selected, and among equals the given one.",
      choice.pixels, choice.blocks, choice.tie_sigmas));
  if (!by_background) {
    table.notes.emplace_back(
        "The same frames evaluate the fit below. This gives it a small advantage, because there are few "
        "variants.");
  }
  report.Add(table);
}

std::string ModelChoiceText(const calib::ModelChoice& choice) {
  std::size_t width = 0;
  for (const calib::JudgedAxis& axis : choice.axes) {
    for (const calib::JudgedVariant& variant : axis.variants) width = std::max(width, Name(variant).size());
  }
  std::string text = choice.frames_chosen_on.empty()
                         ? std::string("choice of the display by the background of one frame\n")
                         : fmt::format("choice of the model by the likelihood of {}\n",
                                       NamedFrames(choice.frames_chosen_on));
  for (const calib::JudgedAxis& axis : choice.axes) {
    text += fmt::format("  {:<{}}  {:>13}  {:>19}\n", ToString(axis.axis), width + 2, "nats a pixel",
                        "behind the best");
    for (const calib::JudgedVariant& variant : axis.variants) {
      const std::string figure = variant.usable ? fmt::format("{:.5f}", variant.nats_per_pixel) : "-";
      text += fmt::format("    {:<{}}  {:>13}  {:>19}  {}\n", Name(variant), width, figure, Behind(variant),
                          Verdict(variant));
    }
    for (const std::string& note : axis.notes) text += fmt::format("    {}\n", note);
  }
  return text;
}

std::string ModelChoiceJson(const calib::ModelChoice& choice) {
  using Json = nlohmann::ordered_json;
  Json axes = Json::array();
  for (const calib::JudgedAxis& axis : choice.axes) {
    Json variants = Json::array();
    for (const calib::JudgedVariant& variant : axis.variants) {
      const auto figure = [&](double value) { return variant.usable ? Json(value) : Json(nullptr); };
      variants.push_back({{"name", variant.name},
                          {"nats_per_pixel", figure(variant.nats_per_pixel)},
                          {"behind_best", figure(variant.behind.mean)},
                          {"behind_best_sigma", figure(variant.behind.sigma)},
                          {"fitted_values", variant.fitted_values},
                          {"given", variant.given},
                          {"usable", variant.usable},
                          {"tied", variant.tied},
                          {"chosen", variant.chosen}});
    }
    axes.push_back({{"axis", ToString(axis.axis)}, {"variants", variants}, {"notes", axis.notes}});
  }
  const Json json = {{"frames", choice.frames_chosen_on},
                     {"pixels", choice.pixels},
                     {"blocks", choice.blocks},
                     {"tie_sigmas", choice.tie_sigmas},
                     {"axes", axes}};
  return data_io::JsonLine(json);
}

}  // namespace sonarcal::report
