#include "apps/workflow/scene_geometry.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "apps/workflow/assumptions.h"
#include "apps/workflow/compare.h"
#include "core/text/nearest_word.h"
#include "core/types/error.h"
#include "core/types/units.h"
#include "sim/rays/trace.h"

namespace sonarcal::workflow {
namespace {

constexpr double kClassDeg = 5.0;
constexpr int kClasses = 18;
constexpr int kColumnsPerBeam = 2;
constexpr int kRows = 600;
constexpr const char* kNothingName = "(nothing met)";

sim::RayFanOptions FanOptionsFor(const SonarModel& sonar) {
  sim::RayFanOptions options;
  options.sampling = sim::Sampling::kBeams;
  options.cols = kColumnsPerBeam * sonar.axes.beam_count();
  options.rows = kRows;
  if (!(sonar.elevation_beam_width_deg > 0.0)) options.elevation_span_deg = kAssumedElevationWidthDeg;
  return options;
}

int BinOf(double range_m, const PolarAxes& axes) {
  return std::clamp(axes.BinAt(range_m), 0, axes.range_bins - 1);
}

}  // namespace

void CheckObject(const metrics::ObjectSearch& object, const std::vector<std::string>& material_names) {
  if (std::find(material_names.begin(), material_names.end(), object.material) != material_names.end())
    return;
  throw DataError("the scene has no material '{}' to be the object{}", object.material,
                  ExpectedWord(object.material, material_names));
}

SceneGeometry::SceneGeometry(Scene scene, const SonarModel& sonar)
    : SceneGeometry(std::make_unique<const sim::RayCaster>(std::move(scene)), sonar) {}

SceneGeometry::SceneGeometry(std::unique_ptr<const sim::RayCaster> own, const SonarModel& sonar)
    : own_(std::move(own)), caster_(own_.get()), axes_(sonar.axes), fan_(sonar, FanOptionsFor(sonar)) {}

SceneGeometry::SceneGeometry(const sim::RayCaster& caster, const SonarModel& sonar)
    : caster_(&caster), axes_(sonar.axes), fan_(sonar, FanOptionsFor(sonar)) {}

CellGeometry SceneGeometry::At(const Pose& world_from_sonar) const {
  const sim::EchoList echoes = sim::Trace(*caster_, fan_, world_from_sonar, axes_);
  const auto materials = static_cast<int>(material_names().size());
  // Solid angle, and solid angle times incidence, of each material in each pixel.
  std::vector<Grid<float>> solid_angle(materials, Grid<float>(axes_.range_bins, axes_.beam_count()));
  std::vector<Grid<float>> weighted = solid_angle;
  for (std::size_t i = 0; i < echoes.size(); ++i) {
    const int row = BinOf(echoes.range_m[i], axes_);
    const int col = echoes.Beam(i);
    solid_angle[echoes.material[i]](row, col) += echoes.solid_angle_sr[i];
    weighted[echoes.material[i]](row, col) += echoes.solid_angle_sr[i] * echoes.incidence_rad[i];
  }
  CellGeometry geometry{.material = Grid<int>(axes_.range_bins, axes_.beam_count(), CellGeometry::kNothing),
                        .incidence_rad = Grid<float>(axes_.range_bins, axes_.beam_count())};
  for (std::size_t cell = 0; cell < geometry.material.size(); ++cell) {
    float most = 0.0F;
    for (int material = 0; material < materials; ++material) {
      const float angle = solid_angle[material].values()[cell];
      if (angle <= most) continue;
      most = angle;
      geometry.material.values()[cell] = material;
      geometry.incidence_rad.values()[cell] = weighted[material].values()[cell] / angle;
    }
  }
  return geometry;
}

metrics::PixelBox SceneGeometry::ObjectBox(const Pose& world_from_sonar,
                                           const metrics::ObjectSearch& object) const {
  CheckObject(object, material_names());
  const sim::EchoList echoes = sim::Trace(*caster_, fan_, world_from_sonar, axes_);
  Mask shown(axes_.range_bins, axes_.beam_count());
  for (std::size_t i = 0; i < echoes.size(); ++i) {
    if (material_names()[echoes.material[i]] == object.material)
      shown(BinOf(echoes.range_m[i], axes_), echoes.Beam(i)) = 1;
  }
  return metrics::BoxOf(shown, object.margin);
}

std::optional<Pose> PoseInScene(const RecordingSource& real, const RecordingSource& simulated, int frame) {
  if (frame < simulated.frame_count()) {
    if (const std::optional<Pose> pose = simulated.frame_info(frame).world_from_sonar) return pose;
  }
  return real.frame_info(frame).world_from_sonar;
}

GeometryResiduals::GeometryResiduals(const std::vector<std::string>& material_names) {
  metrics::ResidualTable by_incidence{.by = "incidence", .unit = "degrees", .classes = {}};
  for (int i = 0; i < kClasses; ++i) {
    by_incidence.classes.push_back({.name = {}, .from = i * kClassDeg, .to = (i + 1) * kClassDeg});
  }
  metrics::ResidualTable by_material{.by = "material", .unit = {}, .classes = {}};
  for (const std::string& name : material_names) {
    by_material.classes.push_back({.name = name, .from = std::nullopt});
  }
  by_material.classes.push_back({.name = kNothingName, .from = std::nullopt});
  tables_ = {std::move(by_incidence), std::move(by_material)};
}

void GeometryResiduals::Add(const CellGeometry& geometry, const PolarImage& real, const PolarImage& simulated,
                            const Mask& real_object, const Mask& simulated_object, const Mask* valid) {
  SONARCAL_CHECK(
      geometry.material.rows() == real.value.rows() && geometry.material.cols() == real.value.cols(),
      "geometry of {} x {} cells, image {} x {}", geometry.material.rows(), geometry.material.cols(),
      real.value.rows(), real.value.cols());
  const auto incidence_class = [&](int bin, int beam) {
    if (geometry.material(bin, beam) == CellGeometry::kNothing) return -1;
    const double angle_deg = DegFromRad(static_cast<double>(geometry.incidence_rad(bin, beam)));
    return std::clamp(static_cast<int>(angle_deg / kClassDeg), 0, kClasses - 1);
  };
  const auto material_class = [&](int bin, int beam) {
    const int material = geometry.material(bin, beam);
    return material == CellGeometry::kNothing ? static_cast<int>(tables_[1].classes.size()) - 1 : material;
  };
  metrics::ResidualCollector::AddTo(tables_[0], incidence_class, real, simulated, real_object,
                                    simulated_object, valid);
  metrics::ResidualCollector::AddTo(tables_[1], material_class, real, simulated, real_object,
                                    simulated_object, valid);
}

FrameGatherer::FrameGatherer(const RecordingSource& real, const RecordingSource& simulated,
                             const SceneGeometry* scene)
    : real_(real),
      simulated_(simulated),
      valid_(ValidInBoth(real.info(), simulated.info())),
      geometry_(scene) {
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
  const std::optional<Pose> pose = PoseInScene(real_, simulated_, frame.index);
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
