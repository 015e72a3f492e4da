#include "apps/view/view_api.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <exception>
#include <utility>

#include <nlohmann/json.hpp>

#include "apps/cli/provenance.h"
#include "apps/cli/run_output.h"
#include "apps/view/view_controls.h"
#include "apps/view/view_files.h"
#include "apps/view/view_mesh.h"
#include "core/types/error.h"
#include "core/types/units.h"
#include "data_io/files/atomic_output.h"
#include "data_io/json/json_fields.h"
#include "data_io/json/json_reader.h"
#include "data_io/json/json_writer.h"
#include "data_io/json/parameter_json.h"
#include "data_io/parameters/parameters_io.h"
#include "data_io/pictures/picture.h"
#include "metrics/json/metrics_json.h"

namespace sonarcal::view {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kJson = "application/json";
constexpr const char* kBytes = "application/octet-stream";

// A request that does not belong to this interface, unlike one whose result cannot be made.
class BadRequest : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

std::string Text(const Json& json) {
  return data_io::JsonLine(json);
}

ViewAnswer JsonAnswer(const Json& json) {
  return {200, kJson, Text(json)};
}

ViewAnswer Refusal(int status, const std::string& sentence) {
  return {status, kJson, Text({{"error", sentence}})};
}

ViewState StateOf(std::string_view body, const ViewSession& session) {
  try {
    return ParseViewState(body, session.frame_count());
  } catch (const DataError& error) {
    throw BadRequest(error.what());
  }
}

Json AxesJson(const PolarAxes& axes) {
  Json azimuth_deg = Json::array();
  for (const double azimuth_rad : axes.beam_azimuth_rad) azimuth_deg.push_back(DegFromRad(azimuth_rad));
  return {{"range_m", {axes.range_min_m, axes.range_max_m}}, {"azimuth_deg", std::move(azimuth_deg)}};
}

Json ImageJson(const PolarImage& image) {
  return {{"bins", image.value.rows()},
          {"beams", image.value.cols()},
          {"bytes", image.scale.full_scale > 255.0 ? 2 : 1},
          {"full_scale", image.scale.full_scale},
          {"axes", AxesJson(image.axes)}};
}

// Rounds to whole grey values, as in the file of a frame.
std::string GreyBytes(const PolarImage& image) {
  const bool wide = image.scale.full_scale > 255.0;
  std::string bytes;
  bytes.reserve(image.value.size() * (wide ? 2 : 1));
  for (const float value : image.value.values()) {
    const auto grey = static_cast<std::uint16_t>(std::lround(value));
    bytes += static_cast<char>(grey & 0xff);
    if (wide) bytes += static_cast<char>(grey >> 8);
  }
  return bytes;
}

// 1: object in the real image, 2: in the simulated one, 3: in both.
std::string RegionBytes(const metrics::FrameMasks& masks) {
  std::string bytes;
  bytes.reserve(masks.polar_real.size());
  for (std::size_t i = 0; i < masks.polar_real.size(); ++i) {
    bytes += static_cast<char>((masks.polar_real.values()[i] != 0 ? 1 : 0) +
                               (masks.polar_simulated.values()[i] != 0 ? 2 : 0));
  }
  return bytes;
}

Json RampJson(data_io::ColorMap map) {
  Grid<float> ramp(1, 256);
  for (int i = 0; i < 256; ++i) ramp(0, i) = static_cast<float>(i);
  const RgbImage colours = data_io::Colorize(ramp, {0.0, 255.0}, map);
  Json json = Json::array();
  for (const data_io::Rgb& colour : colours.values()) json.push_back({colour[0], colour[1], colour[2]});
  return json;
}

Json ColourJson(const data_io::Rgb& colour) {
  return {colour[0], colour[1], colour[2]};
}

Json FramesJson(const ViewSetup& setup) {
  Json frames = Json::array();
  for (std::size_t i = 0; i < setup.poses.size(); ++i) {
    const data_io::TimedPose& pose = setup.poses[i];
    Json item = {
        {"name", setup.real ? setup.real->frame_info(static_cast<int>(i)).name : fmt::format("frame {}", i)},
        {"pose", AnglePoseJson(pose.world_from_sonar)}};
    if (pose.time_s) item["time_s"] = *pose.time_s;
    frames.push_back(std::move(item));
  }
  return frames;
}

Json RecordedJson(const ViewSetup& setup) {
  if (!setup.real) return nullptr;
  const RecordingInfo& info = setup.real->info();
  Json json = {{"name", workflow::RecordingName(info)},
               {"synthetic", info.synthetic},
               {"full_scale", info.scale.full_scale}};
  if (info.scale.db_min) json["db_min"] = *info.scale.db_min;
  if (info.scale.db_max) json["db_max"] = *info.scale.db_max;
  return json;
}

}  // namespace

