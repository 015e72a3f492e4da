// Texts and values that several exports share.
#pragma once

#include <map>
#include <string>

#include "apps/export/cosine_law.h"
#include "apps/export/export_account.h"

namespace sonarcal::exporting {

// Fits the laws of all materials for one exponent of the cosine.
std::map<std::string, CosineLaw> FitCosineLaws(const ParameterSet& parameters, double exponent);

// Scales the laws so that the strongest is 1, for simulators whose images have no absolute level.
std::map<std::string, double> RelativeReflectivities(const std::map<std::string, CosineLaw>& laws);

// Accounts for the curves, each of which has become one number at `target` ("{}" is the name of the
// material): "... k cos^n, up to 3 dB off; ...". `also` ends the sentence.
void AccountForMaterials(const std::map<std::string, CosineLaw>& laws, const std::string& target,
                         const std::string& also, ExportAccount& account);

// Returns the standard deviation of a pixel's power divided by its mean: 1 / sqrt(looks), and 0 for the
// paper's model, which has no speckle.
double SpeckleSpread(const ParameterSet& parameters);

// Returns the power of the noise floor at range_max_m divided by that at full scale; 0 without a floor.
// Treats every display as logarithmic. Throws DataError if a noise taper does not have one value per beam.
double FloorOfFullScale(const ExportSource& source);

// Returns sigma of a Rayleigh law whose mean is that floor.
double RayleighOfFloor(const ExportSource& source);

// For simulators that receive nothing beyond the width of the beam, and everything within it equally.
inline constexpr const char* kHardEdge = "a hard edge at our half-power width";

// Account for the elevation beam width and for the noise floor, from any source of these values.
void AccountForElevation(const std::string& target, const std::string& how, ExportAccount& account);
void AccountForFloor(const std::string& target, const std::string& how, ExportAccount& account);

// Accounts for the other parameters, by group: no simulator here has them. Must be called last.
void AccountForTheRest(const std::string& simulator, ExportAccount& account);

}  // namespace sonarcal::exporting
