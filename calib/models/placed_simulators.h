// Simulators for values of the sonar's geometry and of the placement and outlines of objects. Those of the
// last few values are kept: a fit asks for the same ones several times.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "calib/parameters/object_placement.h"
#include "calib/parameters/parameter_catalog.h"
#include "calib/shapes/object_outline.h"
#include "sim/acoustic/echo_slopes.h"
#include "sim/simulator.h"

namespace sonarcal::calib {

class PlacedSimulators {
 public:
  // `declared` must outlive this. `outlines`: names of the parts whose outline may be another. Throws
  // DataError for an object that is not in the scene.
  PlacedSimulators(const sim::Simulator& declared, const std::vector<std::string>& objects,
                   const std::vector<std::string>& outlines = {});

  const std::vector<OutlineForm>& outlines() const { return forms_; }
  const std::vector<PlaceableObject>& objects() const { return objects_; }

  // Objects as parts of the scene of a simulator that At returned.
  sim::SceneParts PartsOf(const sim::Simulator& simulator) const;
  // Placement of each object at the values of a catalog.
  std::vector<ObjectPlacement> PlacementsAt(const std::vector<CatalogEntry>& catalog,
                                            const ParameterValues& values) const;

  // Returns the simulator for the values of a catalog with these objects. Builds a ray caster on all cores if
  // an object moved, so it must not be called from within a parallel loop.
  std::shared_ptr<const sim::Simulator> At(const std::vector<CatalogEntry>& catalog,
                                           const ParameterValues& values) const;

 private:
  using Values = std::vector<double>;
  template <typename T>
  using Kept = std::deque<std::pair<Values, std::shared_ptr<const T>>>;  // newest last

  std::shared_ptr<const sim::RayCaster> CasterAt(const std::vector<CatalogEntry>& catalog,
                                                 const ParameterValues& values) const;

  const sim::Simulator& declared_;
  Scene scene_;  // as declared, divided for the outlines; empty without objects and outlines
  std::vector<PlaceableObject> objects_;
  std::vector<std::int16_t> part_of_declared_;  // object of each triangle of the declared scene; -1: none
  std::vector<std::int16_t> part_of_scene_;     // of `scene_`, which has more triangles if it is divided
  std::vector<OutlineForm> forms_;
  std::vector<ObjectOutline> outlines_;
  mutable std::mutex mutex_;
  mutable Kept<sim::RayCaster> casters_;
  mutable Kept<sim::Simulator> simulators_;
};

}  // namespace sonarcal::calib
