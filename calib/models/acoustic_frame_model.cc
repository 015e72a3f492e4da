#include "calib/models/acoustic_frame_model.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "calib/models/coarse_frame_model.h"
#include "calib/models/down_weight.h"
#include "calib/models/ping_echoes.h"
#include "calib/parameters/placement_steps.h"
#include "calib/parameters/pose_step.h"
#include "core/imaging/saturation.h"
#include "core/math/pose_groups.h"
#include "core/types/error.h"
#include "core/types/units.h"
#include "sim/acoustic/acoustic_frame.h"
#include "sim/ghosts/ghost_power.h"
#include "sim/physics/beam_and_pulse.h"
#include "sim/physics/receiver.h"

namespace sonarcal::calib {
namespace {

// Half the step of the central differences of echoes.
double DifferenceStep(const CatalogEntry& entry, double value, const PolarAxes& axes) {
  constexpr double kOfWidth = 0.03;
  return IsPlacement(entry) ? PlacementDifference(axes, entry) : kOfWidth * value;
}

sim::AcousticGeometry GeometryWith(const sim::Simulator& simulator) {
  return {simulator.sonar(), simulator.absorption_db_per_m()};
}

// Ghosts are traced this factor beyond the angle of the transmitter, so that a larger angle needs no new
// trace.
constexpr double kTransmitReach = 1.3;
constexpr double kTransmitGridDeg = 5.0;  // step of the azimuth margin of the ghosts' fan of rays

// Evaluation of echoes that nothing else keeps.
class EvaluationWithEchoes final : public FrameEvaluation {
 public:
  EvaluationWithEchoes(const AcousticState& state, FrameEchoes echoes, const RecordedFrame& recorded,
                       std::span<const int> active, FrameModel::Terms wanted)
      : echoes_(std::move(echoes)), evaluation_(state, echoes_, recorded, active, wanted) {}

  bool Bins(int first, int last, PixelTerms& terms) const override {
    return evaluation_.Bins(first, last, terms);
  }

