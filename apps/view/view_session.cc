#include "apps/view/view_session.h"

#include <fmt/format.h>

#include <chrono>
#include <cstring>
#include <type_traits>
#include <utility>

#include "apps/workflow/simulate.h"
#include "calib/selection/held_out_likelihood.h"
#include "core/types/error.h"
#include "data_io/recordings/view_recording.h"
#include "sim/ghosts/ghost_trace.h"

namespace sonarcal::view {
namespace {

constexpr std::size_t kMaxClients = 64;

// Bytes that identify a value for comparison.
class Key {
 public:
  template <typename T>
  Key& operator<<(const T& value) requires(std::is_arithmetic_v<T> || std::is_enum_v<T>) {
    char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    text_.append(bytes, sizeof(T));
    return *this;
  }

  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

void Add(const sim::RayFanOptions& fan, Key& key) {
  key << fan.sampling << fan.cols << fan.rows << fan.elevation_span_deg << fan.azimuth_margin_deg
      << fan.row_crowding << fan.weight << fan.stagger << fan.stagger_rows;
}

// Key of everything that determines the echoes at a pose.
Key RaysKey(const SonarModel& sonar, const sim::SimulationOptions& options) {
  Key key;
  key << sonar.axes.range_min_m << sonar.axes.range_max_m << sonar.axes.range_bins
      << sonar.elevation_beam_width_deg << options.trace.normals << options.trace.step;
  Add(options.fan, key);
  for (const double azimuth_rad : sonar.axes.beam_azimuth_rad) key << azimuth_rad;
  return key;
}

std::string SimulatorKey(const SonarModel& sonar, const sim::SimulationOptions& options) {
  Key key = RaysKey(sonar, options);
  const Water& water = options.water;
  key << sonar.frequency_hz << sonar.azimuth_beam_width_deg << water.temperature_c << water.salinity_ppt
      << water.ph << water.depth_m << options.noise << options.seed;
  return key.text();
}

std::string PoseKey(const Pose& pose) {
  Key key;
  for (const double value : pose.position_m) key << value;
  for (const double value : pose.rotation.coeffs()) key << value;
  return key.text();
}

bool ShowSame(const ViewState& a, const ViewState& b) {
  const auto moved_alike = [&] {
    const auto of_a = a.poses.find(a.frame);
    const auto of_b = b.poses.find(b.frame);
    if ((of_a == a.poses.end()) != (of_b == b.poses.end())) return false;
    return of_a == a.poses.end() || PoseKey(of_a->second) == PoseKey(of_b->second);
  };
  return a.parameters == b.parameters && a.sonar == b.sonar && a.frame == b.frame && a.noise == b.noise &&
         a.seed == b.seed && moved_alike();
}

int BitsOf(const ViewSetup& setup) {
  if (!setup.real) return 8;
  const double full_scale = setup.real->info().scale.full_scale;
  for (const int bits : {8, 12, 16}) {
    if (full_scale == static_cast<double>((1 << bits) - 1)) return bits;
  }
  throw DataError("{}: full scale {:g}, expected 255, 4095 or 65535 to show a simulation beside it",
                  setup.real->info().source, full_scale);
}

double Seconds(std::chrono::steady_clock::duration time) {
  return std::chrono::duration<double>(time).count();
}

}  // namespace

// Echoes at one pose with one fan of rays.
struct ViewSession::Traced {
  std::string rays_and_pose;
  sim::EchoList echoes;
};

ViewSession::ViewSession(ViewSetup setup) : setup_(std::move(setup)), bits_(BitsOf(setup_)) {
  SONARCAL_CHECK(!setup_.poses.empty(), "a view without poses");
  if (setup_.compare.object) workflow::CheckObject(*setup_.compare.object, setup_.scene.material_names);
  caster_ = std::make_shared<const sim::RayCaster>(std::move(setup_.scene));
  if (setup_.compare.object) geometry_.emplace(*caster_, setup_.sonar);
}

ViewSession::~ViewSession() = default;

std::shared_ptr<const sim::Simulator> ViewSession::SimulatorFor(const ViewState& state) {
  const SonarModel sonar = Changed(setup_.sonar, state.sonar);
  workflow::CheckRayWeight(setup_.rays.ray_weight, state.parameters.model);
  sim::SimulationOptions options =
      setup_.rays.For(sonar, workflow::ChooseWater(state.parameters, setup_.water).water, state.parameters);
  if (setup_.margin_deg) options.fan.azimuth_margin_deg = *setup_.margin_deg;
  options.bits = bits_;
  options.noise = state.noise;
  options.seed = state.seed;
  options.ghost_order = setup_.ghost_order;
  std::string key = SimulatorKey(sonar, options);
  if (!simulator_ || key != simulator_key_) {
    simulator_ = std::make_shared<const sim::Simulator>(caster_, sonar, options);
    simulator_key_ = std::move(key);
  }
  return simulator_;
}

const sim::EchoList& ViewSession::EchoesFor(const sim::Simulator& simulator, const Pose& pose,
                                            ViewImage& image) {
  const auto start = std::chrono::steady_clock::now();
  std::string key = RaysKey(simulator.sonar(), simulator.options()).text() + PoseKey(pose);
  if (!traced_ || traced_->rays_and_pose != key) {
    traced_ = std::make_unique<Traced>(
        Traced{.rays_and_pose = std::move(key), .echoes = simulator.TraceEchoes(pose)});
    image.traced = true;
  }
  image.trace_s = Seconds(std::chrono::steady_clock::now() - start);
  return traced_->echoes;
}

ViewImage ViewSession::RenderNow(const ViewState& state) {
  if (last_state_ && ShowSame(*last_state_, state)) return last_;
  if (state.parameters.model == EchoModel::kCoherent) {
    throw DataError("the model 'coherent' is too slow to follow a slider, expected 'paper' or 'acoustic'");
  }
  const std::shared_ptr<const sim::Simulator> simulator = SimulatorFor(state);
  const data_io::TimedPose at = Poses(state)[static_cast<std::size_t>(state.frame)];
  const Pose& pose = at.world_from_sonar;
  const std::vector<PingPose> pings = PosesOfPings(simulator->sonar().pings, at.motion);
  ViewImage rendered;
  const auto start = std::chrono::steady_clock::now();
  if (state.noise || state.parameters.model == EchoModel::kAcoustic) {
    rendered.image = simulator->RenderPings(pose, pings, state.parameters, state.frame);
    rendered.traced = true;
    rendered.trace_s = Seconds(std::chrono::steady_clock::now() - start);
  } else {
    rendered.image = RenderByPing(pose, pings, [&](const Pose& of_ping) {
      return workflow::ExpectedFrame(*simulator, EchoesFor(*simulator, of_ping, rendered), state.parameters);
    });
    rendered.shade_s = Seconds(std::chrono::steady_clock::now() - start) - rendered.trace_s;
  }
  last_state_ = state;
  last_ = rendered;
  return rendered;
}

bool ViewSession::IsOvertaken(const ViewState& state) {
  if (state.client.empty()) return false;
  const std::scoped_lock lock(newest_mutex_);
  const auto found = newest_.find(state.client);
  return found != newest_.end() && found->second > state.sequence;
}

std::optional<ViewImage> ViewSession::Render(const ViewState& state) {
  if (!state.client.empty()) {
    const std::scoped_lock lock(newest_mutex_);
    if (newest_.size() >= kMaxClients && newest_.find(state.client) == newest_.end()) newest_.clear();
    std::int64_t& newest = newest_[state.client];
    newest = std::max(newest, state.sequence);
  }
  const std::scoped_lock lock(render_mutex_);
  if (IsOvertaken(state)) return std::nullopt;
  return RenderNow(state);
}

Frame ViewSession::Recorded(int frame) const {
  SONARCAL_CHECK(setup_.real != nullptr, "no recording to show");
  return setup_.real->ReadFrame(frame);
}

ViewComparison ViewSession::Compare(const ViewState& state) {
  Frame simulated;
  RecordingInfo info;
  std::shared_ptr<const sim::Simulator> simulator;
  {
    const std::scoped_lock lock(render_mutex_);
    simulated.image = RenderNow(state).image;
    simulator = SimulatorFor(state);
    info = workflow::SimulatedRecordingInfo(*simulator, state.parameters, setup_.scene_path, !state.noise);
  }
  Frame recorded = Recorded(state.frame);
  const data_io::TimedPose at = Poses(state)[static_cast<std::size_t>(state.frame)];
  const Pose& pose = at.world_from_sonar;
  ViewComparison comparison;
  if (state.parameters.model == EchoModel::kAcoustic && recorded.image.scale.quantity == Quantity::kGrey &&
      recorded.image.axes.Matches(simulator->sonar().axes)) {
    const calib::GreyFrame grey = {.index = state.frame,
                                   .world_from_sonar = pose,
                                   .image = recorded.image,
                                   .pings = PosesOfPings(simulator->sonar().pings, at.motion)};
    comparison.nats_per_pixel = calib::LogLikelihoodPerPixel(*simulator, grey, state.parameters);
  }
  simulated.info = {.name = recorded.info.name, .time_s = recorded.info.time_s, .world_from_sonar = {}};
  std::vector<Frame> of_real;
  of_real.push_back(std::move(recorded));
  std::vector<Frame> of_simulation;
  of_simulation.push_back(std::move(simulated));
  workflow::CompareRecordingsOptions options{
      .compare = setup_.compare, .as_displayed = true, .noise_floor = false};
  if (geometry_) options.boxes[0] = geometry_->ObjectBox(pose, *setup_.compare.object);
  std::optional<metrics::FrameMasks> masks;
  metrics::MetricsReport report =
      workflow::CompareRecordings(MemoryRecording(setup_.real->info(), std::move(of_real)),
                                  MemoryRecording(std::move(info), std::move(of_simulation)), options,
                                  [&](const PolarImage&, const PolarImage&,
                                      const metrics::FrameMetrics& metrics) { masks = metrics.masks; });
  comparison.metrics = std::move(report.frames.at(0));
  comparison.metrics.masks.swap(masks);
  comparison.metrics.index = state.frame;
  comparison.notes = std::move(report.notes);
  return comparison;
}

std::vector<data_io::TimedPose> ViewSession::Poses(const ViewState& state) const {
  std::vector<data_io::TimedPose> poses = setup_.poses;
  for (const auto& [frame, pose] : state.poses)
    poses.at(static_cast<std::size_t>(frame)).world_from_sonar = pose;
  return poses;
}

std::shared_ptr<const RecordingSource> ViewSession::RecordingOf(const ViewState& state) const {
  SONARCAL_CHECK(setup_.real != nullptr, "no recording to fit to");
  std::vector<std::optional<Pose>> poses(setup_.poses.size());
  for (std::size_t i = 0; setup_.poses_given && i < poses.size(); ++i) {
    poses[i] = setup_.poses[i].world_from_sonar;
  }
  for (const auto& [frame, pose] : state.poses) poses.at(static_cast<std::size_t>(frame)) = pose;
  return std::make_shared<const data_io::ReposedRecording>(setup_.real, std::move(poses));
}

}  // namespace sonarcal::view