ViewApi::ViewApi(ViewSession& session, std::filesystem::path out, bool force)
    : session_(session), out_(std::move(out)), force_(force) {}

ViewAnswer ViewApi::Answer(std::string_view method, std::string_view path, std::string_view body) {
  try {
    return Dispatch(method, path, body);
  } catch (const BadRequest& error) {
    return Refusal(400, error.what());
  } catch (const DataError& error) {
    return Refusal(422, error.what());
  } catch (const UsageError& error) {
    return Refusal(422, error.what());
  } catch (const std::bad_alloc&) {
    return Refusal(422, "not enough memory for this image");
  } catch (const std::exception& error) {
    return Refusal(500, fmt::format("internal error: {}; please report this", error.what()));
  }
}

ViewAnswer ViewApi::Dispatch(std::string_view method, std::string_view path, std::string_view body) {
  if (method == "GET") {
    if (path == "/api/session") return Session();
    if (path == "/api/scene") return MeshOfScene();
    if (path == "/api/fit") return JsonAnswer(fit_.Status());
  }
  if (method == "POST") {
    if (path == "/api/render") return Render(body);
    if (path == "/api/recorded") return Recorded(body);
    if (path == "/api/compare") return Compare(body);
    if (path == "/api/files") return Files(body);
    if (path == "/api/save") return Save(body);
    if (path == "/api/fit/start") return StartFit(body);
    if (path == "/api/fit/stop") {
      fit_.Stop();
      return JsonAnswer(fit_.Status());
    }
  }
  return Refusal(404, "nothing is there");
}

ViewAnswer ViewApi::Session() const {
  const ViewSetup& setup = session_.setup();
  ParameterSet parameters = setup.parameters;
  parameters.water = setup.water;
  const std::vector<ViewControl> controls = ViewControls({.parameters = parameters,
                                                          .sonar = setup.sonar,
                                                          .water = setup.water,
                                                          .material_names = session_.scene().material_names,
                                                          .recorded = setup.real != nullptr});
  Json sonar = {{"name", setup.sonar.name}};
  sonar.update(data_io::MemberJson(SonarAsShown(setup.sonar)));
  return JsonAnswer({{"version", SONARCAL_VERSION},
                     {"scene", setup.scene_path},
                     {"material_names", session_.scene().material_names},
                     {"sonar", std::move(sonar)},
                     {"parameters", data_io::ParametersJson(parameters)},
                     {"controls", ViewControlsJson(controls)},
                     {"fit_options", PageOptionsJson()},
                     {"frames", FramesJson(setup)},
                     {"poses_given", setup.poses_given},
                     {"recorded", RecordedJson(setup)},
                     {"segmentation", ToString(setup.compare.segmentation.method)},
                     {"object", setup.compare.object ? Json(setup.compare.object->material) : Json(nullptr)},
                     {"intensity_domain", ToString(setup.compare.intensity_domain)},
                     {"out", out_.string()},
                     {"colours",
                      {{"inferno", RampJson(data_io::ColorMap::kInferno)},
                       {"viridis", RampJson(data_io::ColorMap::kViridis)}}},
                     {"alike", data_io::kAlikeGrey},
                     {"regions",
                      {ColourJson(data_io::kNeitherColor), ColourJson(data_io::kRealOnlyColor),
                       ColourJson(data_io::kSimulatedOnlyColor), ColourJson(data_io::kBothColor)}}});
}

ViewAnswer ViewApi::MeshOfScene() const {
  return {200, kBytes, MeshFrame(session_.scene())};
}

ViewAnswer ViewApi::Render(std::string_view body) {
  const ViewState state = StateOf(body, session_);
  const std::optional<ViewImage> rendered = session_.Render(state);
  if (!rendered) return {204, {}, {}};
  Json json = ImageJson(rendered->image);
  json["sequence"] = state.sequence;
  json["traced"] = rendered->traced;
  json["milliseconds"] = 1e3 * (rendered->trace_s + rendered->shade_s);
  return {200, kBytes, Framed(Text(json), GreyBytes(rendered->image))};
}

