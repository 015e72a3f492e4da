#include "apps/workflow/fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "apps/workflow/assumptions.h"
#include "apps/workflow/fit_doubts.h"
#include "apps/workflow/fit_frames.h"
#include "apps/workflow/frame_choice.h"
#include "apps/workflow/known_truth.h"
#include "apps/workflow/rays/ray_options.h"
#include "apps/workflow/scene_geometry.h"
#include "apps/workflow/simulate.h"
#include "calib/acoustic_fit.h"
#include "calib/mirror_start.h"
#include "calib/models/held_out_frames.h"
#include "calib/selection/ping_worth.h"
#include "core/imaging/change_scale.h"
#include "core/types/error.h"
#include "core/types/units.h"
#include "data_io/parameters/parameters_io.h"
#include "sim/acoustic/acoustic_image.h"
#include "sim/gathered/empty_frames.h"
#include "sim/gathered/power_response.h"
#include "sim/paper/paper_image.h"

namespace sonarcal::workflow {

namespace {

constexpr std::size_t kMaxKeptFrames = 16;  // each is traced again
constexpr std::size_t kStreakedFramesKept = 3;

// Number of frames on which two samples are compared with each other. Each is traced twice more.
constexpr int kPairFrames = 4;

// Share of a material's echoes that its range of incidence leaves out at either end.
constexpr double kRarest = 1e-3;

using RenderFrame = std::function<PolarImage(int frame)>;

// Expected images of all frames of a recording, on its grey scale.
class ExpectedRecording final : public RecordingSource {
 public:
  ExpectedRecording(const RecordingSource& recorded, RenderFrame render, const std::string& name)
      : recorded_(recorded), render_(std::move(render)), info_(recorded.info()) {
    info_.source = name;
    info_.synthetic = true;
  }

  const RecordingInfo& info() const override { return info_; }
  int frame_count() const override { return recorded_.frame_count(); }
  FrameInfo frame_info(int index) const override { return recorded_.frame_info(index); }

  Frame ReadFrame(int index) const override {
    Frame frame{frame_info(index), render_(index)};
    ChangeScale(info_.scale, frame.image);
    sim::QuantiseImage(frame.image);
    frame.image.axes = info_.sonar.axes;  // as declared: a fitted geometry says where echoes are recorded
    return frame;
  }

 private:
  const RecordingSource& recorded_;
  RenderFrame render_;
  RecordingInfo info_;
};

// Incidence angles at which frames see the materials. Keeps no frame.
class SeenIncidence {
 public:
  explicit SeenIncidence(std::size_t materials) : weight_(materials * sim::kIncidenceNodes, 0.0) {}

  void Add(const sim::EchoHistogram& echoes) {
    for (const sim::EchoHistogram::Entry& entry : echoes.entries) weight_[entry.node] += entry.weight;
  }

  std::map<std::string, IncidenceRange> Ranges(const std::vector<std::string>& material_names) const {
    std::map<std::string, IncidenceRange> seen;
    for (std::size_t material = 0; material < material_names.size(); ++material) {
      const double* of = &weight_[material * sim::kIncidenceNodes];
      const double total = std::accumulate(of, of + sim::kIncidenceNodes, 0.0);
      if (!(total > 0.0)) continue;
      int low = 0;
      int high = sim::kIncidenceNodes - 1;
      double below = of[low];
      while (below < kRarest * total) below += of[++low];
      double above = of[high];
      while (above < kRarest * total) above += of[--high];
      seen[material_names[material]] = {low * sim::kIncidenceStepDeg, high * sim::kIncidenceStepDeg};
    }
    return seen;
  }

