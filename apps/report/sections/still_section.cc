#include "apps/report/sections/still_section.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "apps/report/sections/fit_section.h"
#include "data_io/json/json_writer.h"

namespace sonarcal::report {
namespace {

using Json = nlohmann::ordered_json;

std::string Level(double db, double sigma_db) {
  return fmt::format("{:.2f} +- {:.2f} dB", db, sigma_db);
}

std::string NoiseVerdict(const workflow::StillPose& pose) {
  if (!pose.fitted_noise_db) return {};
  const std::string fitted = pose.fitted_noise_sigma_db
                                 ? Level(*pose.fitted_noise_db, *pose.fitted_noise_sigma_db)
                                 : fmt::format("{:.2f} dB", *pose.fitted_noise_db);
  return fmt::format("fitted {}: {} ({:+.2f} dB, {:.1f} sigma)", fitted,
                     pose.NoiseAgrees() ? "they agree" : "they DISAGREE",
                     *pose.fitted_noise_db - pose.levels.noise_db, std::abs(*pose.NoiseDeviation()));
}

std::string SceneVerdict(const calib::SceneEchoes& scene) {
  return fmt::format(
      "{:.2f} dB where the fitted scene says {:.2f} ({:+.2f} +- {:.2f} dB) over the {} pixels "
      "{:g} dB above the noise, contrast {:.2f}",
      scene.measured_db, scene.expected_db, scene.expected_db - scene.measured_db, scene.sigma_db,
      scene.pixels, calib::kWellAboveNoiseDb, scene.contrast);
}

// Reason to doubt the noise level, or empty.
std::string Doubt(const calib::StillLevels& levels) {
  constexpr double kSigmas = 3.0;
  constexpr double kAtLeastDb = 0.3;
  if (!levels.bright_noise_db) return {};
  const double excess_db = *levels.bright_noise_db - levels.noise_db;
  if (excess_db < kAtLeastDb || excess_db < kSigmas * levels.bright_noise_sigma_db) return {};
  return fmt::format(
      "pixels far above the noise change as if it were {:.2f} dB higher: the echoes themselves change a "
      "little, and the noise level is too high by up to that",
      excess_db);
}

}  // namespace

std::string StillText(const workflow::StillPoses& still) {
  std::string text;
  for (const workflow::StillPose& pose : still.poses) {
    const calib::StillLevels& levels = pose.levels;
    text += fmt::format("  frames {} show one pose of a static scene\n", FrameList(levels.frames));
    if (!levels.moved.empty())
      text +=
          fmt::format("    frames {} share it, but the scene has moved: left out\n", FrameList(levels.moved));
    text += fmt::format("    noise, which changes:    {}", Level(levels.noise_db, levels.noise_sigma_db));
    text += pose.fitted_noise_db ? "; " + NoiseVerdict(pose) + "\n" : "\n";
    text += fmt::format("    speckle, which stays:    {}, mean power of {} pixels\n",
                        Level(levels.echo_db, levels.echo_sigma_db), levels.pixels);
    if (levels.clipped_at_top > 0)
      text += fmt::format("    and {} pixels clipped at the top, left out\n", levels.clipped_at_top);
    if (pose.scene) text += "    " + SceneVerdict(*pose.scene) + "\n";
    if (const std::string doubt = Doubt(levels); !doubt.empty()) text += "    " + doubt + "\n";
  }
  for (const std::string& sentence : still.refused) text += "  " + sentence + "\n";
  return text;
}

std::string StillMembers(const workflow::StillPoses& still) {
  const auto number = [](const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); };
  Json poses = Json::array();
  for (const workflow::StillPose& pose : still.poses) {
    const calib::StillLevels& levels = pose.levels;
    Json json = {{"frames", levels.frames},
                 {"frames_moved", levels.moved},
                 {"noise_db", levels.noise_db},
                 {"noise_sigma_db", levels.noise_sigma_db},
                 {"noise_by_bright_pixels_db", number(levels.bright_noise_db)},
                 {"speckle_db", levels.echo_db},
                 {"speckle_sigma_db", levels.echo_sigma_db},
                 {"pixels", levels.pixels},
                 {"pixels_clipped_at_top", levels.clipped_at_top}};
    if (pose.fitted_noise_db) {
      json["fitted_noise_db"] = *pose.fitted_noise_db;
      json["fitted_noise_sigma_db"] = number(pose.fitted_noise_sigma_db);
      json["noise_agrees"] = pose.NoiseAgrees();
    }
    if (pose.scene) {
      json["scene"] = {{"pixels", pose.scene->pixels},          {"above_noise_db", calib::kWellAboveNoiseDb},
                       {"speckle_db", pose.scene->measured_db}, {"fitted_db", pose.scene->expected_db},
                       {"sigma_db", pose.scene->sigma_db},      {"contrast", pose.scene->contrast}};
    }
    poses.push_back(json);
  }
  return fmt::format(R"("still": {}, "still_refused": {})", data_io::JsonLine(poses),
                     data_io::JsonLine(still.refused));
}

void AddStillPoses(HtmlReport& report, const workflow::StillPoses& still) {
  if (still.empty()) return;
  report.Subsection("Speckle and receiver noise");
  report.Paragraph(
      "Frames from one pose of a static scene: receiver noise changes from frame to frame, the echo with its "
      "speckle does not. The levels below need no scene and no law of speckle.");
  for (const workflow::StillPose& pose : still.poses) {
    const calib::StillLevels& levels = pose.levels;
    std::vector<std::pair<std::string, std::string>> facts = {
        {"Frames", FrameList(levels.frames)},
        {"Receiver noise", Level(levels.noise_db, levels.noise_sigma_db)},
        {"Speckle, mean power",
         fmt::format("{} over {} pixels, {} more clipped at the top",
                     Level(levels.echo_db, levels.echo_sigma_db), levels.pixels, levels.clipped_at_top)}};
    if (!levels.moved.empty()) facts.insert(facts.begin() + 1, {"Moved, left out", FrameList(levels.moved)});
    if (pose.fitted_noise_db) facts.emplace_back("Noise floor of the fit", NoiseVerdict(pose));
    if (pose.scene) facts.emplace_back("Speckle and the fitted scene", SceneVerdict(*pose.scene));
    report.Facts(facts);
    if (const std::string doubt = Doubt(levels); !doubt.empty())
      report.Callout(CalloutKind::kLimit, "The echoes change a little", doubt + ".");
  }
  for (const std::string& sentence : still.refused)
    report.Callout(CalloutKind::kLimit, "Poses without a result", sentence + ".");
}

}  // namespace sonarcal::report
