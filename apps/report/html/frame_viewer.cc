#include "apps/report/html/frame_viewer.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <span>
#include <string_view>

#include <nlohmann/json.hpp>

#include "apps/report/html/html_text.h"
#include "apps/report/html/sonar_plot.h"
#include "core/types/error.h"
#include "core/types/units.h"
#include "data_io/pictures/picture.h"

namespace sonarcal::report {
namespace {

using Json = nlohmann::ordered_json;

struct Choice {
  const char* value;
  std::string label;
};

const std::array<Choice, 2> kViews = {{{"fan", "Fan"}, {"polar", "Polar"}}};

Json ColourJson(const data_io::Rgb& colour) {
  return {colour[0], colour[1], colour[2]};
}

// Max size of the canvas (frame_viewer.js).
constexpr double kMaxWidthPx = 960.0;
constexpr double kMaxHeightPx = 520.0;

// Data of the script, and the axes to lay over the canvas: one drawing per geometry and view.
struct ViewerData {
  Json json;
  std::string axes;
};

ViewerData DataOf(const FrameViewer& viewer,
                  const std::function<std::string(const std::vector<std::uint8_t>&)>& store) {
  std::string axes;
  Json geometries = Json::array();
  Json frames = Json::array();
  const PolarAxes* last = nullptr;
  for (const ViewerFrame& frame : viewer.frames) {
    if (last == nullptr || !last->Matches(frame.axes)) {
      last = &frame.axes;
      Json azimuth_deg = Json::array();
      for (const double azimuth : last->beam_azimuth_rad) {
        azimuth_deg.push_back(std::round(1e4 * DegFromRad(azimuth)) / 1e4);
      }
      geometries.push_back(
          {{"range_m", {last->range_min_m, last->range_max_m}}, {"azimuth_deg", azimuth_deg}});
      for (const SonarView view : {SonarView::kFan, SonarView::kPolar}) {
        axes += SonarAxesSvg(*last, view, kMaxWidthPx, kMaxHeightPx,
                             fmt::format(R"( hidden="hidden" data-axes="{} {}")",
                                         view == SonarView::kFan ? "fan" : "polar", geometries.size() - 1));
      }
    }
    frames.push_back({{"name", frame.name},
                      {"figures", frame.figures},
                      {"geometry", geometries.size() - 1},
                      {"full_scale", frame.full_scale},
                      {"pictures",
                       {{"real", store(frame.real)},
                        {"simulated", store(frame.simulated)},
                        {"objects", store(frame.objects)}}}});
  }
  return {{{"real", RealWord(viewer.real_is_synthetic)},
           {"geometries", geometries},
           {"frames", frames},
           {"alike", data_io::kAlikeGrey},
           {"regions",
            {ColourJson(data_io::kNeitherColor), ColourJson(data_io::kRealOnlyColor),
             ColourJson(data_io::kSimulatedOnlyColor), ColourJson(data_io::kBothColor)}}},
          axes};
}

// Colour bars of what the viewer can show. The script picks one.
std::string BarsHtml(const FrameViewer& viewer) {
  const std::string full_scale = fmt::format("{:g}", viewer.frames.front().full_scale);
  const std::string real = RealWord(viewer.real_is_synthetic);
  std::string html;
  const auto add = [&](std::string_view gradient, const std::array<std::string, 3>& texts) {
    html += ColourBarSvg(gradient, texts, fmt::format(R"( hidden="hidden" data-bar="{}")", gradient));
  };
  add("inferno", {"0", "grey level", full_scale});
  add("grey", {"0", "grey level", full_scale});
  for (const char* of_two : {"overlay", "difference"}) add(of_two, {real, "← brighter →", "simulated"});
  return html;
}

// Buttons of which one is selected. The arrow keys move from one to the next.
std::string ChoiceHtml(const std::string& name, const char* what, const char* legend,
                       std::span<const Choice> choices) {
  std::string html = fmt::format("<fieldset><legend>{}</legend>", legend);
  for (const Choice& choice : choices) {
    html += fmt::format(
        "<label><input type=\"radio\" name=\"{}-{}\" data-choice=\"{}\" value=\"{}\"{}/>{}</label>", name,
        what, what, choice.value, &choice == choices.data() ? " checked=\"checked\"" : "", choice.label);
  }
  return html + "</fieldset>";
}

}  // namespace

std::string FrameViewerHtml(const FrameViewer& viewer, int number,
                            const std::function<std::string(const std::vector<std::uint8_t>&)>& store) {
  SONARCAL_CHECK(!viewer.frames.empty(), "a viewer without frames");
  const std::string name = fmt::format("viewer-{}", number);
  const ViewerData data = DataOf(viewer, store);
  std::string html = fmt::format(
      "<details hidden=\"hidden\"><summary>Browse the frames: blink, overlay, difference, values under the "
      "pointer</summary>\n<div class=\"viewer\" data-viewer=\"{}\">\n<div class=\"controls\">",
      EscapeHtml(data.json.dump(-1, ' ', false, Json::error_handler_t::replace)));
  const std::array<Choice, 6> show = {{{"real", RealCaption(viewer.real_is_synthetic)},
                                       {"simulated", "Simulated"},
                                       {"blink", "Blink"},
                                       {"overlay", "Overlay"},
                                       {"difference", "Difference"},
                                       {"regions", "Regions"}}};
  html += ChoiceHtml(name, "show", "Show", show) + ChoiceHtml(name, "view", "As", kViews);
  html +=
      "<label>Colours <select data-part=\"colours\"><option value=\"inferno\">Inferno</option>"
      "<option value=\"grey\">Grey</option></select></label>"
      "<label><input type=\"checkbox\" data-part=\"outline\"/>Outline objects</label></div>\n";
  html += fmt::format(
      "<div class=\"frames\"><button type=\"button\" data-part=\"before\" aria-label=\"Previous "
      "frame\">\u2039</button><label class=\"slider\">Frame <input type=\"range\" data-part=\"slider\" "
      "min=\"0\" max=\"{}\" value=\"0\" step=\"1\"/></label><button type=\"button\" data-part=\"after\" "
      "aria-label=\"Next frame\">\u203a</button> <strong data-part=\"name\"></strong></div>\n",
      viewer.frames.size() - 1);
  html +=
      "<p data-part=\"figures\"></p>\n<div class=\"stage\"><canvas data-part=\"canvas\" tabindex=\"0\" "
      "role=\"img\"></canvas>";
  html += data.axes + "</div>" + BarsHtml(viewer);
  html +=
      "\n<p class=\"readout\"><output data-part=\"readout\"></output></p>\n<p><strong data-part=\"which\">"
      "</strong> <span data-part=\"key\"></span></p>\n";
  return html + "</div></details>\n";
}

}  // namespace sonarcal::report
