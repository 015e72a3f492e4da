#include "apps/workflow/rays/ray_options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "core/types/error.h"
#include "core/types/option_text.h"
#include "sim/rays/acoustic_fan.h"
#include "sim/rays/paper_fan.h"

namespace sonarcal::workflow {

namespace {

constexpr double kWidestFrustumDeg = 120.0;  // in elevation

// Rays of the other models if `beams` are requested by name. These models need columns that stand alike, and
// by default have a fan of their own (sim/rays/acoustic_fan.h).
constexpr int kOtherColumnsPerBeam = 2;
constexpr int kOtherBeamRows = 400;

// RayFan casts more columns than requested, because a beam without a ray would be dark.
void CheckColumns(const sim::RayFanOptions& fan, const SonarModel& sonar,
                  const std::optional<RayGridSize>& rays) {
  const int beams = sonar.axes.beam_count();
  if (!rays && fan.cols > sim::RayFanOptions::kMaxCols) {
    throw DataError("{} beams need {} columns of rays, expected at most {}: give fewer with --rays", beams,
                    fan.cols, sim::RayFanOptions::kMaxCols);
  }
  if (!rays || fan.sampling != sim::Sampling::kBeams || fan.cols >= beams) return;
  throw UsageError(
      "--rays {}x{} has fewer columns than the {} beams of the sonar, "
      "expected at least {}, best a multiple of it, or --sampling frustum",
      rays->cols, rays->rows, beams, beams);
}

}  // namespace

sim::Sampling RayOptions::SamplingFor(EchoModel model) const {
  return sampling.value_or(model == EchoModel::kPaper ? sim::Sampling::kBeams : sim::Sampling::kFrustum);
}

sim::SimulationOptions RayOptions::For(const SonarModel& sonar, const Water& water, EchoModel model) const {
  sim::SimulationOptions options;
  options.fan = {.sampling = SamplingFor(model), .cols = kFrustumRays.cols, .rows = kFrustumRays.rows};
  if (options.fan.sampling == sim::Sampling::kBeams) {
    options.fan = sim::PaperFanOptions(sonar);
    if (model != EchoModel::kPaper) {
      options.fan = {.sampling = sim::Sampling::kBeams,
                     .cols = kOtherColumnsPerBeam * sonar.axes.beam_count(),
                     .rows = kOtherBeamRows};
    }
  }
  if (rays) {
    options.fan.cols = rays->cols;
    options.fan.rows = rays->rows;
  }
  CheckColumns(options.fan, sonar, rays);
  options.fan.weight = weight();
  options.trace.normals = normals;
  options.absorption = absorption;
  options.water = water;
  return options;
}

sim::SimulationOptions RayOptions::For(const SonarModel& sonar, const Water& water,
                                       const ParameterSet& parameters) const {
  sim::SimulationOptions options = For(sonar, water, parameters.model);
  if (parameters.model == EchoModel::kPaper) return options;
  const sim::RayFanOptions asked = options.fan;
  options.fan = sim::AcousticFanOptions(sonar, parameters);
  if (rays) {
    options.fan.cols = asked.cols;
    options.fan.rows = asked.rows;
  }
  if (sampling == sim::Sampling::kFrustum) {
    options.fan = {.cols = asked.cols,
                   .rows = asked.rows,
                   .elevation_span_deg = std::min(options.fan.elevation_span_deg, kWidestFrustumDeg),
                   .azimuth_margin_deg = options.fan.azimuth_margin_deg};
  }
  CheckColumns(options.fan, sonar, rays);
  return options;
}

void CheckRayWeight(std::optional<sim::RayWeight> weight, EchoModel model) {
  if (!weight || *weight == sim::RayWeight::kEven || model == EchoModel::kPaper) return;
  throw UsageError("--ray-weight {} is for the paper's model: '{}' always uses solid angles",
                   ToString(*weight), ToString(model));
}

std::string RaysNote(const RayOptions& options, const sim::Simulator& simulator) {
  const sim::RayFan& fan = simulator.fan();
  if (!options.rays || fan.sampling() != sim::Sampling::kBeams) return {};
  const int asked = options.rays->cols;
  const int beams = simulator.sonar().axes.beam_count();
  const int within = (asked + beams - 1) / beams * beams;
  if (within == asked) return {};
  return fmt::format("--rays {}x{} becomes {}x{}: each of the {} beams takes {} whole columns",
                     options.rays->cols, options.rays->rows, within, fan.rows(), beams, within / beams);
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

namespace {

// Value of a detail, as SimulatedRecordingInfo (apps/workflow/simulate.h) writes it. Empty: none.
std::string Detail(const RecordingInfo& info, const std::string& name) {
  for (const auto& [key, value] : info.details) {
    if (key == name) return value;
  }
  return {};
}

struct StatedRays {
  sim::Sampling sampling = sim::Sampling::kFrustum;
  sim::RayWeight weight = sim::RayWeight::kEven;
  RayGridSize grid;
};

// Parses details such as "1500x1200, frustum" and "even".
std::optional<StatedRays> Stated(const RecordingInfo& info) {
  if (!info.synthetic || Detail(info, "model") != "paper") return std::nullopt;
  const std::string text = Detail(info, "rays");
  const std::size_t comma = text.find(", ");
  if (comma == std::string::npos) return std::nullopt;
  const std::string word = text.substr(comma + 2, text.find(',', comma + 1) - comma - 2);
  StatedRays stated;
  if (!OptionText<RayGridSize>::Parse(text.substr(0, comma), stated.grid)) return std::nullopt;
  bool known = false;
  for (const sim::Sampling sampling : {sim::Sampling::kFrustum, sim::Sampling::kBeams}) {
    if (word != ToString(sampling)) continue;
    stated.sampling = sampling;
    known = true;
  }
  if (Detail(info, "ray weight") == ToString(sim::RayWeight::kSolidAngle))
    stated.weight = sim::RayWeight::kSolidAngle;
  return known ? std::optional(stated) : std::nullopt;
}

}  // namespace

RaysForFit ChooseRays(const RayOptions& asked, const RecordingInfo& info, EchoModel model) {
  RaysForFit choice{.rays = asked, .note = {}, .warning = {}};
  if (model != EchoModel::kPaper) return choice;
  RayOptions& rays = choice.rays;
  const auto stated = Stated(info);
  if (!stated) {
    rays.sampling = asked.SamplingFor(model);
    return choice;
  }
  std::vector<std::string> taken;
  if (!asked.sampling) {
    rays.sampling = stated->sampling;
    if (!asked.rays) {
      rays.rays = stated->grid;
      taken.push_back(OptionText<RayGridSize>::Format(stated->grid));
    }
    taken.emplace_back(ToString(stated->sampling));
  }
  if (!asked.ray_weight) {
    rays.ray_weight = stated->weight;
    taken.push_back(fmt::format("weight {}", ToString(stated->weight)));
  }
  if (!taken.empty())
    choice.note = fmt::format("rays as the recording states its own: {}", fmt::join(taken, ", "));
  if (*rays.sampling != stated->sampling || *rays.ray_weight != stated->weight) {
    choice.warning = fmt::format(
        "the recording was simulated with {} rays of weight {}, but the fit casts {} rays of weight {}: "
        "their images differ, and fitted values are biased by more than their standard errors (without "
        "--sampling and --ray-weight, the fit takes the recording's)",
        ToString(stated->sampling), ToString(stated->weight), ToString(*rays.sampling),
        ToString(*rays.ray_weight));
  }
  return choice;
}

}  // namespace sonarcal::workflow