 private:
  FrameEchoes echoes_;
  AcousticEvaluation evaluation_;
};

std::vector<int> FirstOfFrames(const std::vector<AcousticFrame>& frames) {
  std::vector<Pose> poses;
  for (const AcousticFrame& frame : frames) poses.push_back(frame.world_from_sonar);
  return FirstOfPose(poses);
}

}  // namespace

std::vector<RecordedPower> RecordedPowers(const PolarImage& image, const DisplayParameters<double>& display) {
  if (image.scale.quantity != Quantity::kGrey) {
    throw DataError("fit: the recorded image holds {}, expected grey levels", ToString(image.scale.quantity));
  }
  const double full_scale = image.scale.full_scale;
  const double top = TopLevel(image);
  const auto power_of = [&](double grey) { return sim::PowerFromDisplay(display, grey / full_scale); };
  std::vector<RecordedPower> recorded;
  recorded.reserve(image.value.size());
  for (const float value : image.value.values()) {
    const double grey = value;
    if (!std::isfinite(grey)) throw DataError("fit: a recorded pixel is not finite");
    // A grey level stands for all values that round to it. Level 0 also stands for all lower powers, the top
    // level for all higher ones.
    if (grey < 0.5) {
      recorded.push_back({power_of(0.5), Censoring::kAtMost});
    } else if (grey > top - 0.5) {
      recorded.push_back({power_of(top - 0.5), Censoring::kAtLeast});
    } else if (const double power = power_of(grey); power > 0.0) {
      recorded.push_back({power, Censoring::kNone});
    } else {
      recorded.push_back({power_of(grey + 0.5), Censoring::kAtMost});
    }
  }
  return recorded;
}

AcousticFrameModel::AcousticFrameModel(const sim::Simulator& simulator,
                                       const std::vector<AcousticFrame>& frames, const ParameterSet& initial,
                                       const std::vector<std::string>& objects,
                                       const std::vector<std::string>& outlines)
    : simulator_(simulator),
      objects_(objects),
      outlines_(outlines),
      placed_(simulator, objects, outlines),
      frames_(frames),
      material_names_(simulator.caster().material_names()),
      initial_(sim::WithResponse(simulator.sonar(), initial)),
      weights_(frames.size()),
      repeat_shares_(frames.size()),
      first_of_pose_(FirstOfFrames(frames)),
      shown_(material_names_.size(), false),
      reflected_(material_names_.size(), false) {
  if (!initial_.receiver.noise_db) throw DataError("fit: the acoustic model needs receiver.noise_db");
  sim::CheckTapers(initial_.receiver, beams());
  for (const std::string& name : material_names_) initial_.materials[name] = initial.Material(name);
  std::vector<int> indices;
  for (const AcousticFrame& frame : frames) {
    indices.push_back(frame.index);
    if ((!frame.use.empty() && frame.use.size() != pixel_count()) || frame.recorded.size() != pixel_count()) {
      throw DataError("fit: frame {} has {} pixels, expected {}", frame.index, frame.recorded.size(),
                      pixel_count());
    }
  }
  catalog_ =
      BuildAcousticCatalog(material_names_, simulator.sonar(), indices,
                           sim::ReflectingMaterials(material_names_, initial_), objects, placed_.outlines());
  for (const CatalogEntry& entry : catalog_) {
    if (!IsPlacement(entry)) {
      initial_values_.push_back(AcousticSlot(initial_, material_names_, entry));
      continue;
    }
    if (entry.group != ParameterGroup::kPose) {
      initial_values_.push_back(DeclaredValue(entry));
      continue;
    }
    const PoseStep named = entry.frame == kMountFrame ? PoseStep(PoseStep::Zero())
                                                      : NamedValues(frames[entry.frame].world_from_sonar);
    initial_values_.push_back(named(entry.index));
  }
  Linearise(initial_values_, {});
  for (const FrameEchoes& of : echoes_) {
    for (const sim::PixelEchoes::Entry& entry : of.at_point.entries)
      shown_[entry.node / sim::CoarseIncidenceDeg().size()] = true;
    for (const sim::PixelEchoes::Entry& entry : of.ghosts.pixels.entries)
      shown_[entry.node / sim::CoarseIncidenceDeg().size() / sim::kCurveParts % material_names_.size()] =
          true;
    for (const sim::GhostWay& way : of.ghosts.ways) {
      for (const std::uint16_t mirror : way) reflected_[mirror] = true;
    }
  }
}

AcousticFrameModel::AcousticFrameModel(const AcousticFrameModel& other, const sim::Simulator& simulator,
                                       const ParameterValues& values, const std::vector<int>& geometric,
                                       bool keeps_echoes)
    : simulator_(simulator),
      objects_(other.objects_),
      outlines_(other.outlines_),
      placed_(simulator, objects_, outlines_),
      frames_(other.frames_),
      material_names_(other.material_names_),
      initial_(other.Parameters(values)),
      catalog_(other.catalog_),
      initial_values_(other.initial_values_),
      keeps_echoes_(keeps_echoes),
      weights_(other.weights_),
      repeat_shares_(other.repeat_shares_),
      first_of_pose_(other.first_of_pose_),
      shown_(other.shown_),
      reflected_(other.reflected_) {
  Linearise(values, geometric);
}

AcousticFrameModel AcousticFrameModel::OneFrameAtATime(const AcousticFrameModel& other,
                                                       const sim::Simulator& simulator,
                                                       const ParameterValues& values,
                                                       const std::vector<int>& geometric) {
  const bool keeps_echoes = std::ranges::any_of(geometric, [&](int entry) {
    return ChangesScene(other.catalog_[entry]) && !IsRigidMove(other.catalog_[entry]);
  });
  return {other, simulator, values, geometric, keeps_echoes};
}

FrameModel::SpeckleCell SpeckleCellOf(const PolarAxes& axes, const ParameterSet& complete) {
  const double spacing_deg = DegFromRad(axes.beam_spacing_rad());
  return {.bins = std::max(1.0, complete.pulse.length_m / axes.range_bin_m()),
          .beams = spacing_deg > 0.0 ? std::max(1.0, complete.beam.azimuth_width_deg / spacing_deg) : 1.0};
}

FrameModel::SpeckleCell AcousticFrameModel::speckle_cell() const {
  return SpeckleCellOf(simulator_.sonar().axes, initial_);
}

int AcousticFrameModel::first_of_pose(int frame) const {
  return first_of_pose_[frame];
}

ParameterSet AcousticFrameModel::Parameters(const ParameterValues& values) const {
  ParameterSet parameters = initial_;
  for (std::size_t i = 0; i < catalog_.size(); ++i) {
    if (IsPlacement(catalog_[i])) continue;
    AcousticSlot(parameters, material_names_, catalog_[i]) = values[i];
  }
  return parameters;
}

Pose AcousticFrameModel::PoseOf(int frame, const ParameterValues& values) const {
  return PoseEntries(frame, values) * MountOf(values);
}

Pose AcousticFrameModel::PoseEntries(int frame, const ParameterValues& values) const {
  PoseStep named = PoseStep::Zero();
  for (std::size_t i = 0; i < catalog_.size(); ++i) {
    if (catalog_[i].group == ParameterGroup::kPose && catalog_[i].frame == frame)
      named(catalog_[i].index) = values[i];
  }
  return PoseFromNamedValues(named);
}

AcousticFrameModel::Rays AcousticFrameModel::RaysAt(const ParameterValues& values, int decimation) const {
  return RaysAt(values, Decimated(sonar(), simulator_.options().fan, decimation));
}

AcousticFrameModel::Rays AcousticFrameModel::RaysAt(const ParameterValues& values,
                                                    const sim::RayFanOptions& fan) const {
  std::shared_ptr<const sim::Simulator> simulator = SimulatorAt(values);
  sim::RayFan of_sonar(simulator->sonar(), fan);
  return {std::move(simulator), std::move(of_sonar)};
}

std::vector<double> AcousticFrameModel::TracedCosts(const ParameterValues& values,
                                                    const sim::RayFanOptions& fan) const {
  const Rays rays = RaysAt(values, fan);
  const ParameterSet parameters = Parameters(values);
  std::vector<double> costs(frames_.size(), 0.0);
  tbb::parallel_for(0, frame_count(), [&](int frame) {
    const PolarImage power = ExpectedPowerFrom(frame, PoseOf(frame, values), parameters, rays);
    for (std::size_t pixel = 0; pixel < pixel_count(); ++pixel) {
      if (!Counts(frame, pixel)) continue;
      const double mean = power.value.values()[pixel];
      if (!(mean > 0.0) || !std::isfinite(mean)) {
        costs[frame] = std::numeric_limits<double>::infinity();
        return;
      }
      const double residual =
          PowerLikelihood(frames_[frame].recorded[pixel], mean, parameters.receiver.looks).residual;
      costs[frame] += 0.5 * Weight(frame, pixel) * residual * residual;
    }
  });
  return costs;
}

double AcousticFrameModel::TracedCost(const ParameterValues& values, const sim::RayFanOptions& fan) const {
  const std::vector<double> costs = TracedCosts(values, fan);
  return std::accumulate(costs.begin(), costs.end(), 0.0);
}

Grid<double> AcousticFrameModel::EchoPowerFrom(const Pose& world_from_sonar, const ParameterSet& parameters,
                                               const Rays& rays) {
  const sim::Simulator& simulator = *rays.simulator;
  const sim::AcousticGeometry geometry = GeometryWith(simulator);
  sim::ScatterMap scatter = sim::ScatterFrom(simulator.caster(), rays.fan, world_from_sonar, geometry,
                                             parameters, simulator.options().trace);
  const int decimation = std::max(
      1, static_cast<int>(std::lround(static_cast<double>(simulator.fan().rows()) / rays.fan.rows())));
  const sim::GhostList ghosts = simulator.TraceGhosts(world_from_sonar, parameters, decimation);
  sim::AddGhosts(ghosts, geometry, parameters, scatter);
  return sim::EchoPowerImage(scatter, geometry, parameters);
}

Grid<double> AcousticFrameModel::EchoPowerFrom(int frame, const Pose& world_from_sonar,
                                               const ParameterSet& parameters, const Rays& rays) const {
  return RenderByPing(world_from_sonar, frames_[frame].pings,
                      [&](const Pose& pose) { return EchoPowerFrom(pose, parameters, rays); });
}

PolarImage AcousticFrameModel::ExpectedPowerFrom(int frame, const Pose& world_from_sonar,
                                                 const ParameterSet& parameters, const Rays& rays) const {
  Grid<double> power = EchoPowerFrom(frame, world_from_sonar, parameters, rays);
  sim::AddNoiseFloor(GeometryWith(*rays.simulator), parameters, power);
  return sim::PowerImage(rays.simulator->sonar().axes, power);
}

sim::GhostList AcousticFrameModel::GhostsOf(const sim::Simulator& simulator, const Pose& world_from_sonar,
                                            const ParameterValues& values,
                                            const std::vector<int>& geometric) const {
  ParameterSet parameters = Parameters(values);
  const bool transmit_moves = std::any_of(geometric.begin(), geometric.end(), [&](int entry) {
    return catalog_[entry].group == ParameterGroup::kTransmit;
  });
  double& end_deg = parameters.beam.transmit_end_deg;
  if (transmit_moves) end_deg = kTransmitGridDeg * std::ceil(kTransmitReach * end_deg / kTransmitGridDeg);
  return simulator.TraceGhosts(world_from_sonar, parameters);
}

FrameEchoes AcousticFrameModel::EchoesAbout(const sim::Simulator& simulator, int frame,
                                            const ParameterValues& values,
                                            const std::vector<int>& geometric) const {
  const Pose pose = PoseOf(frame, values);
  const std::vector<PingPose>& pings = frames_[frame].pings;
  if (pings.empty()) return EchoesFrom(simulator, pose, values, geometric);
  std::vector<FrameEchoes> of_pings;
  for (const PingPose& ping : pings)
    of_pings.push_back(EchoesFrom(simulator, pose * ping.frame_from_ping, values, geometric));
  return EchoesByPing(pings, beams(), of_pings);
}

FrameEchoes AcousticFrameModel::EchoesFrom(const sim::Simulator& simulator, const Pose& world_from_sonar,
                                           const ParameterValues& values,
                                           const std::vector<int>& geometric) const {
  const sim::EchoPower at_pose = sim::EchoesOfPose(simulator, world_from_sonar, Parameters(values));
  FrameEchoes echoes{.at_point = sim::ThroughBeamAndPulse(simulator, at_pose, Parameters(values))};
  const sim::GhostList ghosts = GhostsOf(simulator, world_from_sonar, values, geometric);
  if (!ghosts.echoes.empty()) echoes.ghosts = sim::GatherGhostEchoes(simulator, ghosts, Parameters(values));
  for (const int index : geometric) {
    const CatalogEntry& entry = catalog_[index];
    if (IsPlacement(entry)) continue;
    const double step = DifferenceStep(entry, values[index], sonar().axes);
    ParameterValues above = values;
    ParameterValues below = values;
    above[index] += step;
    below[index] -= step;
    echoes.slopes.push_back({.entry = index});
    if (!ghosts.echoes.empty()) {
      const auto gather = [&](const ParameterValues& at) {
        return sim::GatherGhostEchoes(simulator, ghosts, Parameters(at)).pixels;
      };
      echoes.slopes.back().ghosts = sim::Difference(gather(above), gather(below), 1.0 / (2.0 * step));
    }
    if (entry.group == ParameterGroup::kTransmit) continue;
    // Azimuth beam pattern and pulse do not change the echoes that arrive, only the pixels where they appear.
    const bool arrives_alike = entry.group == ParameterGroup::kPulse || entry.index == 0;
    const auto gather = [&](const ParameterValues& at) {
      return arrives_alike ? sim::ThroughBeamAndPulse(simulator, at_pose, Parameters(at))
                           : sim::GatherPixelEchoes(simulator, world_from_sonar, Parameters(at));
    };
    echoes.slopes.back().echoes = sim::Difference(gather(above), gather(below), 1.0 / (2.0 * step));
  }
  return echoes;
}

void AcousticFrameModel::AddSlopesOfMoves(const sim::Simulator& simulator, int frame,
                                          const ParameterValues& values, const std::vector<int>& geometric,
                                          FrameEchoes& echoes) const {
  const auto of_frame = [&](int index) {
    const CatalogEntry& entry = catalog_[index];
    if (IsRigidMove(entry)) return true;
    if (entry.group != ParameterGroup::kPose) return entry.group == ParameterGroup::kGeometry;
    return entry.frame == frame || entry.frame == kMountFrame;
  };
  std::vector<int> entries;
  std::ranges::copy_if(geometric, std::back_inserter(entries), of_frame);
  if (entries.empty()) return;
  std::vector<std::vector<float>> slopes(entries.size(), std::vector<float>(pixel_count(), 0.0F));
  const std::vector<PingPose>& pings = frames_[frame].pings;
  if (pings.empty()) AddSlopesOfPing(simulator, frame, PingOfAllBeams(beams()), values, entries, slopes);
  for (const PingPose& ping : pings) AddSlopesOfPing(simulator, frame, ping, values, entries, slopes);
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const CatalogEntry& entry = catalog_[entries[i]];
    if (ChangesAxes(entry)) ScaleToEntry(sonar().axes, entry, slopes[i]);
    echoes.slopes.push_back({.entry = entries[i], .logarithm = std::move(slopes[i])});
  }
}

