#include "apps/workflow/fit_frames.h"

#include <algorithm>

#include "calib/models/frame_saturation.h"
#include "core/types/error.h"
#include "data_io/parameters/parameters_io.h"

namespace sonarcal::workflow {
namespace {

std::vector<std::uint8_t> WithoutStreaks(const RecordingInfo& info, const PolarImage& image,
                                         const std::optional<Mask>& pixels) {
  std::vector<std::uint8_t> use = ValidPixels(info, pixels);
  calib::LeaveOutStreaks(image, info.valid, use);
  return use;
}

}  // namespace

void CheckFittable(const RecordingSource& recording, const ParameterSet& initial,
                   const FitRecordingOptions& options) {
  if (initial.model == EchoModel::kCoherent) {
    throw DataError(
        "the parameters name the model 'coherent', but only 'paper' and 'acoustic' can be fitted");
  }
  if (!options.choose.empty() && initial.model != EchoModel::kAcoustic) {
    throw DataError("the parameters name the model '{}', but only forms of 'acoustic' can be selected",
                    ToString(initial.model));
  }
  const RecordingInfo& info = recording.info();
  if (info.scale.quantity != Quantity::kGrey) {
    throw DataError("{}: the images hold {}, expected grey levels", info.source,
                    ToString(info.scale.quantity));
  }
  const std::optional<Compression>& compression = info.settings.compression;
  const bool by_power = initial.display.law == DisplayLaw::kPower;
  if (compression && initial.model == EchoModel::kAcoustic &&
      by_power != (*compression == Compression::kPower)) {
    throw DataError("{}: grey values go by {}, but the parameters' display.law is '{}', expected {}",
                    info.source,
                    *compression == Compression::kPower ? "a power of the amplitude" : "the logarithm",
                    ToString(initial.display.law),
                    *compression == Compression::kPower ? "'power'" : "'log' or 'soft_log'");
  }
}

std::vector<sim::EchoHistogram> TraceFrames(const sim::Simulator& simulator,
                                            const std::vector<data_io::TimedPose>& poses,
                                            const std::vector<int>& frames,
                                            const FitRecordingOptions& options) {
  std::vector<sim::EchoHistogram> echoes(poses.size());
  int done = 0;
  for (const int frame : frames) {
    echoes[frame] = simulator.GatherEchoes(poses[frame].world_from_sonar);
    if (options.on_trace) options.on_trace(++done, static_cast<int>(frames.size()));
  }
  return echoes;
}

std::vector<calib::FitFrame> PaperFrames(const RecordingSource& recording,
                                         const std::vector<sim::EchoHistogram>& echoes,
                                         const std::vector<int>& indices,
                                         const FitRecordingOptions& options) {
  std::vector<calib::FitFrame> frames;
  frames.reserve(indices.size());
  for (const int index : indices) {
    const PolarImage image = recording.ReadFrame(index).image;
    std::vector<std::uint8_t> use = ValidPixels(recording.info(), options.pixels);
    calib::LeaveOutSaturated(image, recording.info().valid, use);
    frames.push_back({.index = index,
                      .echoes = echoes[index],
                      .measured = calib::MeasuredForFit(image),
                      .use = std::move(use),
                      .level = calib::GreyLevel(image)});
  }
  return frames;
}

std::vector<calib::AcousticFrame> AcousticFrames(const RecordingSource& recording,
                                                 const std::vector<data_io::TimedPose>& poses,
                                                 const std::vector<int>& indices,
                                                 const FitRecordingOptions& options,
                                                 const DisplayParameters<double>& display) {
  std::vector<calib::AcousticFrame> frames;
  frames.reserve(indices.size());
  for (const int index : indices) {
    const PolarImage image = recording.ReadFrame(index).image;
    frames.push_back({.index = index,
                      .world_from_sonar = poses[index].world_from_sonar,
                      .recorded = calib::RecordedPowers(image, display),
                      .use = WithoutStreaks(recording.info(), image, options.pixels),
                      .pings = PosesOfPings(recording.info().sonar.pings, poses[index].motion)});
  }
  return frames;
}

std::vector<calib::GreyFrame> GreyFrames(const RecordingSource& recording,
                                         const std::vector<data_io::TimedPose>& poses,
                                         const std::vector<int>& indices, const std::optional<Mask>& pixels) {
  std::vector<calib::GreyFrame> frames;
  frames.reserve(indices.size());
  for (const int index : indices) {
    const data_io::TimedPose& pose = poses.at(index);
    PolarImage image = recording.ReadFrame(index).image;
    std::vector<std::uint8_t> use = WithoutStreaks(recording.info(), image, pixels);
    frames.push_back({.index = index,
                      .world_from_sonar = pose.world_from_sonar,
                      .image = std::move(image),
                      .use = std::move(use),
                      .pings = PosesOfPings(recording.info().sonar.pings, pose.motion)});
  }
  return frames;
}

PolarImage PaperImage(const sim::EchoHistogram& echoes, const sim::ImageGeometry& geometry,
                      const sim::PaperParameters<double>& parameters) {
  const std::vector<double> values = sim::ExpectedPaperImage(echoes, geometry, parameters);
  PolarImage image{
      geometry.axes,
      {.quantity = Quantity::kGrey, .full_scale = 1.0, .db_min = {}, .db_max = {}, .db_span = {}},
      Grid<float>(geometry.axes.range_bins, geometry.axes.beam_count())};
  std::transform(values.begin(), values.end(), image.value.values().begin(),
                 [](double value) { return static_cast<float>(value); });
  return image;
}

}  // namespace sonarcal::workflow