 private:
  std::vector<double> weight_;
};

calib::FitResult FitPaper(const RecordingSource& recording, const std::vector<sim::EchoHistogram>& echoes,
                          const sim::ImageGeometry& geometry, const std::vector<std::string>& materials,
                          const std::vector<int>& used, const FitRecordingOptions& options,
                          const ParameterSet& initial) {
  const std::vector<calib::FitFrame> frames = PaperFrames(recording, echoes, used, options);
  return calib::FitPaperModel(frames, geometry, materials, initial, options.config, options.fit);
}

calib::ModelChoice Choose(const RecordingSource& recording, const sim::Simulator& simulator,
                          const std::vector<data_io::TimedPose>& poses, const calib::FrameSplit& split,
                          const FitRecordingOptions& options, const ParameterSet& initial,
                          bool by_background) {
  const auto read = [&](const std::vector<int>& indices) {
    return GreyFrames(recording, poses, indices, options.pixels);
  };
  calib::ModelChoiceOptions choice{.axes = options.choose, .fit = options.fit};
  if (options.on_note) choice.fit.progress = options.on_note;
  if (!by_background)
    return calib::ChooseModel(simulator, read(split.used), read(split.held_out), initial, options.config,
                              choice);
  // The display comes first, because the other choices depend on it.
  std::erase(choice.axes, calib::ChoiceAxis::kDisplay);
  const std::vector<calib::ChoiceAxis> others = std::exchange(choice.axes, {calib::ChoiceAxis::kDisplay});
  calib::ModelChoice chosen =
      calib::ChooseModel(simulator, read(split.used), {}, initial, options.config, choice);
  if (others.empty()) return chosen;
  choice.axes = others;
  calib::ModelChoice last = calib::ChooseModel(simulator, read(split.used), read(split.held_out),
                                               chosen.parameters, chosen.config, choice);
  last.axes.insert(last.axes.begin(), chosen.axes.begin(), chosen.axes.end());
  return last;
}

// Takes the display, which the acoustic model finds from the background, out of the free parameters. Returns
// whether it was among them.
bool TakeFreeDisplay(calib::FitConfig& config) {
  if (!config.free || std::erase(*config.free, "display") == 0) return false;
  // Alone: the levels of noise and echoes follow the new display.
  if (config.free->empty()) config.free = {"receiver.noise_db", "receiver.gain_db"};
  return true;
}

// Poses of all frames after the fit. Frames that are not fitted follow the mount offset. If each frame has a
// free pose, the poses of the held-out frames are fitted too, with all other parameters fixed.
std::vector<data_io::TimedPose> FittedPoses(const RecordingSource& recording, const sim::Simulator& simulator,
                                            const std::vector<data_io::TimedPose>& poses,
                                            const calib::FrameSplit& split,
                                            const FitRecordingOptions& options,
                                            const calib::AcousticFit& fit) {
  std::vector<data_io::TimedPose> fitted = poses;
  for (data_io::TimedPose& pose : fitted) pose.world_from_sonar = pose.world_from_sonar * fit.mount;
  for (std::size_t i = 0; i < split.used.size(); ++i)
    fitted[split.used[i]].world_from_sonar = fit.world_from_sonar[i];
  const auto& free = options.config.free;
  if (!free || std::find(free->begin(), free->end(), "pose") == free->end()) return fitted;
  if (options.fit.progress && !split.held_out.empty())
    options.fit.progress("fitting the poses of the held-out frames, with all other parameters fixed");
  const std::vector<Pose> held_out = calib::FitPosesOnly(
      simulator, AcousticFrames(recording, fitted, split.held_out, options, fit.parameters.display),
      fit.parameters, options.config.pose_prior, options.fit.progress);
  for (std::size_t i = 0; i < held_out.size(); ++i) fitted[split.held_out[i]].world_from_sonar = held_out[i];
  return fitted;
}

std::vector<int> FramesOf(const calib::FrameSplit& split) {
  std::vector<int> frames = split.used;
  frames.insert(frames.end(), split.held_out.begin(), split.held_out.end());
  return frames;
}

// Mean power of the echoes of a frame, without noise. One value per pixel, beams fastest.
std::vector<double> EchoesExpected(const sim::Simulator& simulator, const ParameterSet& parameters,
                                   const Pose& world_from_sonar, const std::vector<PingPose>& pings) {
  const sim::AcousticGeometry geometry{simulator.sonar(), simulator.absorption_db_per_m()};
  const Grid<double> echoes = RenderByPing(world_from_sonar, pings, [&](const Pose& pose) {
    const sim::ScatterMap scatter =
        simulator.Scatter(simulator.TraceEchoes(pose), parameters, simulator.TraceGhosts(pose, parameters));
    return sim::EchoPowerImage(scatter, geometry, parameters);
  });
  return {echoes.values().begin(), echoes.values().end()};
}

std::vector<data_io::TimedPose> WithoutMotion(std::vector<data_io::TimedPose> poses) {
  for (data_io::TimedPose& pose : poses) pose.motion.reset();
  return poses;
}

// Poses with the motion of others.
std::vector<data_io::TimedPose> WithMotionOf(const std::vector<data_io::TimedPose>& moving,
                                             std::vector<data_io::TimedPose> poses) {
  for (std::size_t i = 0; i < poses.size(); ++i) poses[i].motion = moving[i].motion;
  return poses;
}

}  // namespace

void CheckSettings(const RecordingSource& recording, const calib::FrameSplit& split) {
  const std::vector<int> frames = FramesOf(split);
  const FrameInfo first = recording.frame_info(frames.front());
  for (const int index : frames) {
    const FrameInfo frame = recording.frame_info(index);
    const std::string mismatch = SettingsMismatch(first.settings, frame.settings);
    if (mismatch.empty()) continue;
    throw DataError(
        "{}: {} in {} and {}: frames of different settings cannot be fitted or evaluated together; remove "
        "some with 'convert --frames A:B'",
        recording.info().source, mismatch, first.name, frame.name);
  }
}

sim::SimulationOptions AcousticSimulation(const RayOptions& rays, const SonarModel& sonar, const Water& water,
                                          const ParameterSet& parameters) {
  sim::SimulationOptions options = rays.For(sonar, water, parameters);
  options.noise = true;
  return options;
}

std::vector<std::uint8_t> ValidPixels(const RecordingInfo& info, const std::optional<Mask>& pixels) {
  const std::optional<Mask> use = Both(info.valid, pixels);
  if (!use) return {};
  return {use->values().begin(), use->values().end()};
}

std::string TakeDisplay(const ImageScale& scale, ParameterSet& parameters) {
  DisplayParameters<double>& display = parameters.display;
  if (!scale.db_min || !scale.db_max || display.law == DisplayLaw::kPower) return {};
  if (display.db_min == *scale.db_min && display.db_max == *scale.db_max) return {};
  std::string note = fmt::format(
      "the recording's display ({:g} .. {:g} dB) is used, not that of the parameters ({:g} .. {:g} dB)",
      *scale.db_min, *scale.db_max, display.db_min, display.db_max);
  display.db_min = *scale.db_min;
  display.db_max = *scale.db_max;
  return note;
}

RecordingFit FitRecording(const RecordingSource& recording, const Scene& scene, const ParameterSet& initial,
                          FitRecordingOptions options) {
  options.config = calib::WithOutlineNamed(std::move(options.config), scene);
  const bool free_display = initial.model == EchoModel::kAcoustic && TakeFreeDisplay(options.config);
  const auto say = [&](const std::string& sentence) {
    if (options.on_note && !sentence.empty()) options.on_note(sentence);
  };
  CheckFittable(recording, initial, options);
  if (options.comparison.object) CheckObject(*options.comparison.object, scene.material_names);
  const std::vector<data_io::TimedPose> recorded_poses = data_io::PosesOfRecording(recording);
  const std::vector<data_io::TimedPose> poses =
      options.pings == PingUse::kUse && initial.model == EchoModel::kAcoustic ? recorded_poses
                                                                              : WithoutMotion(recorded_poses);
  const auto pings_of = [&](const data_io::TimedPose& pose) {
    return PosesOfPings(recording.info().sonar.pings, pose.motion);
  };
  const bool has_pings =
      std::ranges::any_of(recorded_poses, [&](const auto& pose) { return !pings_of(pose).empty(); });
  if (initial.model == EchoModel::kPaper && has_pings)
    say("the paper's model is fitted with one pose per frame: the poses of the pings are ignored");
  const calib::FrameSplit split = calib::SplitFrames(options.config, recording.frame_count());
  CheckSettings(recording, split);
  calib::CheckHeldOut(recording, split);
  SonarModel sonar = recording.info().sonar;
  const WaterChoice water = ChooseWater(initial, recording.info().water);
  say(water.note);
  ParameterSet start = initial;
  const std::vector<std::string> assumed = AssumeMissing(recording.info().scale, free_display, sonar, start);
  for (const std::string& sentence : assumed) say(sentence);
  CheckRayWeight(options.rays.ray_weight, initial.model);
  const RaysForFit rays = ChooseRays(options.rays, recording.info(), initial.model);
  say(rays.note);
  const bool acoustic = initial.model == EchoModel::kAcoustic;
  if (acoustic) {
    say(TakeDisplay(recording.info().scale, start));
    start = calib::WithMirrorStart(start, options.config, scene.material_names, sonar);
  }
  ParameterSet rays_for = start;  // serves every pattern that is tried
  if (std::count(options.choose.begin(), options.choose.end(), calib::ChoiceAxis::kElevation) > 0)
    rays_for.beam.elevation_pattern = ElevationPattern::kCosine;
  const sim::Simulator simulator(scene, sonar,
                                 acoustic ? AcousticSimulation(rays.rays, sonar, water.water, rays_for)
                                          : rays.rays.For(sonar, water.water));
  say(RaysNote(rays.rays, simulator));
  if (const std::string caveat =
          sim::AbsorptionCaveat(options.rays.absorption, sonar.frequency_hz, water.water);
      !caveat.empty()) {
    say(caveat);
  }

  const auto trace_start = std::chrono::steady_clock::now();
  const std::vector<std::string>& materials = simulator.caster().material_names();
  SeenIncidence seen(materials.size());
  std::vector<int> empty;  // frames that do not show the scene
  const auto add = [&](int frame, const sim::EchoHistogram& histogram) {
    seen.Add(histogram);
    if (histogram.cells.empty()) empty.push_back(frame);
  };
  std::vector<sim::EchoHistogram> echoes;  // of the paper's model, which fits and evaluates with them
  if (acoustic) {
    int done = 0;
    for (const int frame : split.used) {
      add(frame, simulator.GatherEchoes(poses[frame].world_from_sonar));
      if (options.on_trace) options.on_trace(++done, static_cast<int>(split.used.size()));
    }
  } else {
    echoes = TraceFrames(simulator, poses, FramesOf(split), options);
    for (const int frame : split.used) add(frame, echoes[frame]);
  }
  say(sim::CheckSceneIsSeen(simulator, data_io::PosesAlone(poses), split.used, empty));
  const double trace_s =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - trace_start).count();

