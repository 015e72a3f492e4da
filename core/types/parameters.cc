#include "core/types/parameters.h"

#include "core/types/error.h"

namespace sonarcal {

const MaterialParameters& ParameterSet::Material(const std::string& name) const {
  auto found = materials.find(name);
  if (found == materials.end()) found = materials.find("default");
  if (found == materials.end()) {
    throw DataError("no parameters for material '{}', and no material 'default' to use instead", name);
  }
  return found->second;
}

}  // namespace sonarcal
