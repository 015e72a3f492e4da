#include "apps/reproduce/case_plan.h"

#include <dlfcn.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdlib>

#include "apps/reproduce/case_scene.h"
#include "core/text/nearest_word.h"
#include "core/types/error.h"
#include "core/types/units.h"
#include "data_io/json/json_fields.h"
#include "data_io/json/json_reader.h"
#include "data_io/parameters/parameters_io.h"
#include "data_io/pictures/picture_geometry.h"
#include "sim/scenes/sonar_presets.h"

namespace sonarcal::reproduce {
namespace {

namespace fs = std::filesystem;
using data_io::JsonReader;
using data_io::NumberRange;

constexpr std::string_view kFormat = "sonar-case/1";
constexpr const char* kPlanFile = "case.json";
constexpr int kMaxFrames = 100'000;
const NumberRange kAngleDeg = NumberRange::Between(-360.0, 360.0);
const NumberRange kWidthDeg = NumberRange::AboveUpTo(0.0, 180.0);
const NumberRange kRatio = NumberRange::Between(0.0, 1e3);
const NumberRange kTolerance = NumberRange::AboveUpTo(0.0, 1.0);

int ReadCount(const JsonReader& json, int min, int max) {
  return static_cast<int>(json.Integer(min, max));
}

ParameterSet ReadStart(const JsonReader& json, const fs::path& folder, EchoModel model) {
  ParameterSet start = data_io::ReadParameters(folder / ReadPathBelow(json));
  if (start.model != model) {
    json.Fail(fmt::format("has the model '{}', expected '{}'", ToString(start.model), ToString(model)));
  }
  return start;
}

std::pair<double, double> ReadBounds(const JsonReader& json) {
  const std::vector<double> bounds = json.Numbers(kWidthDeg);
  if (bounds.size() != 2 || !(bounds[1] > bounds[0])) json.Fail("must be two numbers, the smaller first");
  return {bounds[0], bounds[1]};
}

calib::TargetPose ReadTargetPose(const JsonReader& json) {
  const auto angle_rad = [&](const char* key) { return RadFromDeg(json.At(key).Number(kAngleDeg)); };
  return {.range_m = json.At("range_m").Number(NumberRange::AboveUpTo(0.0, 1e4)),
          .azimuth_rad = angle_rad("azimuth_deg"),
          .elevation_rad = angle_rad("elevation_deg"),
          .yaw_rad = angle_rad("yaw_deg"),
          .pitch_rad = angle_rad("pitch_deg")};
}

calib::TargetFitOptions ReadTargetFit(const JsonReader& json) {
  calib::TargetFitOptions options;
  options.free_pose = false;
  options.fit.starts = ReadCount(json.At("starts"), 1, 100);
  options.fit.function_tolerance = json.At("function_tolerance").Number(kTolerance);
  std::tie(options.beam_width_min_deg, options.beam_width_max_deg) = ReadBounds(json.At("azimuth_width_deg"));
  std::tie(options.elevation_width_min_deg, options.elevation_width_max_deg) =
      ReadBounds(json.At("elevation_width_deg"));
  options.pulse_max_bins = json.At("pulse_max_bins").Number(NumberRange::Between(1.0, 1000.0));
  return options;
}

TargetCase::OtherView ReadOtherView(const JsonReader& json) {
  return {.picture = ReadPathBelow(json.At("picture")),
          .fan = data_io::ReadFanGeometry(json.At("fan")),
          .db_span = json.At("db_span").Number(NumberRange::AboveUpTo(0.0, 1000.0)),
          .start = ReadTargetPose(json.At("start_pose"))};
}

TargetCase ReadTarget(const JsonReader& json, const fs::path& folder) {
  TargetCase target;
  target.recording = ReadPathBelow(json.At("recording"));
  target.fitted_frame = ReadCount(json.At("fitted_frame"), 0, kMaxFrames);
  target.held_out_frame = ReadCount(json.At("held_out_frame"), 0, kMaxFrames);
  if (target.held_out_frame == target.fitted_frame)
    json.At("held_out_frame").Fail("is fitted_frame, expected another frame");
  if (const auto water = json.Find("water")) target.water = data_io::ReadWater(*water);
  target.azimuth_beam_width_deg = json.At("azimuth_beam_width_deg").Number(kWidthDeg);
  target.elevation_span_deg = json.At("elevation_span_deg").Number(kWidthDeg);
  target.scene = ReadCaseScene(json.At("scene"), folder);
  target.pose = ReadTargetPose(json.At("pose"));
  target.start = ReadStart(json.At("start"), folder, EchoModel::kAcoustic);
  target.fit = ReadTargetFit(json.At("fit"));
  target.fit.elevation_span_deg = target.elevation_span_deg;
  if (const auto method = json.Find("segmentation"))
    target.segmentation.method = method->Word<metrics::SegmentationMethod>();
  if (const auto other = json.Find("other_view")) target.other = ReadOtherView(*other);
  const JsonReader report = json.At("report");
  target.heading = report.At("heading").String();
  target.about = report.At("about").String();
  target.limit = report.At("limit").String();
  return target;
}

MarkedSurfaceCase ReadMarkedSurface(const JsonReader& json, const fs::path& folder) {
  MarkedSurfaceCase surface;
  surface.recording = ReadPathBelow(json.At("recording"));
  surface.pings = ReadPathBelow(json.At("pings"));
  surface.background = ReadPathBelow(json.At("background"));
  surface.marks = ReadPathBelow(json.At("marks"));
  surface.marks_suffix = json.At("marks_suffix").String();
  surface.frames_used = ReadCount(json.At("frames_used"), 1, kMaxFrames);
  surface.frames_held_out = ReadCount(json.At("frames_held_out"), 1, kMaxFrames);
  surface.blind_bins = ReadCount(json.At("blind_bins"), 0, kMaxFrames);
  surface.apart_m = json.At("apart_m").Number(NumberRange::AboveUpTo(0.0, 1e6));
  const JsonReader leans = json.At("leans_deg");
  surface.leans_deg = leans.Numbers(NumberRange::Between(0.0, 80.0));
  if (surface.leans_deg.empty() || !std::is_sorted(surface.leans_deg.begin(), surface.leans_deg.end()))
    leans.Fail("must be one or more angles in rising order");
  surface.material = json.At("material").String();
  const JsonReader start = json.At("start");
  surface.start = ReadStart(start, folder, EchoModel::kAcoustic);
  if (!surface.start.materials.contains(surface.material))
    start.Fail(fmt::format("has no material '{}'", surface.material));
  surface.segmentation = json.At("segmentation").Word<metrics::SegmentationMethod>();
  return surface;
}

SyntheticCase::DataSet ReadDataSet(const JsonReader& json, const sim::Environment& environment) {
  if (environment.pose_sets == 0)
    json.Fail(fmt::format("needs poses, which the environment '{}' does not have", environment.name));
  const JsonReader published = json.At("published");
  const auto figure = [&](const char* key) { return published.At(key).Number(kRatio); };
  return {.pose_set = ReadCount(json.At("pose_set"), 1, environment.pose_sets),
          .ns_over_nr = figure("ns_over_nr"),
          .na_over_ns = figure("na_over_ns"),
          .na_over_nr = figure("na_over_nr"),
          .intensity_fan = figure("intensity_error_fan"),
          .intensity_polar = figure("intensity_error_polar"),
          .simulation_time_s = figure("simulation_time_s")};
}

SyntheticCase ReadSynthetic(const JsonReader& json, const fs::path& folder) {
  SyntheticCase synthetic;
  const JsonReader sonar = json.At("sonar");
  synthetic.sonar = sonar.String();
  FindNamed(sonar, sim::FindSonarPreset);
  std::tie(synthetic.environment, synthetic.scene) = ReadEnvironment(json.At("scene"));
  synthetic.text_scene = ReadEnvironment(json.At("text_scene")).second;
  synthetic.truth = ReadStart(json.At("truth"), folder, EchoModel::kCoherent);
  synthetic.acoustic_start = ReadStart(json.At("start"), folder, EchoModel::kAcoustic);
  synthetic.object_material = json.At("object_material").String();
  const JsonReader recorder = json.At("recorder");
  synthetic.recorder_cols_per_beam = ReadCount(recorder.At("cols_per_beam"), 1, 1000);
  synthetic.recorder_rows = ReadCount(recorder.At("rows"), 1, 100'000);
  const JsonReader fit = json.At("fit");
  synthetic.max_iterations = ReadCount(fit.At("max_iterations"), 1, 100'000);
  synthetic.function_tolerance = fit.At("function_tolerance").Number(kTolerance);
  for (const JsonReader& frame : json.At("fitted_frames").Items())
    synthetic.fitted_frames.push_back(ReadCount(frame, 0, kMaxFrames));
  const JsonReader data_sets = json.At("data_sets");
  for (const JsonReader& data_set : data_sets.Items())
    synthetic.data_sets.push_back(ReadDataSet(data_set, *synthetic.environment));
  if (synthetic.data_sets.empty()) data_sets.Fail("is empty, expected at least one data set");
  const JsonReader report = json.At("report");
  synthetic.heading = report.At("heading").String();
  synthetic.about = report.At("about").String();
  synthetic.stand_in = report.At("stand_in").String();
  for (const JsonReader& shown : report.At("also_shown").Items())
    synthetic.also_shown.emplace_back(shown.At("title").String(), ReadPathBelow(shown.At("path")));
  return synthetic;
}

decltype(CasePlan::study) ReadStudy(const JsonReader& json, const fs::path& folder) {
  const auto target = json.Find("target");
  const auto surface = json.Find("marked_surface");
  const auto synthetic = json.Find("synthetic");
  if (static_cast<int>(target.has_value()) + static_cast<int>(surface.has_value()) +
          static_cast<int>(synthetic.has_value()) !=
      1)
    json.Fail("needs exactly one of target, marked_surface, synthetic");
  if (target) return ReadTarget(*target, folder);
  if (surface) return ReadMarkedSurface(*surface, folder);
  return ReadSynthetic(*synthetic, folder);
}

// First candidate that is a folder; empty if none is.
fs::path FirstFolder(const std::vector<fs::path>& candidates) {
  std::error_code error;
  for (const fs::path& candidate : candidates) {
    if (fs::is_directory(candidate, error)) return candidate;
  }
  return {};
}

// Folder of the file that holds this code: the program, or the Python module. The root folder if it is not
// known.
fs::path FolderOfThisCode() {
  Dl_info info{};
  if (dladdr(reinterpret_cast<const void*>(&FolderOfThisCode), &info) == 0) return "/";
  std::error_code error;
  const fs::path file = fs::canonical(info.dli_fname, error);
  return error ? fs::path("/") : file.parent_path();
}

}  // namespace

CasePlan ReadCase(const fs::path& folder) {
  const JsonReader json = JsonReader::FromFile(folder / kPlanFile);
  json.CheckFormat(kFormat);
  CasePlan plan;
  plan.name = folder.filename().string();
  plan.folder = folder;
  plan.title = json.At("title").String();
  plan.label = json.At("label").String();
  for (const JsonReader& known : json.At("known").Items())
    plan.known.push_back({known.At("what").String(), known.At("source").String()});
  for (const JsonReader& caveat : json.At("caveats").Items()) plan.caveats.push_back(caveat.String());
  plan.study = ReadStudy(json, folder);
  json.Finish();
  return plan;
}

fs::path CasesFolder() {
  const char* variable = std::getenv("SONARCAL_CASES");
  if (variable != nullptr && *variable != '\0') {
    fs::path folder = variable;
    if (!fs::is_directory(folder)) throw DataError("SONARCAL_CASES: {}: no such folder", folder.string());
    return folder;
  }
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  // A Python package that pip installed brings the cases in its own folder.
  fs::path found = FirstFolder({program.parent_path().parent_path() / "share/sonarcal/cases",
                                FolderOfThisCode() / "share/sonarcal/cases", SONARCAL_SOURCE_CASES,
                                SONARCAL_INSTALLED_CASES});
  if (found.empty()) {
    throw DataError("no cases are found, neither in {} nor in {}; SONARCAL_CASES says where they are",
                    SONARCAL_SOURCE_CASES, SONARCAL_INSTALLED_CASES);
  }
  return found;
}

std::vector<std::string> CaseNames(const fs::path& cases) {
  std::vector<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(cases)) {
    if (fs::exists(entry.path() / kPlanFile)) names.push_back(entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

CasePlan FindCase(std::string_view name) {
  std::string folder(name);
  std::replace(folder.begin(), folder.end(), '-', '_');
  const fs::path cases = CasesFolder();
  const std::vector<std::string> names = CaseNames(cases);
  if (std::find(names.begin(), names.end(), folder) == names.end())
    throw UsageError("unknown case '{}'{}", name,
                     ExpectedWord(name, names, fmt::format("{}", fmt::join(names, "|"))));
  return ReadCase(cases / folder);
}

std::vector<std::string> KnownSentences(const CasePlan& plan) {
  std::vector<std::string> sentences;
  for (const KnownBeforehand& known : plan.known)
    sentences.push_back(fmt::format("{}: {}", known.what, known.source));
  return sentences;
}

}  // namespace sonarcal::reproduce
