// Material and incidence angle behind each pixel of a polar image. A comparison uses them to report at which
// angles and on which materials the simulation is wrong.
//
// A pixel with several rays has the material with the largest solid angle, and the mean incidence of the rays
// on that material, weighted by solid angle.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/types/mask.h"
#include "core/types/pose.h"
#include "core/types/recording.h"
#include "metrics/json/metrics_json.h"
#include "metrics/measures/residuals.h"
#include "metrics/segmentation/object_region.h"
#include "sim/rays/ray_caster.h"

namespace sonarcal::workflow {

struct CellGeometry {
  static constexpr int kNothing = -1;

  Grid<int> material;         // range_bins x beam_count; kNothing where no ray meets anything
  Grid<float> incidence_rad;  // 0 .. pi/2; 0 where no ray meets anything
};

// Throws DataError if no material of the scene has the name of the object.
void CheckObject(const metrics::ObjectSearch& object, const std::vector<std::string>& material_names);

class SceneGeometry {
 public:
  // Throws DataError as RayFan and RayCaster do.
  SceneGeometry(Scene scene, const SonarModel& sonar);
  // Uses the caller's ray caster, which must outlive this.
  SceneGeometry(const sim::RayCaster& caster, const SonarModel& sonar);

  CellGeometry At(const Pose& world_from_sonar) const;

  // Returns the search box of the object in a frame from this pose: around every pixel that shows any of its
  // material within the elevation beam width of the sonar. The rays are always the same, so that compare,
  // fit, explain and view search the same box. Throws DataError as CheckObject.
  metrics::PixelBox ObjectBox(const Pose& world_from_sonar, const metrics::ObjectSearch& object) const;

  const std::vector<std::string>& material_names() const { return caster_->material_names(); }

 private:
  SceneGeometry(std::unique_ptr<const sim::RayCaster> own, const SonarModel& sonar);

  std::unique_ptr<const sim::RayCaster> own_;  // null if the caller owns the caster
  const sim::RayCaster* caster_;
  PolarAxes axes_;
  sim::RayFan fan_;
};

// Pose from which a comparison sees the scene in a frame: that of the simulation, otherwise the recorded one.
// Absent if neither recording states one.
std::optional<Pose> PoseInScene(const RecordingSource& real, const RecordingSource& simulated, int frame);

// Residuals by incidence angle (classes of 5 degrees) and by material, over all added frames.
class GeometryResiduals {
 public:
  explicit GeometryResiduals(const std::vector<std::string>& material_names);

  void Add(const CellGeometry& geometry, const PolarImage& real, const PolarImage& simulated,
           const Mask& real_object, const Mask& simulated_object, const Mask* valid = nullptr);

  // Tables "incidence" and "material". The latter ends with a class for pixels where no ray meets anything.
  const std::vector<metrics::ResidualTable>& tables() const { return tables_; }

 private:
  std::vector<metrics::ResidualTable> tables_;
};

// Residuals of each pair of compared frames over range, azimuth and, if the scene is known, incidence and
// material.
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
  const RecordingSource& simulated_;
  std::optional<Mask> valid_;
  metrics::ResidualCollector residuals_;
  const SceneGeometry* geometry_;
  std::optional<GeometryResiduals> by_scene_;
  int without_geometry_ = 0;
};

// Returns all residual tables of a report.
std::vector<metrics::ResidualTable> AllResiduals(const metrics::MetricsReport& metrics);

}  // namespace sonarcal::workflow
