#include "apps/frame_gatherer.h"

#include <fmt/format.h>

#include <utility>

#include "apps/compare_recordings.h"

namespace sonarcal {

FrameGatherer::FrameGatherer(const CompareCommandOptions& options, const RecordingSource& real,
                             const RecordingSource& simulated, const std::vector<int>& frames,
                             std::filesystem::path folder, const SceneGeometry* scene)
    : real_(real),
      folder_(std::move(folder)),
      valid_(ValidInBoth(real.info(), simulated.info())),
      geometry_(scene) {
  for (const int frame : EvenlySpread(frames, options.pictures)) pictured_.insert(frame);
  if (geometry_ != nullptr) by_scene_.emplace(geometry_->material_names());
}

void FrameGatherer::Add(const PolarImage& recorded, const PolarImage& rendered, const FrameMetrics& frame) {
  const Mask& real_object = frame.masks->polar_real;
  const Mask& simulated_object = frame.masks->polar_simulated;
  residuals_.Add(recorded, rendered, real_object, simulated_object, valid_ ? &*valid_ : nullptr);
  if (geometry_ != nullptr) AddGeometry(recorded, rendered, frame);
  if (pictured_.contains(frame.index)) WritePictures(folder_, maker_.Make(recorded, rendered, frame));
}

void FrameGatherer::MoveInto(MetricsReport& metrics) {
  metrics.residuals = std::move(residuals_);
  if (!by_scene_) return;
  metrics.residuals_by_scene = by_scene_->tables();
  if (without_geometry_ > 0) {
    metrics.notes.push_back(fmt::format(
        "{} frames state no pose, or have other axes than the first: they are not in the residuals by "
        "incidence and material",
        without_geometry_));
  }
}

void FrameGatherer::AddGeometry(const PolarImage& recorded, const PolarImage& rendered,
                                const FrameMetrics& frame) {
  const std::optional<Pose> pose = real_.frame_info(frame.index).world_from_sonar;
  if (!pose || !real_.info().sonar.axes.Matches(recorded.axes)) {
    ++without_geometry_;
    return;
  }
  by_scene_->Add(geometry_->At(*pose), recorded, rendered, frame.masks->polar_real,
                 frame.masks->polar_simulated, valid_ ? &*valid_ : nullptr);
}

std::vector<ResidualTable> AllResiduals(const MetricsReport& metrics) {
  std::vector<ResidualTable> tables = {metrics.residuals.ByRange(), metrics.residuals.ByBeam()};
  tables.insert(tables.end(), metrics.residuals_by_scene.begin(), metrics.residuals_by_scene.end());
  return tables;
}

}  // namespace sonarcal
