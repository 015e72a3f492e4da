// `sonarcal inspect FILE...`: prints the contents of a file: sensor, window, beams, frames, gain, scale,
// quirks.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <nlohmann/json_fwd.hpp>

#include "apps/cli/bag_options.h"
#include "apps/cli/command.h"
#include "apps/commands/commands.h"
#include "core/types/error.h"
#include "core/types/recording.h"
#include "data_io/json/json_fields.h"
#include "data_io/recordings/recording_summary.h"

namespace sonarcal::commands {
namespace {

struct InspectOptions {
  cli::CommonOptions common;
  std::vector<std::filesystem::path> files;
  cli::BagArguments bag;
};

using Json = nlohmann::ordered_json;

// A page of "label  value" lines with aligned values.
class Page {
 public:
  void Add(std::string_view label, std::string_view value) { lines_.emplace_back(label, value); }
  void AddList(std::string_view label, const std::vector<std::string>& items) {
    for (std::size_t i = 0; i < items.size(); ++i) Add(i == 0 ? label : "", "- " + items[i]);
  }
  std::string Text() const {
    std::size_t width = 0;
    for (const auto& [label, value] : lines_) width = std::max(width, label.size());
    std::string text;
    for (const auto& [label, value] : lines_) text += fmt::format("  {:<{}}  {}\n", label, width, value);
    return text;
  }