  RecordingFit result{.rays = {simulator.fan().cols(), simulator.fan().rows()},
                      .ray_options = rays.rays,
                      .fit = {},
                      .initial = start,
                      .seen = seen.Ranges(materials),
                      .judged_on_held_out = !split.held_out.empty(),
                      .before = {},
                      .after = {}};
  // Makes the expected images of given parameters and poses.
  using Poses = std::vector<data_io::TimedPose>;
  std::function<RenderFrame(const sim::Simulator&, const ParameterSet&, const Poses&)> expected_by;
  // With the fitted geometry and placement of objects.
  std::shared_ptr<const sim::Simulator> fitted_simulator(std::shared_ptr<const sim::Simulator>(), &simulator);
  const sim::ImageGeometry geometry(sonar, simulator.absorption_db_per_m());
  if (acoustic) {
    if (free_display || !options.choose.empty())
      result.choice = Choose(recording, simulator, poses, split, options, start, free_display);
    const ParameterSet& form = result.choice ? result.choice->parameters : start;
    const std::vector<calib::AcousticFrame> frames =
        AcousticFrames(recording, poses, split.used, options, form.display);
    result.initial = calib::WithNoiseStart(std::move(result.initial), frames);
    calib::AcousticFit fit =
        calib::FitAcousticModel(simulator, frames, result.choice ? form : result.initial,
                                result.choice ? result.choice->config : options.config, options.fit);
    fitted_simulator = fit.simulator;
    result.geometry = fit.geometry;
    if (fit.simulator->shared_caster() != simulator.shared_caster())
      result.scene = fit.simulator->caster().scene();
    if (fit.usable && fit.moved_poses) {
      result.poses = FittedPoses(recording, *fitted_simulator, poses, split, options, fit);
    }
    result.fit = {
        .parameters = std::move(fit.parameters), .report = std::move(fit.report), .usable = fit.usable};
    result.axes = sonar.axes;
    for (const std::vector<float>& weights : fit.weights) {
      result.weights.emplace_back(sonar.axes.range_bins, sonar.axes.beam_count());
      std::copy(weights.begin(), weights.end(), result.weights.back().values().begin());
    }
    expected_by = [&](const sim::Simulator& with, const ParameterSet& parameters, const Poses& from) {
      return [&](int frame) {
        return RenderByPing(from[frame].world_from_sonar, pings_of(from[frame]), [&](const Pose& pose) {
          return with.RenderExpected(with.TraceEchoes(pose), parameters, with.TraceGhosts(pose, parameters));
        });
      };
    };
  } else {
    result.fit = FitPaper(recording, echoes, geometry, materials, split.used, options, start);
    expected_by = [&](const sim::Simulator&, const ParameterSet& parameters, const Poses&) {
      return [&, paper = sim::PaperParametersFor(parameters, materials)](int frame) {
        return PaperImage(echoes.at(frame), geometry, paper);
      };
    };
  }
  result.ray_options.sampling = simulator.options().fan.sampling;
  result.ray_options.ray_weight = simulator.options().fan.weight;
  calib::FitReport& report = result.fit.report;
  if (!rays.warning.empty()) report.warnings.insert(report.warnings.begin(), rays.warning);
  report.warnings.insert(report.warnings.begin(), assumed.begin(), assumed.end());
  report.frames_held_out = split.held_out;
  report.saturation = calib::FindSaturation(recording, FramesOf(split));
  say(calib::SaturationText(*report.saturation));
  report.trace_s = trace_s;
  report.rays_cast = simulator.caster().rays_cast();
  if (const auto truth = options.truth ? options.truth : ReadTruth(recording.info()))
    AddTruth(*truth, result.fit.parameters, scene, sonar, report);
  if (!result.fit.usable) return result;

