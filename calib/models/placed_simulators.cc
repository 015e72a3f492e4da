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
}

std::shared_ptr<const sim::RayCaster> PlacedSimulators::CasterAt(const std::vector<CatalogEntry>& catalog,
                                                                 const ParameterValues& values) const {
  const Values moved = MovedValues(ChangesScene, catalog, values);
  if (moved.empty()) return declared_.shared_caster();
  return KeptOr<sim::RayCaster>(casters_, moved, [&] {
    std::vector<ObjectPlacement> placements(objects_.size());
    std::vector<std::vector<double>> shapes(outlines_.size());
    for (std::size_t i = 0; i < catalog.size(); ++i) {
      const CatalogEntry& entry = catalog[i];
      if (entry.group == ParameterGroup::kOutline) shapes[entry.object].push_back(values[i]);
      if (entry.group != ParameterGroup::kObject) continue;
      ObjectPlacement& placement = placements[entry.object];
      (entry.index < kPoseSteps ? placement.step(entry.index) : placement.scale(entry.index - kPoseSteps)) =
          values[i];
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
