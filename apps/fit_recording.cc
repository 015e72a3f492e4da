#include "apps/fit_recording.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <numeric>
#include <optional>

#include "apps/simulate_recording.h"
#include "data_io/pose_io.h"
#include "data_io/types/error.h"

namespace sonarcal {
namespace {

// Share of a material's echoes that its range of incidence leaves out at either end.
constexpr double kRarest = 1e-3;

// What the parameters expect in each frame of a recording, on its own grey scale.
class ExpectedRecording final : public RecordingSource {
 public:
  ExpectedRecording(const RecordingSource& recorded, const std::vector<EchoHistogram>& echoes,
                    const ImageGeometry& geometry, const std::vector<std::string>& material_names,
                    const ParameterSet& parameters, const std::string& name)
      : recorded_(recorded),
        echoes_(echoes),
        geometry_(geometry),
        parameters_(PaperParametersFor(parameters, material_names)),
        info_(recorded.info()) {
    info_.source = name;
    info_.synthetic = true;
  }

  const RecordingInfo& info() const override { return info_; }
  int frame_count() const override { return recorded_.frame_count(); }
  FrameInfo frame_info(int index) const override { return recorded_.frame_info(index); }

  Frame ReadFrame(int index) const override {
    const std::vector<double> values = ExpectedPaperImage(echoes_.at(index), geometry_, parameters_);
    Frame frame{
        frame_info(index),
        {geometry_.axes, info_.scale, Grid<float>(geometry_.axes.range_bins, geometry_.axes.beam_count())}};
    std::transform(values.begin(), values.end(), frame.image.value.values().begin(),
                   [&](double value) { return static_cast<float>(value * info_.scale.full_scale); });
    return frame;
  }

 private:
  const RecordingSource& recorded_;
  const std::vector<EchoHistogram>& echoes_;
  const ImageGeometry& geometry_;
  PaperParameters<double> parameters_;
  RecordingInfo info_;
};

void CheckFittable(const RecordingSource& recording, const ParameterSet& initial) {
  if (initial.model != EchoModel::kPaper) {
    throw DataError("the parameters name the model 'acoustic', but only 'paper' can be fitted");
  }
  const RecordingInfo& info = recording.info();
  if (info.scale.quantity != Quantity::kGrey) {
    throw DataError("{}: the images hold {}, expected grey levels", info.source,
                    ToString(info.scale.quantity));
  }
}

std::vector<EchoHistogram> TraceFrames(const Simulator& simulator, const std::vector<TimedPose>& poses,
                                       const FitRecordingOptions& options) {
  std::vector<EchoHistogram> echoes;
  for (const TimedPose& pose : poses) {
    echoes.push_back(GatherEchoes(simulator.TraceEchoes(pose.world_from_sonar), simulator.sonar().axes));
    if (options.on_trace) options.on_trace(static_cast<int>(echoes.size()), static_cast<int>(poses.size()));
  }
  return echoes;
}

std::map<std::string, IncidenceRange> IncidenceSeen(const std::vector<FitFrame>& frames,
                                                    const std::vector<std::string>& material_names) {
  std::vector<double> weight(material_names.size() * kIncidenceNodes, 0.0);
  for (const FitFrame& frame : frames) {
    for (const EchoHistogram::Entry& entry : frame.echoes.entries) weight[entry.node] += entry.weight;
  }
  std::map<std::string, IncidenceRange> seen;
  for (std::size_t material = 0; material < material_names.size(); ++material) {
    const double* of = &weight[material * kIncidenceNodes];
    const double total = std::accumulate(of, of + kIncidenceNodes, 0.0);
    if (!(total > 0.0)) continue;
    int low = 0;
    int high = kIncidenceNodes - 1;
    for (double sum = of[low]; sum < kRarest * total; sum += of[++low]) {
    }
    for (double sum = of[high]; sum < kRarest * total; sum += of[--high]) {
    }
    seen[material_names[material]] = {low * kIncidenceStepDeg, high * kIncidenceStepDeg};
  }
  return seen;
}

// Compares what the parameters expect with what was recorded; `pictures` (where given) receives those of the
// frames in `shown`.
MetricsReport Judge(const RecordingSource& recording, const ExpectedRecording& expected,
                    const CompareRecordingsOptions& options, const std::vector<int>& shown = {},
                    std::vector<FramePictures>* pictures = nullptr) {
  if (pictures == nullptr) return CompareRecordings(recording, expected, options);
  CompareRecordingsOptions of_shown = options;
  of_shown.frames = shown;
  of_shown.noise_floor = false;
  PictureMaker maker;
  return CompareRecordings(
      recording, expected, of_shown,
      [&](const PolarImage& real, const PolarImage& simulated, const FrameMetrics& metrics) {
        pictures->push_back(maker.Make(real, simulated, metrics));
      });
}

// By frame, a box around the pixels that show a material.
std::map<int, Mask> RegionsAround(const std::string& material, const std::vector<EchoHistogram>& echoes,
                                  const std::vector<std::string>& material_names, const PolarAxes& axes) {
  constexpr int kMarginBins = 12;
  constexpr int kMarginBeams = 12;
  const auto found = std::find(material_names.begin(), material_names.end(), material);
  if (found == material_names.end()) throw DataError("the scene has no material '{}'", material);
  const auto index = static_cast<std::uint32_t>(found - material_names.begin());
  std::map<int, Mask> regions;
  for (std::size_t frame = 0; frame < echoes.size(); ++frame) {
    Mask shows(axes.range_bins, axes.beam_count());
    for (const EchoHistogram::Cell& cell : echoes[frame].cells) {
      for (std::uint32_t entry = cell.first_entry; entry < cell.last_entry; ++entry) {
        if (echoes[frame].entries[entry].node / kIncidenceNodes == index)
          shows(cell.row / kRangeSteps, cell.col) = 1;
      }
    }
    regions[static_cast<int>(frame)] = BoxAround(shows, kMarginBins, kMarginBeams);
  }
  return regions;
}

}  // namespace

RecordingFit FitRecording(const RecordingSource& recording, const Scene& scene, const ParameterSet& initial,
                          const FitRecordingOptions& options) {
  const auto say = [&](const std::string& sentence) {
    if (options.on_note && !sentence.empty()) options.on_note(sentence);
  };
  CheckFittable(recording, initial);
  const std::vector<TimedPose> poses = PosesOfRecording(recording);
  const FrameSplit split = SplitFrames(options.config, recording.frame_count());
  const SonarModel& sonar = recording.info().sonar;
  const WaterChoice water = ChooseWater(initial, recording.info().water);
  say(water.note);
  const Simulator simulator(scene, sonar, options.rays.For(sonar, water.water));
  if (const std::string caveat = AbsorptionCaveat(options.rays.absorption, sonar.frequency_hz, water.water);
      !caveat.empty()) {
    say("warning: " + caveat);
  }

  const auto trace_start = std::chrono::steady_clock::now();
  const std::vector<EchoHistogram> echoes = TraceFrames(simulator, poses, options);
  const double trace_s =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - trace_start).count();