  const std::vector<data_io::TimedPose>& fitted_poses = result.poses.empty() ? poses : result.poses;
  const ExpectedRecording before(recording, expected_by(simulator, result.initial, poses),
                                 "initial parameters");
  const ExpectedRecording after(
      recording, expected_by(*fitted_simulator, result.fit.parameters, fitted_poses), "fitted parameters");
  CompareRecordingsOptions judge{.compare = options.comparison, .as_displayed = true};
  judge.frames = result.judged_on_held_out ? split.held_out : split.used;
  if (const std::optional<metrics::ObjectSearch>& object = options.comparison.object) {
    const SceneGeometry geometry_of(fitted_simulator->caster(), fitted_simulator->sonar());
    for (const int frame : FramesWithBoxes(recording, judge.frames))
      judge.boxes.emplace(frame, geometry_of.ObjectBox(fitted_poses[frame].world_from_sonar, *object));
  }
  result.after = CompareRecordings(recording, after, judge);
  judge.noise_floor = false;
  result.before = CompareRecordings(recording, before, judge);
  result.before.noise_floor = result.after.noise_floor;
  if (acoustic) {
    const auto sample_by = [&](const sim::Simulator& with, const ParameterSet& parameters, const Poses& from,
                               int draw = 0) {
      return ExpectedRecording(
          recording,
          [&, draw](int frame) {
            const Pose& pose = from[frame].world_from_sonar;
            const int seed = kFirstSample + frame + draw * recording.frame_count();
            if (const std::vector<PingPose> pings = pings_of(from[frame]); !pings.empty())
              return with.RenderPings(pose, pings, parameters, seed);
            return with.RenderEchoes(with.TraceEchoes(pose), parameters, seed,
                                     with.TraceGhosts(pose, parameters));
          },
          "a speckled sample");
    };
    result.sample_before = CompareRecordings(recording, sample_by(simulator, result.initial, poses), judge);
    result.sample_after = CompareRecordings(
        recording, sample_by(*fitted_simulator, result.fit.parameters, fitted_poses), judge);
    const ParameterSet& fitted = result.fit.parameters;
    CompareRecordingsOptions judge_pair = judge;
    judge_pair.frames = EvenlySpread(judge.frames, kPairFrames);
    result.sample_pair = CompareRecordings(sample_by(*fitted_simulator, fitted, fitted_poses, 1),
                                           sample_by(*fitted_simulator, fitted, fitted_poses), judge_pair);
    if (has_pings) {
      report.pings =
          calib::MeasurePingWorth(*fitted_simulator,
                                  GreyFrames(recording, WithMotionOf(recorded_poses, fitted_poses),
                                             EvenlySpread(judge.frames, kMaxKeptFrames), options.pixels),
                                  recording.info().sonar.pings, fitted, options.fit);
    }
    if (report.pings) {
      report.pings->used = options.pings == PingUse::kUse;
      report.pings->held_out = result.judged_on_held_out;
    }
    result.still = MeasureStillPoses(recording, fitted, simulator.absorption_db_per_m(),
                                     ValidPixels(recording.info(), options.pixels), &report, [&](int frame) {
                                       return EchoesExpected(*fitted_simulator, fitted,
                                                             fitted_poses[frame].world_from_sonar,
                                                             pings_of(fitted_poses[frame]));
                                     });
  }
  if (!result.judged_on_held_out && split.used.size() == 1) {
    report.unidentifiable_directions.emplace_back(
        "one frame alone: an error of pose or outline cannot be told from an error of beam or backscatter "
        "curve, which a frame from another pose would show");
    report.unidentifiable_directions.emplace_back(
        "one frame alone: speckle cannot be told from receiver noise, which a second frame from the same "
        "pose would show");
    report.unidentifiable_directions.emplace_back(
        "one frame alone: all figures are those of the fitted frame, which a model with more free values "
        "always describes better, because none is held out");
  }
  std::vector<std::string> doubts = DoubtsAbout(result, options.config);
  const std::vector<std::string> worse = WorseFigures(result);
  doubts.insert(doubts.end(), worse.begin(), worse.end());
  report.warnings.insert(report.warnings.begin(), doubts.begin(), doubts.end());
  if (options.keep_images) {
    for (const calib::FrameSaturation& saturated : *report.saturation) {
      if (result.streaked_frames.size() >= kStreakedFramesKept) break;
      if (!saturated.streaks.empty())
        result.streaked_frames.emplace(saturated.frame, recording.ReadFrame(saturated.frame).image);
    }
    const std::vector<int> examples = RepresentativeFrames(result.after);
    result.frames_before = ComparedFrames(recording, before, judge, examples);
    result.frames_after =
        ComparedFrames(recording, after, judge, SpreadFrames(result.after, examples, kMaxKeptFrames));
  }
  return result;
}

