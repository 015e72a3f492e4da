// Uses the installed rooms through their headers, as a program of someone else would.
#include <iostream>

#include "core/types/parameters.h"
#include "core/types/scene.h"
#include "sim/physics/gsab.h"

int main() {
  sonarcal::ParameterSet parameters;
  parameters.materials["default"] = {};
  const double level_db = sonarcal::GsabDb(parameters.Material("floor").gsab, 0.0);
  std::cout << "backscatter at normal incidence: " << level_db << " dB\n";

  const sonarcal::Scene triangle{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}, {0}, {"floor"}};
  triangle.Validate("triangle");
  return level_db > 0.0 ? 0 : 1;
}
