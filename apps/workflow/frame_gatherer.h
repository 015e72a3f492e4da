// Residuals of each pair of compared frames over range, azimuth and, if the scene is known, incidence and
// material.
#pragma once

#include <optional>
#include <vector>

#include "apps/workflow/scene_geometry.h"
#include "core/types/recording.h"
#include "metrics/json/metrics_json.h"

namespace sonarcal::workflow {

class FrameGatherer {
 public:
  // `scene` must outlive this object. Null: no residuals by incidence and material.
  FrameGatherer(const RecordingSource& real, const RecordingSource& simulated, const SceneGeometry* scene);

  // `frame.masks` must be set.
  void Add(const PolarImage& recorded, const PolarImage& rendered, const metrics::FrameMetrics& frame);

  void MoveInto(metrics::MetricsReport& metrics);

 private:
  void AddGeometry(const PolarImage& recorded, const PolarImage& rendered,
                   const metrics::FrameMetrics& frame);

  const RecordingSource& real_;
  std::optional<Mask> valid_;
  metrics::ResidualCollector residuals_;
  const SceneGeometry* geometry_;
  std::optional<GeometryResiduals> by_scene_;
  int without_geometry_ = 0;
};

// Returns all residual tables of a report.
std::vector<metrics::ResidualTable> AllResiduals(const metrics::MetricsReport& metrics);

}  // namespace sonarcal::workflow