namespace {

// Limits a fit to these frames, of which some are held out.
void TakeFrames(std::vector<int> frames, int frame_count, calib::FitConfig& config) {
  config.used = std::move(frames);
  calib::FrameSplit split = calib::SplitFrames(config, frame_count);
  config.used = std::move(split.used);
  config.held_out = std::move(split.held_out);
}

bool FreesGroup(const calib::FitConfig& config, std::initializer_list<std::string_view> beginnings) {
  return std::ranges::any_of(*config.free, [&](const std::string& name) {
    return std::ranges::any_of(beginnings,
                               [&](std::string_view beginning) { return name.starts_with(beginning); });
  });
}

// Chooses the frames of a long recording, unless the user did.
void ChooseFramesOfFit(const RecordingSource& recording, const Scene& scene, const ParameterSet& start,
                       const FitOptions& options, const Listener& listener, calib::FitConfig& config) {
  const bool acoustic = start.model == EchoModel::kAcoustic;
  const FrameChoiceOptions choice{.limits = options.limits,
                                  .geometry = acoustic && FreesGroup(config, {"geometry"}),
                                  .poses = acoustic && FreesGroup(config, {"pose", "mount"}),
                                  .pose_prior = config.pose_prior,
                                  .held_out = config.held_out};
  if (!options.frames.empty() || config.used || start.model == EchoModel::kCoherent ||
      !NeedsFrameChoice(recording.frame_count(), choice)) {
    return;
  }
  SonarModel sonar = recording.info().sonar;
  ParameterSet known = start;
  AssumeMissing(recording.info().scale, /*find_display=*/true, sonar, known);
  AssumeWidths(sonar, known.beam);
  const ChosenFrames chosen = ChooseFrames({.scene = scene,
                                            .sonar = sonar,
                                            .water = ChooseWater(start, recording.info().water).water,
                                            .absorption = options.rays.absorption,
                                            .parameters = known},
                                           data_io::PosesOfRecording(recording), choice);
  config.used = chosen.used;
  config.held_out = chosen.held_out;
  listener.Message(fmt::format("frames: {}, because {}", chosen.choice, chosen.reason));
}

}  // namespace