  std::vector<FitFrame> frames;
  for (const int index : split.used) {
    frames.push_back({.index = index,
                      .echoes = echoes[index],
                      .measured = MeasuredForFit(recording.ReadFrame(index).image)});
    if (options.pixels)
      frames.back().use.assign(options.pixels->values().begin(), options.pixels->values().end());
  }
  const ImageGeometry geometry(sonar, simulator.absorption_db_per_m());
  const std::vector<std::string>& materials = simulator.caster().material_names();
  RecordingFit result{.rays = {simulator.fan().cols(), simulator.fan().rows()},
                      .fit = FitPaperModel(frames, geometry, materials, initial, options.config, options.fit),
                      .initial = initial,
                      .seen = IncidenceSeen(frames, materials),
                      .judged_on_held_out = !split.held_out.empty(),
                      .before = {},
                      .after = {},
                      .pictures_before = {},
                      .pictures_after = {}};
  FitReport& report = result.fit.report;
  report.frames_held_out = split.held_out;
  report.trace_s = trace_s;
  report.rays_cast = simulator.caster().rays_cast();
  if (!result.fit.usable) return result;

  const ExpectedRecording before(recording, echoes, geometry, materials, initial, "initial parameters");
  const ExpectedRecording after(recording, echoes, geometry, materials, result.fit.parameters,
                                "fitted parameters");
  CompareRecordingsOptions judge{.compare = options.comparison, .as_displayed = true};
  if (!options.object_material.empty()) {
    judge.regions = RegionsAround(options.object_material, echoes, materials, sonar.axes);
  }
  judge.frames = result.judged_on_held_out ? split.held_out : split.used;
  result.after = Judge(recording, after, judge);
  judge.noise_floor = false;
  result.before = Judge(recording, before, judge);
  result.before.noise_floor = result.after.noise_floor;
  if (options.pictures) {
    const std::vector<int> shown = TellingFrames(result.after);
    Judge(recording, before, judge, shown, &result.pictures_before);
    Judge(recording, after, judge, shown, &result.pictures_after);
  }
  return result;
}

}  // namespace sonarcal
