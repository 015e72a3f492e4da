// Simulators for values of the sonar's geometry and of the placement of objects. Those of the last few values are
// kept: a fit asks for the same ones several times.
#pragma once

#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "calib/parameters/object_placement.h"
#include "calib/parameters/parameter_catalog.h"
#include "sim/simulator.h"

namespace sonarcal::calib {

class PlacedSimulators {
 public:
  // `declared` must outlive this. Throws DataError for an object that is not in the scene.
  PlacedSimulators(const sim::Simulator& declared, const std::vector<std::string>& objects);

  const std::vector<std::string>& objects() const { return names_; }

  // Returns the simulator for the values of a catalog with these objects. Builds a ray caster on all cores if an
  // object moved, so it must not be called from within a parallel loop.
  std::shared_ptr<const sim::Simulator> At(const std::vector<CatalogEntry>& catalog,
                                           const ParameterValues& values) const;

 private:
  using Values = std::vector<double>;
  template <typename T>
  using Kept = std::deque<std::pair<Values, std::shared_ptr<const T>>>;  // newest last

  std::shared_ptr<const sim::RayCaster> CasterAt(const std::vector<CatalogEntry>& catalog,
                                                 const ParameterValues& values) const;

  const sim::Simulator& declared_;
  std::vector<std::string> names_;
  Scene scene_;  // as declared; empty without objects
  std::vector<PlaceableObject> objects_;
  mutable std::mutex mutex_;
  mutable Kept<sim::RayCaster> casters_;
  mutable Kept<sim::Simulator> simulators_;
};

}  // namespace sonarcal::calib