calib::FitConfig ResolveFitConfig(const FitOptions& options, const ParameterSet& start, const Scene& scene,
                                  int frame_count) {
  calib::FitConfig config = options.config.value.value_or(calib::FitConfig());
  if (!options.free.empty()) config.free = options.free;
  if (!config.free) {
    config.free = start.model == EchoModel::kPaper
                      ? calib::PaperFreeByDefault()
                      : calib::AcousticFreeByDefault(start, scene.material_names);
  }
  if (!options.fixed.empty()) config.fixed = options.fixed;
  if (!options.held_out.empty()) config.held_out = options.held_out.In(frame_count, kHeldOutFrame);
  if (!options.frames.empty()) TakeFrames(options.frames.In(frame_count), frame_count, config);
  AddMaterialPriors(options.materials, start, scene, config);
  return config;
}

RecordingFit Fit(const RecordingSource& recording, const Scene& scene, const ParameterSet& start,
                 const FitOptions& options, const Listener& listener) {
  const bool acoustic = start.model == EchoModel::kAcoustic;
  if (options.trust_all && !acoustic)
    throw UsageError("--trust-all has no effect: the paper's model gives all pixels full weight");
  if (options.pings == PingUse::kIgnore && !acoustic)
    throw UsageError("--pings ignore has no effect: the paper's model is fitted with one pose per frame");
  const ThreadLimit threads(options.rays.threads);
  for (const std::string& sentence : MirrorCaveats(start, scene.material_names)) listener.Message(sentence);
  FitRecordingOptions fit;
  fit.rays = options.rays;
  fit.config = ResolveFitConfig(options, start, scene, recording.frame_count());
  for (const std::string& sentence :
       MaterialCaveats(options.materials, start, scene, recording.info().sonar.frequency_hz))
    listener.Message(sentence);
  ChooseFramesOfFit(recording, scene, start, options, listener, fit.config);
  fit.comparison = options.comparison.For(recording.info().sonar.axes);
  fit.choose = options.choose;
  fit.fit.max_iterations = options.max_iterations;
  fit.fit.starts = options.starts;
  fit.fit.threads = options.rays.threads;
  fit.fit.down_weight = !options.trust_all && acoustic;
  fit.pings = options.pings;
  fit.fit.progress = listener.message;
  fit.fit.stop = listener.stop;
  fit.on_note = listener.message;
  fit.on_trace = [&](int done, int total) { listener.Progress("Tracing", done, total); };
  return FitRecording(recording, scene, start, fit);
}

}  // namespace sonarcal::workflow
