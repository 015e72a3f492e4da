#include "calib/models/placed_simulators.h"

#include <algorithm>

#include "calib/shapes/object_vertices.h"

namespace sonarcal::calib {
namespace {

// A central difference needs two, and the point between them is asked for again. A caster may hold a large
// scene.
constexpr std::size_t kMaxKept = 4;

// Values of the entries of one kind if any differs from what is declared; empty: all are as declared.
template <typename IsOfKind>
std::vector<double> MovedValues(const IsOfKind& is_of_kind, const std::vector<CatalogEntry>& catalog,
                                const ParameterValues& values) {
  std::vector<double> moved;
  bool any = false;
  for (std::size_t i = 0; i < catalog.size(); ++i) {
    if (!is_of_kind(catalog[i])) continue;
    moved.push_back(values[i]);
    any = any || values[i] != DeclaredValue(catalog[i]);
  }
  return any ? moved : std::vector<double>();
}

// Object of each triangle; -1: none.
std::vector<std::int16_t> PartOfTriangles(Scene scene, const std::vector<std::string>& objects) {
  std::vector<std::int16_t> part(scene.triangles.size(), -1);
  for (std::size_t object = 0; object < objects.size(); ++object) {
    const std::vector<std::size_t> vertices = VerticesOfObject(scene, objects[object]);
    std::vector<char> is_of(scene.vertices_m.size(), 0);
    for (const std::size_t vertex : vertices) is_of[vertex] = 1;
    for (std::size_t i = 0; i < part.size(); ++i) {
      if (is_of[scene.triangles[i][0]] != 0) part[i] = static_cast<std::int16_t>(object);
    }
  }
  return part;
}

bool IsGeometry(const CatalogEntry& entry) {
  return entry.group == ParameterGroup::kGeometry;
}

template <typename T, typename Make>
std::shared_ptr<const T> KeptOr(std::deque<std::pair<std::vector<double>, std::shared_ptr<const T>>>& kept,
                                const std::vector<double>& key, const Make& make) {
  const auto found = std::ranges::find(kept, key, [](const auto& item) { return item.first; });
  if (found != kept.end()) return found->second;
  std::shared_ptr<const T> made = make();
  kept.emplace_back(key, made);
  if (kept.size() > kMaxKept) kept.pop_front();
  return made;
}

}  // namespace

PlacedSimulators::PlacedSimulators(const sim::Simulator& declared, const std::vector<std::string>& objects,
                                   const std::vector<std::string>& outlines)
    : declared_(declared) {
  if (objects.empty() && outlines.empty()) return;
  scene_ = declared.caster().scene();
  // First gives each part vertices of its own, then divides, because both change the numbers of vertices.
  for (const std::string& name : objects) VerticesOfObject(scene_, name);
  for (const std::string& name : outlines) VerticesOfObject(scene_, name);
  forms_ = OutlineForms(scene_, declared.sonar().axes, outlines);
  for (const OutlineForm& form : forms_) DivideForOutline(form, scene_);
  for (const std::string& name : objects) objects_.emplace_back(scene_, name);
  for (const OutlineForm& form : forms_) outlines_.emplace_back(scene_, form);
  part_of_declared_ = PartOfTriangles(declared.caster().scene(), objects);
  part_of_scene_ = PartOfTriangles(scene_, objects);
}

sim::SceneParts PlacedSimulators::PartsOf(const sim::Simulator& simulator) const {
  if (objects_.empty()) return {};
  const bool divided = simulator.caster().scene().triangles.size() != part_of_declared_.size();
  return {.count = static_cast<int>(objects_.size()),
          .of_triangle = divided ? part_of_scene_ : part_of_declared_};
}

std::vector<ObjectPlacement> PlacedSimulators::PlacementsAt(const std::vector<CatalogEntry>& catalog,
                                                            const ParameterValues& values) const {
  std::vector<ObjectPlacement> placements(objects_.size());
  for (std::size_t i = 0; i < catalog.size(); ++i) {
    const CatalogEntry& entry = catalog[i];
    if (entry.group != ParameterGroup::kObject) continue;
    ObjectPlacement& placement = placements[entry.object];
    (entry.index < kPoseSteps ? placement.step(entry.index) : placement.scale(entry.index - kPoseSteps)) =
        values[i];
  }
  return placements;
}

std::shared_ptr<const sim::RayCaster> PlacedSimulators::CasterAt(const std::vector<CatalogEntry>& catalog,
                                                                 const ParameterValues& values) const {
  const Values moved = MovedValues(ChangesScene, catalog, values);
  if (moved.empty()) return declared_.shared_caster();
  return KeptOr<sim::RayCaster>(casters_, moved, [&] {
    const std::vector<ObjectPlacement> placements = PlacementsAt(catalog, values);
    std::vector<std::vector<double>> shapes(outlines_.size());
    for (std::size_t i = 0; i < catalog.size(); ++i) {
      if (catalog[i].group == ParameterGroup::kOutline) shapes[catalog[i].object].push_back(values[i]);
    }
    Scene scene = scene_;
    for (std::size_t i = 0; i < outlines_.size(); ++i) outlines_[i].Reshape(shapes[i], scene);
    for (std::size_t i = 0; i < objects_.size(); ++i) objects_[i].Place(placements[i], scene);
    return std::make_shared<const sim::RayCaster>(std::move(scene), declared_.caster());
  });
}

std::shared_ptr<const sim::Simulator> PlacedSimulators::At(const std::vector<CatalogEntry>& catalog,
                                                           const ParameterValues& values) const {
  Values key = MovedValues(IsGeometry, catalog, values);
  const Values moved = MovedValues(ChangesScene, catalog, values);
  if (key.empty() && moved.empty()) {
    return {std::shared_ptr<const sim::Simulator>(), &declared_};  // not owned
  }
  key.push_back(static_cast<double>(key.size()));  // keeps the two lists apart
  key.insert(key.end(), moved.begin(), moved.end());
  const std::scoped_lock lock(mutex_);
  return KeptOr<sim::Simulator>(simulators_, key, [&] {
    SonarModel sonar = declared_.sonar();
    sonar.axes = Corrected(sonar.axes, GeometryOf(catalog, values));
    return std::make_shared<const sim::Simulator>(CasterAt(catalog, values), std::move(sonar),
                                                  declared_.options());
  });
}

}  // namespace sonarcal::calib