void AcousticFrameModel::AddSlopesOfPing(const sim::Simulator& simulator, int frame, const PingPose& ping,
                                         const ParameterValues& values, const std::vector<int>& entries,
                                         std::vector<std::vector<float>>& slopes) const {
  constexpr double kDifference = 1e-5;
  const Pose pose = PoseOf(frame, values) * ping.frame_from_ping;
  const bool objects_move =
      std::ranges::any_of(entries, [&](int index) { return IsRigidMove(catalog_[index]); });
  const MoveSlopes moves = SlopesFrom(simulator, pose, values, objects_move);
  const Grid<double> rest = FloorOfEchoes(Parameters(values));
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const int index = entries[i];
    const CatalogEntry& entry = catalog_[index];
    std::vector<float>& slope = slopes[i];
    const auto add = [&](double factor, const Grid<float>& of_move) {
      for (int bin = 0; bin < of_move.rows(); ++bin) {
        for (const int beam : ping.beams) {
          slope[static_cast<std::size_t>(bin) * beams() + beam] +=
              static_cast<float>(factor * of_move(bin, beam) / (moves.power(bin, beam) + rest(bin, beam)));
        }
      }
    };
    if (IsRigidMove(entry)) {
      add(1.0, SlopeAlongObject(moves, index, pose, values));
    } else if (TurnsBeams(entry)) {
      add(-1.0, moves.along[kTurnOfSonar]);
    } else if (ChangesAxes(entry)) {
      add(1.0, moves.range_offset);
    } else {
      ParameterValues at = values;
      at[index] += kDifference;
      const PoseStep step = StepBetween(pose, PoseOf(frame, at) * ping.frame_from_ping) / kDifference;
      for (int k = 0; k < kPoseSteps; ++k) add(step(k), moves.along[k]);
    }
  }
}

