// What the scene shows each cell of a polar image: the angle at which the beam meets it, and its material. So
// that a comparison can say at which angles and on which materials the simulation is wrong.
//
// A cell that several rays meet has the material that most of their solid angle meets, and the mean angle of
// those rays, weighted by solid angle.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/types/mask.h"
#include "data_io/pose_io.h"
#include "metrics/measures/residuals.h"
#include "metrics/segmentation/object_region.h"
#include "sim/rays/ray_caster.h"

namespace sonarcal::workflow {

struct CellGeometry {
  static constexpr int kNothing = -1;

  Grid<int> material;         // range_bins x beam_count; kNothing where no ray meets anything
  Grid<float> incidence_rad;  // 0 .. pi/2; 0 where nothing is met
};

// Throws DataError where none of the scene's materials is the object.
void CheckObject(const metrics::ObjectSearch& object, const std::vector<std::string>& material_names);

class SceneGeometry {
 public:
  // Throws DataError as RayFan and RayCaster do.
  SceneGeometry(Scene scene, const SonarModel& sonar);
  // Uses the caller's ray caster, which must outlive this.
  SceneGeometry(const sim::RayCaster& caster, const SonarModel& sonar);

  CellGeometry At(const Pose& world_from_sonar) const;

  // The box in which the object is searched in a frame of this pose: around every cell that shows anything of
  // the material within the sonar's elevation beam width. The rays are always the same, so that compare, fit,
  // explain and view search the same box. Throws DataError as CheckObject.
  metrics::PixelBox ObjectBox(const Pose& world_from_sonar, const metrics::ObjectSearch& object) const;

  // Boxes of these poses, by index.
  std::map<int, metrics::PixelBox> ObjectBoxes(const std::vector<data_io::TimedPose>& poses,
                                               const metrics::ObjectSearch& object) const;

  const std::vector<std::string>& material_names() const { return caster_->material_names(); }

 private:
  SceneGeometry(std::unique_ptr<const sim::RayCaster> own, const SonarModel& sonar);

  std::unique_ptr<const sim::RayCaster> own_;  // null where the caster is another's
  const sim::RayCaster* caster_;
  PolarAxes axes_;
  sim::RayFan fan_;
};

// Residuals by incidence angle (classes of 5 degrees) and by material, over the frames that are added.
class GeometryResiduals {
 public:
  explicit GeometryResiduals(const std::vector<std::string>& material_names);

  void Add(const CellGeometry& geometry, const PolarImage& real, const PolarImage& simulated,
           const Mask& real_object, const Mask& simulated_object, const Mask* valid = nullptr);

  // "incidence" and "material", the latter with a last class for cells where nothing is met.
  const std::vector<metrics::ResidualTable>& tables() const { return tables_; }

 private:
  std::vector<metrics::ResidualTable> tables_;
};

}  // namespace sonarcal::workflow
