// What `compare` gathers from each pair of frames beside its figures: residuals over range, azimuth and,
// where the scene is known, incidence and material; and pictures of some.
#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <vector>

#include "apps/compare_command.h"
#include "apps/comparison_pictures.h"
#include "apps/scene_geometry.h"
#include "core/types/recording.h"
#include "metrics/json/metrics_json.h"

namespace sonarcal {

class FrameGatherer {
 public:
  // Pictures go to `folder`. `scene` must outlive this; null: there are no residuals by incidence and
  // material.
  FrameGatherer(const CompareCommandOptions& options, const RecordingSource& real,
                const RecordingSource& simulated, const std::vector<int>& frames,
                std::filesystem::path folder, const SceneGeometry* scene);

  // `frame.masks` must be set.
  void Add(const PolarImage& recorded, const PolarImage& rendered, const FrameMetrics& frame);

  void MoveInto(MetricsReport& metrics);

 private:
  void AddGeometry(const PolarImage& recorded, const PolarImage& rendered, const FrameMetrics& frame);

  const RecordingSource& real_;
  std::filesystem::path folder_;
  std::optional<Mask> valid_;
  std::set<int> pictured_;
  PictureMaker maker_;
  ResidualCollector residuals_;
  const SceneGeometry* geometry_;
  std::optional<GeometryResiduals> by_scene_;
  int without_geometry_ = 0;
};

// All tables of residuals that a report holds.
std::vector<ResidualTable> AllResiduals(const MetricsReport& metrics);

}  // namespace sonarcal