MoveSlopes AcousticFrameModel::SlopesFrom(const sim::Simulator& simulator, const Pose& world_from_sonar,
                                          const ParameterValues& values, bool objects) const {
  return SlopesOfMoves(simulator, world_from_sonar, Parameters(values),
                       objects ? placed_.PartsOf(simulator) : sim::SceneParts());
}

Grid<float> AcousticFrameModel::SlopeAlongObject(const MoveSlopes& slopes, int entry,
                                                 const Pose& world_from_sonar,
                                                 const ParameterValues& values) const {
  const CatalogEntry& of = catalog_[entry];
  return slopes.AlongPlacement(of.object, placed_.objects()[of.object],
                               placed_.PlacementsAt(catalog_, values)[of.object], of.index, world_from_sonar);
}

Grid<double> AcousticFrameModel::FloorOfEchoes(const ParameterSet& parameters) const {
  constexpr double kOfNoise = 1e-3;
  Grid<double> floor = sim::NoiseFloorPower(GeometryWith(simulator_), parameters);
  for (double& power : floor.values()) power *= kOfNoise;
  return floor;
}

std::vector<float> AcousticFrameModel::LogarithmSlope(const EchoPair& echoes,
                                                      const ParameterSet& parameters) const {
  const Grid<double> floor = FloorOfEchoes(parameters);
  std::vector<float> slope;
  slope.reserve(pixel_count());
  for (std::size_t i = 0; i < pixel_count(); ++i) {
    const double rest = floor.values()[i];
    slope.push_back(static_cast<float>(
        std::log((echoes.above.values()[i] + rest) / (echoes.below.values()[i] + rest)) / echoes.difference));
  }
  return slope;
}