 private:
  std::vector<std::pair<std::string, std::string>> lines_;
};

std::string FrequencyText(double frequency_hz) {
  if (!(frequency_hz > 0.0)) return "frequency unknown";
  return frequency_hz < 1e6 ? fmt::format("{:.6g} kHz", frequency_hz * 1e-3)
                            : fmt::format("{:.6g} MHz", frequency_hz * 1e-6);
}

std::string SensorText(const SonarModel& sonar) {
  return fmt::format("{}, {}", sonar.name.empty() ? "unnamed" : sonar.name,
                     FrequencyText(sonar.frequency_hz));
}

std::string WindowText(const PolarAxes& axes, double range_bin_m) {
  return fmt::format("{:.4g} .. {:.5g} m, {} bins of {:.4g} mm", axes.range_min_m, axes.range_max_m,
                     axes.range_bins, range_bin_m * 1e3);
}

std::string BeamsText(const SonarModel& sonar, const data_io::RecordingSummary& summary) {
  const std::string spacing = summary.EvenBeams()
                                  ? fmt::format("spaced by {:.3g}°", summary.beam_spacing_mean_deg)
                                  : fmt::format("spaced unevenly by {:.3g} .. {:.3g}°",
                                                summary.beam_spacing_min_deg, summary.beam_spacing_max_deg);
  return fmt::format("{} from {:+.2f}° to {:+.2f}°, {}", sonar.axes.beam_count(), summary.azimuth_first_deg,
                     summary.azimuth_last_deg, spacing);
}

std::string BeamWidthText(const SonarModel& sonar) {
  const auto width = [](double width_deg) {
    return width_deg > 0.0 ? fmt::format("{:.3g}°", width_deg) : std::string("unknown");
  };
  std::string text = fmt::format("{} in azimuth, {} in elevation", width(sonar.azimuth_beam_width_deg),
                                 width(sonar.elevation_beam_width_deg));
  if (sonar.beam_forming != BeamForming::kUnknown)
    text += fmt::format(", formed by {}", sonar.beam_forming == BeamForming::kLens ? "a lens" : "an array");
  return text;
}

std::string PingsText(const PingPattern& pings) {
  if (!(pings.period_s > 0.0)) return fmt::format("{}, time between them unknown", pings.count());
  return fmt::format("{}, {:.4g} ms apart", pings.count(), pings.period_s * 1e3);
}

std::string WaterText(const Water& water) {
  return fmt::format("{:.4g} °C, {:.4g} ppt salt, pH {:.3g}, {:.4g} m deep", water.temperature_c,
                     water.salinity_ppt, water.ph, water.depth_m);
}

std::string RecordingDurationText(double duration_s) {
  if (duration_s < 120.0) return fmt::format("{:.3g} s", duration_s);
  if (duration_s < 7200.0) return fmt::format("{:.1f} min", duration_s / 60.0);
  return fmt::format("{:.1f} h", duration_s / 3600.0);
}

std::string FramesText(int frame_count, const data_io::RecordingSummary& summary) {
  std::string text = fmt::format("{}", frame_count);
  if (summary.duration_s && frame_count > 1 && *summary.duration_s > 0.0) {
    const double rate_hz = (frame_count - 1) / *summary.duration_s;
    text += " over " + RecordingDurationText(*summary.duration_s);
    if (rate_hz >= 0.1) text += fmt::format(", {:.3g} a second", rate_hz);
  }
  if (summary.frames_with_pose == 0) return text + ", no poses";
  if (summary.frames_with_pose == frame_count) return text + ", each with a pose";
  return text + fmt::format(", {} of them with a pose", summary.frames_with_pose);
}

std::string ScaleText(const ImageScale& scale) {
  std::string text(ToString(scale.quantity));
  if (scale.quantity == Quantity::kGrey) text += fmt::format(" 0 .. {:g}", scale.full_scale);
  if (scale.db_min && scale.db_max) {
    text += fmt::format(", showing {:g} .. {:g} dB", *scale.db_min, *scale.db_max);
  } else if (scale.db_span) {
    text += fmt::format(", spanning {:.4g} dB, absolute level unknown", *scale.db_span);
  } else if (scale.quantity == Quantity::kGrey) {
    text += ", decibels a step unknown";
  }
  return text;
}

std::string PixelsText(const data_io::PixelSummary& pixels, const ImageScale& scale) {
  std::string text =
      fmt::format("{:.4g} .. {:.4g}, median {:.4g}", pixels.minimum, pixels.maximum, pixels.median);
  if (scale.quantity == Quantity::kGrey) {
    text += fmt::format(", {:.1f} % at 0, {:.1f} % at full scale", 100.0 * pixels.at_minimum_fraction,
                        100.0 * pixels.at_full_scale_fraction);
  }
  return text;
}

std::string SaturationText(const data_io::RecordingSummary& summary, const PolarAxes& axes) {
  std::string text;
  if (!summary.streaks.empty())
    text = "streaks along azimuth in the first frame: " + Describe(summary.streaks, axes);
  if (summary.saturation_level) {
    text += fmt::format("{}values of the first frame pile up at {:g}", text.empty() ? "" : "; ",
                        *summary.saturation_level);
  }
  return text;
}

Json SaturationToJson(const data_io::RecordingSummary& summary) {
  return {{"streaks", data_io::StreaksJson(summary.streaks)},
          {"level", summary.saturation_level ? Json(*summary.saturation_level) : Json(nullptr)}};
}

template <typename T>
void SetIfKnown(Json& json, const char* key, const std::optional<T>& value) {
  if (value) json[key] = *value;
}

Json SonarToJson(const SonarModel& sonar, const data_io::RecordingSummary& summary) {
  return {{"name", sonar.name},
          {"frequency_hz", sonar.frequency_hz},
          {"range_min_m", sonar.axes.range_min_m},
          {"range_max_m", sonar.axes.range_max_m},
          {"range_bins", sonar.axes.range_bins},
          {"range_bin_m", summary.range_bin_m},
          {"beams", sonar.axes.beam_count()},
          {"azimuth_first_deg", summary.azimuth_first_deg},
          {"azimuth_last_deg", summary.azimuth_last_deg},
          {"beam_spacing_min_deg", summary.beam_spacing_min_deg},
          {"beam_spacing_max_deg", summary.beam_spacing_max_deg},
          {"azimuth_beam_width_deg", sonar.azimuth_beam_width_deg},
          {"elevation_beam_width_deg", sonar.elevation_beam_width_deg},
          {"sound_speed_m_per_s", sonar.sound_speed_m_per_s},
          {"beam_forming",
           sonar.beam_forming == BeamForming::kUnknown ? Json(nullptr) : Json(ToString(sonar.beam_forming))}};
}

Json ImageToJson(const ImageScale& scale, const data_io::RecordingSummary& summary) {
  Json json = {{"quantity", ToString(scale.quantity)}, {"full_scale", scale.full_scale}};
  SetIfKnown(json, "db_min", scale.db_min);
  SetIfKnown(json, "db_max", scale.db_max);
  SetIfKnown(json, "db_span", scale.db_span);
  if (summary.first_frame) {
    const data_io::PixelSummary& pixels = *summary.first_frame;
    json["first_frame"] = {{"minimum", pixels.minimum},
                           {"median", pixels.median},
                           {"maximum", pixels.maximum},
                           {"at_minimum_fraction", pixels.at_minimum_fraction},
                           {"at_full_scale_fraction", pixels.at_full_scale_fraction},
                           {"saturation", SaturationToJson(summary)}};
  }
  return json;
}

// Sentences on damaged frames.
std::vector<std::string> DamageNotes(const RecordingSource& recording,
                                     const data_io::RecordingSummary& summary) {
  std::vector<std::string> notes;
  if (!summary.first_frame_failure.empty()) notes.push_back(summary.first_frame_failure);
  if (summary.frames_without_header > 0) {
    notes.push_back(fmt::format("{} of {} frames cannot be read, the first because: {}",
                                summary.frames_without_header, recording.frame_count(),
                                summary.header_failure));
  }
  return notes;
}

// Both read the statistics of the first frame, and state if frames are damaged.
std::string DescribeRecording(const RecordingSource& recording) {
  const RecordingInfo& info = recording.info();
  const data_io::RecordingSummary summary = data_io::Summarize(recording);
  const std::string title =
      fmt::format("{}  ({}){}\n", info.source, info.format,
                  info.synthetic ? "  SYNTHETIC: made by a simulation, no sonar recorded this" : "");
  Page page;
  page.Add("sensor", SensorText(info.sonar));
  page.Add("window", WindowText(info.sonar.axes, summary.range_bin_m));
  page.Add("beams", BeamsText(info.sonar, summary));
  page.Add("beam width", BeamWidthText(info.sonar));
  if (!info.sonar.pings.of_beam.empty()) page.Add("pings a frame", PingsText(info.sonar.pings));
  page.Add("frames", FramesText(recording.frame_count(), summary));
  page.Add("scale", ScaleText(info.scale));
  page.Add("settings", Describe(info.settings));
  if (summary.first_frame) page.Add("first frame", PixelsText(*summary.first_frame, info.scale));
  if (const std::string text = SaturationText(summary, info.sonar.axes); !text.empty())
    page.Add("saturated", text);
  page.AddList("damaged", DamageNotes(recording, summary));
  if (info.sonar.sound_speed_m_per_s > 0.0) {
    page.Add("sound speed", fmt::format("{:.2f} m/s", info.sonar.sound_speed_m_per_s));
  }
  if (info.water) page.Add("water", WaterText(*info.water));
  if (info.source_level_db) page.Add("source level", fmt::format("{:g} dB", *info.source_level_db));
  if (info.scene_path) page.Add("scene", *info.scene_path);
  for (const auto& [name, value] : info.details) page.Add(name, value);
  page.AddList("notes", info.notes);
  return title + page.Text();
}

Json RecordingToJson(const RecordingSource& recording) {
  const RecordingInfo& info = recording.info();
  const data_io::RecordingSummary summary = data_io::Summarize(recording);
  Json json = {{"file", info.source},
               {"format", info.format},
               {"synthetic", info.synthetic},
               {"sonar", SonarToJson(info.sonar, summary)},
               {"image", ImageToJson(info.scale, summary)},
               {"frames", recording.frame_count()},
               {"frames_with_time", summary.frames_with_time},
               {"frames_with_pose", summary.frames_with_pose}};
  SetIfKnown(json, "duration_s", summary.duration_s);
  if (info.water) json["water"] = data_io::WaterJson(*info.water);
  SetIfKnown(json, "source_level_db", info.source_level_db);
  SetIfKnown(json, "scene", info.scene_path);
  json["details"] = Json::object();
  for (const auto& [name, value] : info.details) json["details"][name] = value;
  json["notes"] = info.notes;
  for (const std::string& note : DamageNotes(recording, summary)) json["notes"].push_back(note);
  return json;
}

}  // namespace

cli::ExitStatus RunInspect(const InspectOptions& options) {
  cli::ExitStatus status = cli::ExitStatus::kDone;
  Json pages = Json::array();
  bool first = true;
  for (const std::filesystem::path& file : options.files) {
    try {
      const auto recording = cli::OpenWithBagOptions(file, options.bag);
      if (options.common.json) {
        pages.push_back(RecordingToJson(*recording));
      } else {
        cli::PrintResult((first ? "" : "\n") + DescribeRecording(*recording));
      }
      first = false;
    } catch (const DataError& error) {
      cli::PrintError(error.what());
      status = cli::ExitStatus::kFailed;
    }
  }
  if (options.common.json) cli::PrintJson({{"recordings", pages}});
  return status;
}

void SetupInspect(CLI::App& app) {
  auto options = std::make_shared<InspectOptions>();
  CLI::App* command =
      cli::AddCommand(app, "inspect", "Prints the contents of a recording: sensor, window, beams, frames");
  command->add_option("FILE", options->files, "Recording folders, or files of a sonar's native format")
      ->required();
  cli::AddBagOptions(*command, options->bag);
  cli::OnRun(command, options->common, [options] { return RunInspect(*options); });
}

}  // namespace sonarcal::commands
