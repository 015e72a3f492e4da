#include "apps/ray_options.h"

#include <tbb/global_control.h>

#include <algorithm>
#include <charconv>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "apps/choice_option.h"
#include "core/types/error.h"
#include "core/types/printable.h"
#include "data_io/parameters/parameters_io.h"
#include "sim/rays/acoustic_fan.h"
#include "sim/rays/paper_fan.h"

namespace sonarcal {
namespace {

constexpr JsonWords<Sampling, 2> kSamplings = {
    {{"frustum", Sampling::kFrustum}, {"beams", Sampling::kBeams}}};
constexpr JsonWords<RayWeight, 2> kWeights = {
    {{"even", RayWeight::kEven}, {"solid_angle", RayWeight::kSolidAngle}}};
constexpr JsonWords<NormalSource, 2> kNormals = {
    {{"geometric", NormalSource::kGeometric}, {"depth", NormalSource::kDepth}}};
constexpr JsonWords<AbsorptionFormula, 3> kAbsorptions = {
    {{"auto", AbsorptionFormula::kAuto},
     {"ainslie-mccolm", AbsorptionFormula::kAinslieMcColm},
     {"francois-garrison", AbsorptionFormula::kFrancoisGarrison}}};

constexpr RayGridSize kFrustumRays = {1500, 1200};  // the paper's
constexpr double kWidestFrustumDeg = 120.0;         // in elevation

// Other models want columns that stand alike, and have rays of their own (sim/rays/acoustic_fan.h); where
// `beams` are asked of them by name, these.
constexpr int kOtherColumnsPerBeam = 2;
constexpr int kOtherBeamRows = 400;

// A positive whole number that is all of `text`.
std::optional<int> ParseCount(std::string_view text) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < 1) return std::nullopt;
  return value;
}

// RayFan casts more columns than requested, because a beam without a ray would be dark.
void CheckColumns(const RayFanOptions& fan, const SonarModel& sonar, const std::string& rays) {
  const int beams = sonar.axes.beam_count();
  if (rays.empty() || fan.sampling != Sampling::kBeams || fan.cols >= beams) return;
  throw UsageError(
      "--rays {} has fewer columns than the {} beams of the sonar, expected at least {}, best a multiple of "
      "it, or "
      "--sampling frustum",
      rays, beams, beams);
}

}  // namespace

RayGridSize ParseRayGridSize(const std::string& text) {
  const std::string_view view = text;
  const std::size_t cross = view.find('x');
  if (cross != std::string_view::npos) {
    const auto cols = ParseCount(view.substr(0, cross));
    const auto rows = ParseCount(view.substr(cross + 1));
    if (cols && rows) return {*cols, *rows};
  }
  throw UsageError("rays '{}', expected WIDTHxHEIGHT such as 1500x1200", Printable(text));
}

Sampling RayOptions::SamplingFor(EchoModel model) const {
  return sampling.value_or(model == EchoModel::kPaper ? Sampling::kBeams : Sampling::kFrustum);
}

SimulationOptions RayOptions::For(const SonarModel& sonar, const Water& water, EchoModel model) const {
  SimulationOptions options;
  options.fan = {.sampling = SamplingFor(model), .cols = kFrustumRays.cols, .rows = kFrustumRays.rows};
  if (options.fan.sampling == Sampling::kBeams) {
    options.fan = PaperFanOptions(sonar);
    if (model != EchoModel::kPaper) {
      options.fan = {.sampling = Sampling::kBeams,
                     .cols = kOtherColumnsPerBeam * sonar.axes.beam_count(),
                     .rows = kOtherBeamRows};
    }
  }
  if (!rays.empty()) {
    const RayGridSize grid = ParseRayGridSize(rays);
    options.fan.cols = grid.cols;
    options.fan.rows = grid.rows;
  }
  CheckColumns(options.fan, sonar, rays);
  options.fan.weight = weight;
  options.trace.normals = normals;
  options.absorption = absorption;
  options.water = water;
  return options;
}

SimulationOptions RayOptions::For(const SonarModel& sonar, const Water& water,
                                  const ParameterSet& parameters) const {
  SimulationOptions options = For(sonar, water, parameters.model);
  if (parameters.model == EchoModel::kPaper) return options;
  const RayFanOptions asked = options.fan;
  options.fan = AcousticFanOptions(sonar, parameters);
  if (!rays.empty()) {
    options.fan.cols = asked.cols;
    options.fan.rows = asked.rows;
  }
  if (sampling == Sampling::kFrustum) {
    options.fan = {.cols = asked.cols,
                   .rows = asked.rows,
                   .elevation_span_deg = std::min(options.fan.elevation_span_deg, kWidestFrustumDeg),
                   .azimuth_margin_deg = options.fan.azimuth_margin_deg};
  }
  CheckColumns(options.fan, sonar, rays);
  return options;
}