std::vector<FrameEchoes> AcousticFrameModel::FramesAbout(const sim::Simulator& simulator,
                                                         const ParameterValues& values,
                                                         const std::vector<int>& geometric) const {
  std::vector<FrameEchoes> echoes(frames_.size());
  tbb::parallel_for(0, frame_count(),
                    [&](int frame) { echoes[frame] = EchoesAbout(simulator, frame, values, geometric); });
  return echoes;
}

bool AcousticFrameModel::KeepsEchoes(const ParameterValues& values, const std::vector<int>& geometric) const {
  if (point_.empty() ||
      !std::ranges::all_of(geometric, [&](int entry) { return IsPlacement(catalog_[entry]); }))
    return false;
  for (std::size_t i = 0; i < catalog_.size(); ++i) {
    if (IsGeometric(catalog_[i]) && values[i] != point_[i]) return false;
  }
  return true;
}

void AcousticFrameModel::Linearise(const ParameterValues& values, const std::vector<int>& geometric) {
  at_point_ = SimulatorAt(values);
  geometric_ = geometric;
  if (!keeps_echoes_) {
    point_ = values;
    return;
  }
  if (KeepsEchoes(values, geometric)) {
    for (FrameEchoes& echoes : echoes_) echoes.slopes.clear();
  } else {
    DropEchoes();
    echoes_ = FramesAbout(*at_point_, values, geometric);
  }
  point_ = values;
  tbb::parallel_for(0, frame_count(), [&](int frame) {
    AddSlopesOfMoves(*at_point_, frame, values, geometric, echoes_[frame]);
  });
  AddSlopesOfScene(values, geometric, echoes_);
}

