#include "apps/report/html/frame_viewer.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <span>

#include <nlohmann/json.hpp>

#include "apps/report/html/html_text.h"
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

// Colours of the grey values 0 .. 255, six hexadecimal digits each.
std::string InfernoHex() {
  Grid<float> ramp(1, 256);
  for (int i = 0; i < 256; ++i) ramp(0, i) = static_cast<float>(i);
  const RgbImage colours = data_io::Colorize(ramp, {0.0, 255.0});
  std::string hex;
  for (const auto& [r, g, b] : colours.values()) hex += fmt::format("{:02x}{:02x}{:02x}", r, g, b);
  return hex;
}

Json ViewerJson(const FrameViewer& viewer) {
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
    }
    frames.push_back({{"name", frame.name},
                      {"figures", frame.figures},
                      {"geometry", geometries.size() - 1},
                      {"full_scale", frame.full_scale}});
  }
  return {{"real", RealWord(viewer.real_is_synthetic)},
          {"geometries", geometries},
          {"frames", frames},
          {"inferno", InfernoHex()},
          {"alike", data_io::kAlikeGrey},
          {"regions",
           {ColourJson(data_io::kNeitherColor), ColourJson(data_io::kRealOnlyColor),
            ColourJson(data_io::kSimulatedOnlyColor), ColourJson(data_io::kBothColor)}}};
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

std::string FrameViewerHtml(const FrameViewer& viewer, int number) {
  SONARCAL_CHECK(!viewer.frames.empty(), "a viewer without frames");
  const std::string name = fmt::format("viewer-{}", number);
  const Json data = ViewerJson(viewer);
  std::string html = fmt::format(
      "<details hidden=\"hidden\"><summary>Browse the frames: blink, overlay, difference, values under the "
      "pointer</summary>\n<div class=\"viewer\" data-viewer=\"{}\">\n<div class=\"controls\">",
      EscapeHtml(data.dump(-1, ' ', false, Json::error_handler_t::replace)));
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
      "<p data-part=\"figures\"></p>\n<canvas data-part=\"canvas\" tabindex=\"0\" role=\"img\"></canvas>\n"
      "<p class=\"readout\"><output data-part=\"readout\"></output></p>\n<p><strong data-part=\"which\">"
      "</strong> <span data-part=\"key\"></span></p>\n";
  for (std::size_t i = 0; i < viewer.frames.size(); ++i) {
    const auto image = [&](const char* of, const std::vector<std::uint8_t>& png) {
      html += fmt::format(
          "<img hidden=\"hidden\" alt=\"\" data-frame=\"{}\" data-of=\"{}\" "
          "src=\"data:image/png;base64,{}\"/>\n",
          i, of, Base64(png));
    };
    image("real", viewer.frames[i].real);
    image("simulated", viewer.frames[i].simulated);
    image("objects", viewer.frames[i].objects);
  }
  return html + "</div></details>\n";
}

}  // namespace sonarcal::report