void AddRayOptions(CLI::App& command, RayOptions& options) {
  const std::string by_default(ToString(options.sampling.value_or(Sampling::kBeams)));
  AddChoice(
      command, "--sampling", options.sampling, kSamplings,
      "How rays are spread: a pinhole grid as in the paper, or equal angles within each beam (default: " +
          by_default + ")");
  command
      .add_option(
          "--rays", options.rays,
          fmt::format("Columns x rows of rays over the field of view (default: {}x{} for frustum, {} a "
                      "beam x {} for beams, whose columns the paper's model staggers; for the other models' "
                      "beams, rays by their shape)",
                      kFrustumRays.cols, kFrustumRays.rows, kPaperColumnsPerBeam, kPaperBeamRows))
      ->type_name("WxH");
  AddRayWeight(command, options.weight);
  AddChoice(command, "--normals", options.normals, kNormals,
            "Surface normals: of the mesh, or by differences of the depth image as in the paper");
  AddAbsorption(command, options.absorption);
  command.add_option("--threads", options.threads, "Threads to use, 0 for all cores")
      ->type_name("N")
      ->check(CLI::Range(0, 1024).description(""));
}

void AddRayWeight(CLI::App& command, RayWeight& weight) {
  AddChoice(command, "--ray-weight", weight, kWeights,
            "What a ray of the paper's model counts: each of a beam alike, as in the paper, or by its solid "
            "angle, by which both samplings come to one image");
}

void AddAbsorption(CLI::App& command, AbsorptionFormula& absorption) {
  AddChoice(command, "--absorption", absorption, kAbsorptions,
            "Formula for absorption in water: the paper's (ainslie-mccolm), francois-garrison, or auto: the "
            "paper's where its limits hold, else francois-garrison");
}

void AddReachOptions(CLI::App& command, int& ghost_order, std::optional<double>& margin_deg) {
  command
      .add_option("--ghost-order", ghost_order,
                  "Reflections by the parameters' mirrors that are followed on one leg: 1 or 2")
      ->type_name("N")
      ->check(CLI::IsMember({1, 2}).description(""));
  command
      .add_option("--margin", margin_deg,
                  "Azimuth cast beyond the outer beams, degrees (default: 0 for paper, else 3 beam widths, "
                  "20 at most)")
      ->type_name("DEG");
}

void CheckRayWeight(RayWeight weight, EchoModel model) {
  if (weight == RayWeight::kEven || model == EchoModel::kPaper) return;
  throw UsageError("--ray-weight {} is for the paper's model: '{}' takes solid angles in any case",
                   ToString(weight), ToString(model));
}

std::string RaysNote(const RayOptions& options, const Simulator& simulator) {
  const RayFan& fan = simulator.fan();
  if (options.rays.empty() || fan.sampling() != Sampling::kBeams) return {};
  const int asked = ParseRayGridSize(options.rays).cols;
  const int beams = simulator.sonar().axes.beam_count();
  const int within = (asked + beams - 1) / beams * beams;
  if (within == asked) return {};
  return fmt::format("--rays {} becomes {}x{}: each of the {} beams takes {} whole columns", options.rays,
                     within, fan.rows(), beams, within / beams);
}

std::string_view ToString(Sampling sampling) {
  return JsonWord(kSamplings, sampling);
}

std::string_view ToString(RayWeight weight) {
  return JsonWord(kWeights, weight);
}

std::string_view ToString(NormalSource normals) {
  return JsonWord(kNormals, normals);
}

std::string_view ToString(AbsorptionFormula formula) {
  return JsonWord(kAbsorptions, formula);
}

nlohmann::ordered_json RayOptionsJson(const RayOptions& options, const RayGridSize& grid) {
  return {
      {"sampling", ToString(options.sampling.value())}, {"rays", fmt::format("{}x{}", grid.cols, grid.rows)},
      {"ray_weight", ToString(options.weight)},         {"normals", ToString(options.normals)},
      {"absorption", ToString(options.absorption)},     {"threads", options.threads}};
}

struct ThreadLimit::Control {
  explicit Control(int threads)
      : parallelism(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads)) {}
  tbb::global_control parallelism;
};

ThreadLimit::ThreadLimit(int threads) {
  if (threads > 0) control_ = std::make_unique<Control>(threads);
}

ThreadLimit::~ThreadLimit() = default;

}  // namespace sonarcal