void AcousticFrameModel::DropEchoes() {
  std::vector<FrameEchoes>().swap(echoes_);
  point_.clear();
}

void AcousticFrameModel::AddSlopesOfScene(const ParameterValues& values, const std::vector<int>& geometric,
                                          std::vector<FrameEchoes>& echoes) const {
  const ParameterSet parameters = Parameters(values);
  for (const int index : geometric) {
    if (!ChangesScene(catalog_[index]) || IsRigidMove(catalog_[index])) continue;
    const double step = DifferenceStep(catalog_[index], values[index], sonar().axes);
    ParameterValues above = values;
    ParameterValues below = values;
    above[index] += step;
    below[index] -= step;
    const Rays rays_above = RaysAt(above, 1);
    const Rays rays_below = RaysAt(below, 1);
    tbb::parallel_for(0, frame_count(), [&](int frame) {
      const Pose pose = PoseOf(frame, values);
      echoes[frame].slopes.push_back(
          {.entry = index,
           .logarithm = LogarithmSlope({EchoPowerFrom(frame, pose, parameters, rays_above),
                                        EchoPowerFrom(frame, pose, parameters, rays_below), 2.0 * step},
                                       parameters)});
    });
  }
}

void AcousticFrameModel::DownWeight(const ParameterValues& values) {
  const ParameterSet parameters = Parameters(values);
  const DownWeightOptions options{.cell_bins = speckle_cell().bins, .cell_beams = speckle_cell().beams};
  for (int frame = 0; frame < frame_count(); ++frame) {
    weights_[frame] = CellWeights(frames_[frame].recorded, MeanPower(frame, values), frames_[frame].use,
                                  range_bins(), beams(), parameters.receiver.looks, options);
  }
}

int AcousticFrameModel::distinct_poses() const {
  int count = 0;
  for (int frame = 0; frame < frame_count(); ++frame) count += first_of_pose(frame) == frame ? 1 : 0;
  return count;
}

void AcousticFrameModel::ShareRepeats(const ParameterValues& values) {
  std::vector<int> count(frames_.size(), 0);
  for (int frame = 0; frame < frame_count(); ++frame) ++count[first_of_pose(frame)];
  const sim::ReceiverNoise noise(Parameters(values).receiver, sonar_at_point().axes,
                                 simulator_.absorption_db_per_m());
  for (int frame = 0; frame < frame_count(); ++frame) {
    const int others = count[first_of_pose(frame)] - 1;
    if (others == 0) continue;
    const std::vector<double> mean = MeanPower(frame, values);
    std::vector<float>& share = repeat_shares_[frame];
    share.clear();
    for (std::size_t pixel = 0; pixel < mean.size(); ++pixel) {
      const double of_noise =
          noise.Power(static_cast<int>(pixel) / beams(), static_cast<int>(pixel) % beams()) / mean[pixel];
      share.push_back(static_cast<float>(1.0 / (1.0 + others * std::pow(1.0 - of_noise, 2))));
    }
  }
}