ViewAnswer ViewApi::Recorded(std::string_view body) const {
  if (!session_.setup().real) return Refusal(422, "no recording is shown: start with --real");
  int frame = 0;
  try {
    const data_io::JsonReader json = data_io::JsonReader::FromText(body, "request");
    frame = static_cast<int>(json.At("frame").Integer(0, session_.frame_count() - 1));
    json.Finish();
  } catch (const DataError& error) {
    throw BadRequest(error.what());
  }
  const PolarImage image = session_.Recorded(frame).image;
  Json json = ImageJson(image);
  json["frame"] = frame;
  return {200, kBytes, Framed(Text(json), GreyBytes(image))};
}

ViewAnswer ViewApi::Compare(std::string_view body) {
  if (!session_.setup().real) return Refusal(422, "there is nothing to compare with: start with --real");
  const ViewState state = StateOf(body, session_);
  const ViewComparison comparison = session_.Compare(state);
  Json json =
      Json::parse(metrics::FrameMetricsJson(comparison.metrics, session_.setup().compare.intensity_domain));
  json["sequence"] = state.sequence;
  json["notes_of_all"] = comparison.notes;
  json["nats_per_pixel"] = comparison.nats_per_pixel ? Json(*comparison.nats_per_pixel) : Json(nullptr);
  const metrics::FrameMasks& masks = comparison.metrics.masks.value();
  json["bins"] = masks.polar_real.rows();
  json["beams"] = masks.polar_real.cols();
  return {200, kBytes, Framed(Text(json), RegionBytes(masks))};
}

ViewAnswer ViewApi::Files(std::string_view body) const {
  const ViewFiles files = FilesOf(session_, StateOf(body, session_), {});
  return JsonAnswer({{"files", files.text}, {"command", files.command}});
}

ViewAnswer ViewApi::Save(std::string_view body) {
  const ViewState state = StateOf(body, session_);
  if (out_.empty()) return Refusal(422, "no folder to write into was given: start with --out");
  const ViewFiles files = FilesOf(session_, state, out_.string());
  const std::scoped_lock lock(save_mutex_);
  cli::RunOutput output(out_, "view", force_);
  for (const auto& [name, text] : files.text) data_io::WriteFileWhole(output / name, text);
  const ViewSetup& setup = session_.setup();
  cli::Provenance provenance{.command = "view",
                             .configuration = {{"scene", setup.scene_path},
                                               {"sonar", setup.sonar_argument},
                                               {"noise", state.noise},
                                               {"frame", state.frame},
                                               {"simulate", files.command}},
                             .inputs = setup.inputs};
  if (state.noise) provenance.seed = state.seed;
  cli::WriteProvenance(output.staging(), provenance);
  output.Commit();
  Json names = Json::array();
  for (const auto& [name, text] : files.text) names.push_back(name);
  return JsonAnswer({{"folder", out_.string()}, {"files", names}, {"command", files.command}});
}

ViewAnswer ViewApi::StartFit(std::string_view body) {
  const ViewSetup& setup = session_.setup();
  if (!setup.real) return Refusal(422, "there is nothing to fit to: start with --real");
  ViewState state;
  workflow::FitOptions chosen;
  try {
    const data_io::JsonReader json = data_io::JsonReader::FromText(body, "request");
    json.At("state");
    chosen = ReadPageOptions(json);
    chosen.materials = setup.materials;
    json.Finish();
    // Not as an ordered_json, which takes half a minute to read a request of 100,000 members.
    state = ParseViewState(nlohmann::json::parse(body)["state"].dump(), session_.frame_count());
  } catch (const DataError& error) {
    throw BadRequest(error.what());
  }
  if (state.sonar != SonarChanges()) {
    return Refusal(422, "a fit uses the sonar as recorded: reset its controls first");
  }
  workflow::FitRecordingOptions options{
      .rays = setup.rays,
      .config =
          workflow::ResolveFitConfig(chosen, state.parameters, session_.scene(), session_.frame_count()),
      .fit = {},
      .comparison = setup.compare};
  options.fit.starts = chosen.starts;
  options.fit.max_iterations = chosen.max_iterations;
  options.fit.down_weight = state.parameters.model == EchoModel::kAcoustic;
  options.fit.threads = setup.rays.threads;
  fit_.Start({.real = session_.RecordingOf(state),
              .scene = session_.scene(),
              .initial = state.parameters,
              .options = std::move(options),
              .messages = workflow::MaterialCaveats(chosen.materials, state.parameters, session_.scene(),
                                                    setup.sonar.frequency_hz)});
  return JsonAnswer(fit_.Status());
}

}  // namespace sonarcal::view
