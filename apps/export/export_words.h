// What several exports say alike.
#pragma once

#include <map>
#include <string>

#include "apps/export/cosine_law.h"
#include "apps/export/export_account.h"

namespace sonarcal::exporting {

// Laws of all materials for one exponent of the cosine.
std::map<std::string, CosineLaw> FitCosineLaws(const ParameterSet& parameters, double exponent);

// The laws with the strongest at 1, for simulators whose images have no absolute level.
std::map<std::string, double> RelativeReflectivities(const std::map<std::string, CosineLaw>& laws);

// Says that each curve has become one number at `target` ("{}" is the material's name): "... k cos^n, up to 3
// dB off; ...". `also` ends the sentence.
void AccountForMaterials(const std::map<std::string, CosineLaw>& laws, const std::string& target,
                         const std::string& also, ExportAccount& account);

// The spread of a pixel's power about its mean as a part of the mean: 1 / sqrt(looks), and 0 for the paper's
// model, which has no speckle.
double SpeckleSpread(const ParameterSet& parameters);

// The floor's power at range_max_m as a part of that shown as full scale: 0 without a floor. Of the log
// display, or as if it were one.
double FloorOfFullScale(const ExportSource& source);

// sigma of a Rayleigh law whose mean is that floor.
double RayleighOfFloor(const ExportSource& source);

// Of simulators that hear nothing beyond the beam's width, and all of it alike.
inline constexpr const char* kHardEdge = "a hard edge at our half-power width";

// Say what became of the beam's width in elevation, and of the floor of noise, wherever either comes from.
void AccountForElevation(const std::string& target, const std::string& how, ExportAccount& account);
void AccountForFloor(const std::string& target, const std::string& how, ExportAccount& account);

// What no simulator here has: the rest of the parameters, by group. Called last.
void AccountForTheRest(const std::string& simulator, ExportAccount& account);

}  // namespace sonarcal::exporting