void AcousticFrameModel::TakeRepeatShares(const std::vector<std::vector<float>>& shares) {
  const auto fits = [&](const std::vector<float>& share, const AcousticFrame& frame) {
    return share.empty() || share.size() == frame.recorded.size();
  };
  if (!std::ranges::equal(shares, frames_, fits))
    throw std::invalid_argument("acoustic model: weights of repeated frames belong to other pixels");
  repeat_shares_ = shares;
}

AcousticState AcousticFrameModel::StateAt(const ParameterSet& parameters,
                                          const ParameterValues& values) const {
  return {.catalog = catalog_,
          .material_names = material_names_,
          .sonar = sonar_at_point(),
          .absorption_db_per_m = simulator_.absorption_db_per_m(),
          .parameters = parameters,
          .values = values,
          .point = point_};
}

std::vector<double> AcousticFrameModel::MeanPower(int frame, const ParameterValues& values) const {
  const ParameterSet parameters = Parameters(values);
  return AcousticEvaluation(StateAt(parameters, values), echoes_[frame], {}, {}, Terms::kResiduals).Means();
}

std::unique_ptr<FrameEvaluation> AcousticFrameModel::At(int frame, const ParameterValues& values,
                                                        std::span<const int> active, Terms wanted) const {
  const AcousticFrame& of = frames_[frame];
  const ParameterSet parameters = Parameters(values);
  const std::span<const int> differentiated = wanted == Terms::kResiduals ? std::span<const int>{} : active;
  const RecordedFrame recorded{
      .power = of.recorded, .use = of.use, .weight = weights_[frame], .repeat_share = repeat_shares_[frame]};
  if (keeps_echoes_) {
    return std::make_unique<AcousticEvaluation>(StateAt(parameters, values), echoes_[frame], recorded,
                                                differentiated, wanted);
  }
  FrameEchoes echoes = EchoesAbout(*at_point_, frame, point_, geometric_);
  AddSlopesOfMoves(*at_point_, frame, point_, geometric_, echoes);
  return std::make_unique<EvaluationWithEchoes>(StateAt(parameters, values), std::move(echoes), recorded,
                                                differentiated, wanted);
}

std::optional<PixelBlock> AcousticFrameModel::BlockFor(std::size_t wanted_pixels) const {
  // Curves change faster along range than from beam to beam.
  constexpr int kMaxBins = 4;
  constexpr int kMaxBeams = 8;
  constexpr double kWorthwhile = 4.0;  // fewer pixels by a smaller factor are hardly faster, and less exact
  const double factor =
      static_cast<double>(pixel_count() * frames_.size()) / static_cast<double>(wanted_pixels);
  if (factor < kWorthwhile) return std::nullopt;
  return PixelBlock{.bins = std::clamp(static_cast<int>(std::sqrt(0.5 * factor)), 1, kMaxBins),
                    .beams = std::clamp(static_cast<int>(std::sqrt(2.0 * factor)), 1, kMaxBeams)};
}

bool AcousticFrameModel::HasSlopes() const {
  return std::ranges::any_of(echoes_, [](const FrameEchoes& echoes) { return !echoes.slopes.empty(); });
}

std::unique_ptr<FrameModel> AcousticFrameModel::Coarse(std::size_t wanted_pixels) const {
  const std::optional<PixelBlock> block = BlockFor(wanted_pixels);
  if (HasSlopes() || !block) return nullptr;
  return std::make_unique<CoarseFrameModel>(*this, sonar_at_point(), echoes_, *block);
}

std::unique_ptr<FrameModel> AcousticFrameModel::CoarseAbout(const ParameterValues& values,
                                                            std::size_t wanted_pixels) const {
  const bool keeps = KeepsEchoes(values, {});
  if (keeps && !HasSlopes()) return Coarse(wanted_pixels);
  const std::optional<PixelBlock> block = BlockFor(wanted_pixels);
  if (!block) return nullptr;
  const std::shared_ptr<const sim::Simulator> simulator = SimulatorAt(values);
  std::vector<FrameEchoes> echoes;
  if (keeps) {
    for (const FrameEchoes& of : echoes_) echoes.push_back({.at_point = of.at_point, .ghosts = of.ghosts});
  } else {
    echoes = FramesAbout(*simulator, values, {});
  }
  return std::make_unique<CoarseFrameModel>(*this, simulator->sonar(), echoes, *block);
}

}  // namespace sonarcal::calib
