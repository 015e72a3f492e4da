#include "apps/python/residual_view.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "apps/workflow/rays/ray_options.h"
#include "apps/workflow/simulate.h"
#include "calib/acoustic_fit.h"
#include "core/imaging/change_scale.h"
#include "core/types/error.h"

namespace sonarcal::python {
namespace {

std::vector<int> FramesOf(std::vector<int> asked, int frame_count) {
  if (asked.empty()) {
    asked.resize(static_cast<std::size_t>(frame_count));
    std::iota(asked.begin(), asked.end(), 0);
  }
  for (const int frame : asked) {
    if (frame < 0 || frame >= frame_count)
      throw DataError("frame {} is asked for, but the recording has {}", frame, frame_count);
  }
  return asked;
}

}  // namespace

ResidualView::ResidualView(std::shared_ptr<const RecordingSource> recording, const Scene& scene,
                           ParameterSet initial, std::vector<int> frames,
                           const workflow::FitRecordingOptions& options)
    : recording_(std::move(recording)),
      initial_(std::move(initial)),
      frames_(FramesOf(std::move(frames), recording_->frame_count())) {
  workflow::CheckFittable(*recording_, initial_, options);
  workflow::CheckRayWeight(options.rays.ray_weight, initial_.model);
  const RecordingInfo& info = recording_->info();
  const std::vector<data_io::TimedPose> poses = data_io::PosesOfRecording(*recording_);
  const workflow::WaterChoice water = workflow::ChooseWater(initial_, info.water);
  if (initial_.model == EchoModel::kAcoustic) {
    workflow::TakeDisplay(info.scale, initial_);
    simulator_ = std::make_unique<sim::Simulator>(
        scene, info.sonar, workflow::AcousticSimulation(options.rays, info.sonar, water.water, initial_));
    acoustic_frames_ = workflow::AcousticFrames(*recording_, poses, frames_, options, initial_.display);
    initial_ = calib::WithNoiseStart(std::move(initial_), acoustic_frames_);
    acoustic_ = std::make_unique<calib::AcousticFrameModel>(*simulator_, acoustic_frames_, initial_);
    initial_values_ = acoustic_->initial_values();
    point_ = initial_values_;
    return;
  }
  simulator_ = std::make_unique<sim::Simulator>(
      scene, info.sonar,
      workflow::ChooseRays(options.rays, info, EchoModel::kPaper).rays.For(info.sonar, water.water));
  geometry_.emplace(info.sonar, simulator_->absorption_db_per_m());
  echoes_ = workflow::TraceFrames(*simulator_, poses, frames_, options);
  paper_frames_ = workflow::PaperFrames(*recording_, echoes_, frames_, options);
  paper_ = std::make_unique<calib::PaperFrameModel>(paper_frames_, *geometry_,
                                                    simulator_->caster().material_names(), initial_);
  initial_values_ = paper_->Values(initial_);
}

const calib::FrameModel& ResidualView::model() const {
  if (paper_) return *paper_;
  return *acoustic_;
}

const std::vector<calib::CatalogEntry>& ResidualView::catalog() const {
  return model().catalog();
}

std::vector<int> ResidualView::EntriesOf(const std::vector<std::string>& names) const {
  std::vector<int> entries;
  for (const std::string& name : names) {
    const auto found = std::find_if(catalog().begin(), catalog().end(),
                                    [&](const calib::CatalogEntry& entry) { return entry.name == name; });
    if (found == catalog().end()) throw DataError("'{}' is no parameter of this model", name);
    entries.push_back(static_cast<int>(found - catalog().begin()));
  }
  return entries;
}

PolarImage ResidualView::Expected(int position, const calib::ParameterValues& values) const {
  PolarImage image;
  if (paper_) {
    ParameterSet parameters = initial_;
    paper_->Store(values, parameters);
    image = workflow::PaperImage(paper_frames_[position].echoes, *geometry_,
                                 sim::PaperParametersFor(parameters, simulator_->caster().material_names()));
  } else {
    const ParameterSet parameters = acoustic_->Parameters(values);
    image = RenderByPing(acoustic_->PoseOf(position, values), acoustic_->frame(position).pings,
                         [&](const Pose& pose) {
                           return simulator_->RenderExpected(simulator_->TraceEchoes(pose), parameters,
                                                             simulator_->TraceGhosts(pose, parameters));
                         });
  }
  ChangeScale(recording_->info().scale, image);
  return image;
}

void ResidualView::CheckCount(const calib::ParameterValues& values) const {
  if (values.size() != catalog().size())
    throw DataError("values: {} numbers, expected one for each of the {} parameters", values.size(),
                    catalog().size());
}

void ResidualView::WeighAbout(const calib::ParameterValues& values) {
  if (!paper_) throw DataError("weigh_about is for the paper's model: the acoustic model knows its noise");
  CheckCount(values);
  paper_->SetNoise(paper_->NoiseAbout(values));
}

FrameResiduals ResidualView::At(const calib::ParameterValues& values, int frame,
                                const std::vector<std::string>& names) {
  CheckCount(values);
  const auto found = std::find(frames_.begin(), frames_.end(), frame);
  if (found == frames_.end()) throw DataError("frame {} is not among those of this view", frame);
  const int position = static_cast<int>(found - frames_.begin());
  const std::vector<int> active = EntriesOf(names);
  if (acoustic_) {
    std::vector<int> geometric;
    bool moved = false;
    for (std::size_t i = 0; i < catalog().size(); ++i) {
      if (!calib::IsGeometric(catalog()[i])) continue;
      moved = moved || values[i] != point_[i];
      if (std::count(active.begin(), active.end(), static_cast<int>(i)) > 0)
        geometric.push_back(static_cast<int>(i));
    }
    if (moved || geometric != geometric_) {
      acoustic_->Linearise(values, geometric);
      point_ = values;
      geometric_ = std::move(geometric);
    }
  }

  calib::PixelTerms terms;
  const auto wanted =
      active.empty() ? calib::FrameModel::Terms::kResiduals : calib::FrameModel::Terms::kDerivatives;
  if (!model().Evaluate(position, values, active, wanted, terms))
    throw DataError("the model has no value here: is display.db_max above display.db_min?");
  const int bins = model().range_bins();
  const int beams = model().beams();
  FrameResiduals result{.expected = Expected(position, values),
                        .recorded = recording_->ReadFrame(frame).image,
                        .residual = Grid<double>(bins, beams),
                        .counted = Mask(bins, beams),
                        .jacobian = std::move(terms.eta_jacobian),
                        .names = names};
  std::copy(terms.residual.begin(), terms.residual.end(), result.residual.values().begin());
  for (std::size_t pixel = 0; pixel < result.counted.size(); ++pixel)
    result.counted.values()[pixel] = std::uint8_t{model().Counts(position, pixel)};
  if (active.empty()) result.jacobian.clear();
  for (std::size_t i = 0; i < result.jacobian.size(); ++i)
    result.jacobian[i] *= terms.slope[i / active.size()];
  return result;
}

}  // namespace sonarcal::python
