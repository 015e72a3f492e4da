#include "calib/models/placed_simulators.h"

#include <algorithm>

namespace sonarcal::calib {
namespace {

// A central difference needs two, and the point between them is asked for again. A caster may hold a large scene.
constexpr std::size_t kMaxKept = 4;

// Values of the entries of a group that differ from what is declared; empty: all are as declared.
std::vector<double> MovedValues(ParameterGroup group, const std::vector<CatalogEntry>& catalog,
                                const ParameterValues& values) {
  std::vector<double> moved;
  bool any = false;
  for (std::size_t i = 0; i < catalog.size(); ++i) {
    if (catalog[i].group != group) continue;
    moved.push_back(values[i]);
    any = any || values[i] != DeclaredValue(catalog[i]);
  }
  return any ? moved : std::vector<double>();
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

PlacedSimulators::PlacedSimulators(const sim::Simulator& declared, const std::vector<std::string>& objects)
    : declared_(declared), names_(objects) {
  if (objects.empty()) return;
  scene_ = declared.caster().scene();
  for (const std::string& name : objects) objects_.emplace_back(scene_, name);
}

std::shared_ptr<const sim::RayCaster> PlacedSimulators::CasterAt(const std::vector<CatalogEntry>& catalog,
                                                                 const ParameterValues& values) const {
  const Values moved = MovedValues(ParameterGroup::kObject, catalog, values);
  if (moved.empty()) return declared_.shared_caster();
  return KeptOr<sim::RayCaster>(casters_, moved, [&] {
    std::vector<ObjectPlacement> placements(objects_.size());
    for (std::size_t i = 0; i < catalog.size(); ++i) {
      const CatalogEntry& entry = catalog[i];
      if (entry.group != ParameterGroup::kObject) continue;
      ObjectPlacement& placement = placements[entry.object];
      (entry.index < kPoseSteps ? placement.step(entry.index) : placement.scale(entry.index - kPoseSteps)) =
          values[i];
    }
    Scene scene = scene_;
    for (std::size_t i = 0; i < objects_.size(); ++i) objects_[i].Place(placements[i], scene);
    return std::make_shared<const sim::RayCaster>(std::move(scene), declared_.caster());
  });
}

std::shared_ptr<const sim::Simulator> PlacedSimulators::At(const std::vector<CatalogEntry>& catalog,
                                                           const ParameterValues& values) const {
  Values key = MovedValues(ParameterGroup::kGeometry, catalog, values);
  const Values moved = MovedValues(ParameterGroup::kObject, catalog, values);
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
