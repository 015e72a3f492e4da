#include "apps/workflow/frame_gatherer.h"

#include <fmt/format.h>

#include <utility>

#include "apps/workflow/compare.h"

namespace sonarcal::workflow {

FrameGatherer::FrameGatherer(const RecordingSource& real, const RecordingSource& simulated,
                             const SceneGeometry* scene)
    : real_(real), valid_(ValidInBoth(real.info(), simulated.info())), geometry_(scene) {
  if (geometry_ != nullptr) by_scene_.emplace(geometry_->material_names());
}

void FrameGatherer::Add(const PolarImage& recorded, const PolarImage& rendered,
                        const metrics::FrameMetrics& frame) {
  const Mask& real_object = frame.masks->polar_real;
  const Mask& simulated_object = frame.masks->polar_simulated;
  residuals_.Add(recorded, rendered, real_object, simulated_object, valid_ ? &*valid_ : nullptr);
  if (geometry_ != nullptr) AddGeometry(recorded, rendered, frame);
}

void FrameGatherer::MoveInto(metrics::MetricsReport& metrics) {
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
                                const metrics::FrameMetrics& frame) {
  const std::optional<Pose> pose = real_.frame_info(frame.index).world_from_sonar;
  if (!pose || !real_.info().sonar.axes.Matches(recorded.axes)) {
    ++without_geometry_;
    return;
  }
  by_scene_->Add(geometry_->At(*pose), recorded, rendered, frame.masks->polar_real,
                 frame.masks->polar_simulated, valid_ ? &*valid_ : nullptr);
}

std::vector<metrics::ResidualTable> AllResiduals(const metrics::MetricsReport& metrics) {
  std::vector<metrics::ResidualTable> tables = {metrics.residuals.ByRange(), metrics.residuals.ByBeam()};
  tables.insert(tables.end(), metrics.residuals_by_scene.begin(), metrics.residuals_by_scene.end());
  return tables;
}

}  // namespace sonarcal::workflow
