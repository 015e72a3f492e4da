#include "sim/simulator.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/types/units.h"
#include "sim/acoustic/acoustic_frame.h"
#include "sim/ghosts/ghost_power.h"
#include "sim/paper/paper_frame.h"
#include "sim/physics/display.h"

namespace sonarcal::sim {
namespace {

SimulationOptions Checked(SimulationOptions options) {
  options.Check();
  return options;
}

// Highest level of echoes before transmission loss. Single precision ends at 385 dB; the rest is for targets
// nearer than 1 m and for time-varying gain.
constexpr double kMaxEchoDb = 350.0;

// Throws DataError if the power of echoes could overflow. The paper's model has levels in place of powers.
void CheckEchoLevel(const ParameterSet& parameters) {
  if (parameters.model == EchoModel::kPaper) return;
  double strongest = 1.0;
  for (const auto& [name, material] : parameters.materials)
    strongest = std::max(strongest, material.gsab.a + material.gsab.c + material.gsab.e);
  double sensitivity_db = 0.0;
  for (const double of_beam_db : parameters.beam.sensitivity_db)
    sensitivity_db = std::max(sensitivity_db, of_beam_db);
  const double level_db =
      parameters.source_level_db + parameters.receiver.gain_db + DbFromPower(strongest) + sensitivity_db;
  if (!(level_db <= kMaxEchoDb)) {
    throw DataError(
        "source_level_db, receiver.gain_db, the strongest backscatter and the highest beam.sensitivity_db "
        "add up to {:.1f} dB, expected at most {} dB",
        level_db, kMaxEchoDb);
  }
}

}  // namespace

void SimulationOptions::Check() const {
  fan.Check();
  trace.Check();
  GhostOptions{.order = ghost_order}.Check();
  if (bits != 8 && bits != 12 && bits != 16) throw DataError("image of {} bits, expected 8, 12 or 16", bits);
}

Simulator::Simulator(Scene scene, SonarModel sonar, SimulationOptions options)
    : Simulator(std::make_shared<const RayCaster>(std::move(scene)), std::move(sonar), std::move(options)) {}

Simulator::Simulator(std::shared_ptr<const RayCaster> caster, SonarModel sonar, SimulationOptions options)
    : sonar_(std::move(sonar)),
      options_(Checked(std::move(options))),
      caster_(std::move(caster)),
      fan_(sonar_, options_.fan),
      absorption_db_per_m_(AbsorptionDbPerM(options_.absorption, sonar_.frequency_hz, options_.water)) {
  if (!(sonar_.frequency_hz > 0.0)) {
    throw DataError("{}: frequency {} Hz, expected a positive one", sonar_.name, sonar_.frequency_hz);
  }
}

Simulator::~Simulator() = default;

// Reflecting surfaces, and the rays that search for multipath echoes.
struct Simulator::Mirrors {
  std::vector<char> reflects;
  double transmit_end_deg;
  double elevation_span_deg;
  MirrorSurface surface;
  RayFan fan;
};

// Returns null if the scene has no mirror.
std::shared_ptr<const Simulator::Mirrors> Simulator::MirrorsOf(const ParameterSet& parameters,
                                                               int ray_decimation) const {
  if (parameters.mirrors.empty()) return nullptr;
  const std::vector<char> reflects = ReflectingMaterials(caster_->material_names(), parameters);
  if (std::count(reflects.begin(), reflects.end(), 1) == 0) return nullptr;
  const std::scoped_lock lock(shared_mutex_);
  const double end_deg = parameters.beam.transmit_end_deg;
  RayFanOptions decimated = options_.fan;
  decimated.cols = std::max(1, decimated.cols / ray_decimation);
  decimated.rows = std::max(1, decimated.rows / ray_decimation);
  const RayFanOptions rays = GhostFanOptions(decimated, sonar_, parameters.beam);
  std::shared_ptr<const Mirrors>& mirrors = mirrors_[ray_decimation];
  if (!mirrors || mirrors->reflects != reflects || mirrors->transmit_end_deg != end_deg ||
      mirrors->elevation_span_deg != rays.elevation_span_deg) {
    mirrors = std::make_shared<const Mirrors>(Mirrors{reflects, end_deg, rays.elevation_span_deg,
                                                      MirrorSurface(caster_->scene(), reflects),
                                                      RayFan(sonar_, rays)});
  }
  return mirrors;
}

// Keeps the tables of the last parameters, because most calls have the same ones. Makes them without holding
// the lock: a thread that waits in a parallel loop may start another frame, which needs the lock.
std::shared_ptr<const ExpectedFrames> Simulator::ExpectedFramesOf(const ParameterSet& parameters) const {
  {
    const std::scoped_lock lock(shared_mutex_);
    if (expected_frames_ && expected_frames_->parameters() == parameters) return expected_frames_;
  }
  auto made = std::make_shared<const ExpectedFrames>(
      *caster_, fan_, AcousticGeometry{sonar_, absorption_db_per_m_}, parameters, options_.trace);
  const std::scoped_lock lock(shared_mutex_);
  expected_frames_ = made;
  return made;
}

GhostList Simulator::TraceGhosts(const Pose& world_from_sonar, const ParameterSet& parameters,
                                 int ray_decimation) const {
  SONARCAL_CHECK(ray_decimation >= 1, "rays decimated {} times", ray_decimation);
  const std::shared_ptr<const Mirrors> mirrors = MirrorsOf(parameters, ray_decimation);
  if (!mirrors) return {};
  const auto [left_rad, right_rad] = AzimuthsRad(fan_);
  return sonarcal::sim::TraceGhosts(*caster_, mirrors->surface, mirrors->fan, world_from_sonar,
                                    {.order = options_.ghost_order,
                                     .range_min_m = sonar_.axes.range_min_m,
                                     .range_max_m = sonar_.axes.range_max_m,
                                     .heard_left_rad = left_rad,
                                     .heard_right_rad = right_rad});
}

ScatterMap Simulator::Scatter(const EchoList& echoes, const ParameterSet& parameters,
                              const GhostList& ghosts) const {
  const AcousticGeometry geometry{sonar_, absorption_db_per_m_};
  ScatterMap scatter = MakeScatterMap(echoes, fan_, geometry, parameters);
  AddGhosts(ghosts, geometry, parameters, scatter);
  return scatter;
}

EchoList Simulator::TraceEchoes(const Pose& world_from_sonar) const {
  return Trace(*caster_, fan_, world_from_sonar, sonar_.axes, options_.trace);
}

EchoHistogram Simulator::GatherEchoes(const Pose& world_from_sonar) const {
  if (options_.trace.normals == NormalSource::kGeometric)
    return CastEchoHistogram(*caster_, fan_, world_from_sonar, sonar_.axes);
  return sonarcal::sim::GatherEchoes(TraceEchoes(world_from_sonar), sonar_.axes);
}

PolarImage Simulator::Render(const Pose& world_from_sonar, const ParameterSet& parameters,
                             const DrawSeeds& seeds) const {
  CheckEchoLevel(parameters);
  if (parameters.model == EchoModel::kPaper && options_.trace.normals == NormalSource::kGeometric) {
    RefuseMargin();
    PolarImage image = RenderPaperFrame(*caster_, fan_, world_from_sonar, sonar_,
                                        PaperParametersFor(parameters, caster_->material_names()),
                                        absorption_db_per_m_, PaperOptions(seeds.receiver));
    QuantiseImage(image);
    return image;
  }
  if (parameters.model == EchoModel::kPaper) {
    return RenderEchoes(TraceEchoes(world_from_sonar), parameters, seeds, {});
  }
  if (parameters.model == EchoModel::kAcoustic) {
    const AcousticGeometry geometry{sonar_, absorption_db_per_m_};
    const GhostList ghosts = TraceGhosts(world_from_sonar, parameters);
    PolarImage image;
    if (options_.noise) {
      ScatterMap scatter =
          ScatterFrom(*caster_, fan_, world_from_sonar, geometry, parameters, options_.trace);
      AddGhosts(ghosts, geometry, parameters, scatter);
      image = RenderScatter(scatter, parameters, seeds);
    } else {
      const std::shared_ptr<const ExpectedFrames> frames = ExpectedFramesOf(parameters);
      PulsedMap pulsed = frames->Pulsed(world_from_sonar);
      AddGhosts(ghosts, geometry, parameters, pulsed);
      image = frames->Displayed(pulsed, options_.full_scale());
    }
    QuantiseImage(image);
    return image;
  }
  return RenderCoherent(world_from_sonar, {}, parameters, seeds);
}

PolarImage Simulator::RenderPings(const Pose& world_from_sonar, const std::vector<PingPose>& pings,
                                  const ParameterSet& parameters, const DrawSeeds& seeds) const {
  if (pings.empty()) return Render(world_from_sonar, parameters, seeds);
  CheckEchoLevel(parameters);
  if (parameters.model == EchoModel::kCoherent)
    return RenderCoherent(world_from_sonar, pings, parameters, seeds);
  if (parameters.model == EchoModel::kPaper || !options_.noise) {
    return RenderByPing(world_from_sonar, pings,
                        [&](const Pose& pose) { return Render(pose, parameters, seeds); });
  }
  const AcousticGeometry geometry{sonar_, absorption_db_per_m_};
  PolarImage image;
  for (std::size_t ping = 0; ping < pings.size(); ++ping) {
    const Pose pose = world_from_sonar * pings[ping].frame_from_ping;
    ScatterMap scatter = ScatterFrom(*caster_, fan_, pose, geometry, parameters, options_.trace);
    AddGhosts(TraceGhosts(pose, parameters), geometry, parameters, scatter);
    PolarImage of_ping = SampleAcousticImage(scatter, geometry, parameters, options_.full_scale(),
                                             SeedsOfPing(seeds, ping), pings[ping].frame_from_ping);
    if (ping == 0) {
      image = std::move(of_ping);
    } else {
      CopyBeams(pings[ping].beams, of_ping.value, image.value);
    }
  }
  QuantiseImage(image);
  return image;
}

// The fan with a margin for what the pings see beyond that of the frame.
RayFan Simulator::FanOfPings(const std::vector<PingPose>& pings) const {
  constexpr double kMaxMarginDeg = 60.0;
  constexpr double kNearestM = 0.1;
  double turn_rad = 0.0;
  for (const PingPose& ping : pings) {
    const Pose& move = ping.frame_from_ping;
    const double aside_m = move.position_m.norm();
    turn_rad = std::max(turn_rad, move.rotation.angularDistance(Eigen::Quaterniond::Identity()) +
                                      std::atan2(aside_m, std::max(sonar_.axes.range_min_m, kNearestM)));
  }
  RayFanOptions options = options_.fan;
  options.azimuth_margin_deg = std::min(kMaxMarginDeg, options.azimuth_margin_deg + DegFromRad(turn_rad));
  return {sonar_, options};
}

PolarImage Simulator::RenderCoherent(const Pose& world_from_sonar, const std::vector<PingPose>& pings,
                                     const ParameterSet& parameters, const DrawSeeds& seeds) const {
  std::optional<RayFan> wider;
  if (!pings.empty()) wider = FanOfPings(pings);
  CoherentGeometry geometry{.caster = *caster_,
                            .fan = wider ? *wider : fan_,
                            .sonar = sonar_,
                            .absorption_db_per_m = absorption_db_per_m_,
                            .ghost_order = options_.ghost_order,
                            .point_targets = options_.point_targets};
  const std::shared_ptr<const Mirrors> mirrors = MirrorsOf(parameters);
  if (mirrors) {
    geometry.mirrors = &mirrors->surface;
    geometry.ghost_fan = &mirrors->fan;
  }
  const PolarImage power = pings.empty()
                               ? CoherentPower(geometry, world_from_sonar, parameters, seeds)
                               : CoherentPower(geometry, world_from_sonar, pings, parameters, seeds);
  PolarImage image = DisplayPower(power, parameters, options_.full_scale());
  QuantiseImage(image);
  return image;
}

DrawSeeds Simulator::SeedsOf(int frame_idx, int speckle_idx) const {
  const auto seed_of = [&](int index) { return options_.seed + static_cast<std::uint64_t>(index); };
  return {.scatterers = seed_of(options_.frozen_speckle ? speckle_idx : frame_idx),
          .receiver = seed_of(frame_idx)};
}

PaperImageOptions Simulator::PaperOptions(std::uint64_t seed) const {
  PaperImageOptions options{.full_scale = options_.full_scale(), .noise_seed = {}};
  if (options_.noise) options.noise_seed = seed;
  return options;
}

// A ray of the margin would count as a ray of the outer beam.
void Simulator::RefuseMargin() const {
  if (options_.fan.azimuth_margin_deg > 0.0) {
    throw DataError("rays: the paper model takes no azimuth margin, but it is {} degrees",
                    options_.fan.azimuth_margin_deg);
  }
}

PolarImage Simulator::RenderEchoes(const EchoList& echoes, const ParameterSet& parameters,
                                   const DrawSeeds& seeds, const GhostList& ghosts) const {
  SONARCAL_CHECK(parameters.model != EchoModel::kCoherent, "a coherent image is made from a pose");
  CheckEchoLevel(parameters);
  PolarImage image;
  if (parameters.model == EchoModel::kPaper) {
    RefuseMargin();
    image = RenderPaperImage(echoes, sonar_, PaperParametersFor(parameters, echoes.material_names),
                             absorption_db_per_m_, PaperOptions(seeds.receiver));
  } else {
    image = RenderScatter(Scatter(echoes, parameters, ghosts), parameters, seeds);
  }
  QuantiseImage(image);
  return image;
}

// Speckled sample if noise is on, otherwise the expected image.
PolarImage Simulator::RenderScatter(const ScatterMap& scatter, const ParameterSet& parameters,
                                    const DrawSeeds& seeds) const {
  const AcousticGeometry geometry{sonar_, absorption_db_per_m_};
  if (options_.noise) {
    return SampleAcousticImage(scatter, geometry, parameters, options_.full_scale(), seeds);
  }
  return ExpectedDisplay(ExpectedPower(scatter, geometry, parameters), parameters, options_.full_scale());
}

PolarImage Simulator::RenderExpected(const EchoList& echoes, const ParameterSet& parameters,
                                     const GhostList& ghosts) const {
  CheckEchoLevel(parameters);
  if (parameters.model != EchoModel::kPaper) {
    const AcousticGeometry geometry{sonar_, absorption_db_per_m_};
    ParameterSet of_beams = parameters;
    if (parameters.model == EchoModel::kCoherent)  // its samples always come from an array
      of_beams.beam.azimuth_pattern = AzimuthPattern::kAperture;
    const PolarImage power = ExpectedPower(Scatter(echoes, parameters, ghosts), geometry, of_beams);
    return ExpectedDisplay(power, parameters, options_.full_scale());
  }
  RefuseMargin();
  const std::vector<double> values = ExpectedPaperImage(
      sonarcal::sim::GatherEchoes(echoes, sonar_.axes), ImageGeometry(sonar_, absorption_db_per_m_),
      PaperParametersFor(parameters, echoes.material_names));
  PolarImage image{sonar_.axes, GreyScale(parameters.display, options_.full_scale()),
                   Grid<float>(sonar_.axes.range_bins, sonar_.axes.beam_count())};
  for (std::size_t i = 0; i < values.size(); ++i) {
    image.value.values()[i] = static_cast<float>(values[i] * options_.full_scale());
  }
  return image;
}

}  // namespace sonarcal::sim
