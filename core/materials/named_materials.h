// Named materials: what is known of a backscatter curve before a fit. Each is a wide prior of the parameters
// of GSAB (core/types/parameters.h), never a value.
//
//   for (const NamedMaterial& material : BuiltInMaterials()) ...
//   const NamedMaterial& sand = FindMaterial("sand:medium", BuiltInMaterials());
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/types/parameters.h"

namespace sonarcal {

// Fit that a material comes from.
struct MaterialOrigin {
  std::string recording;
  bool synthetic = false;
  std::string program;  // name and version

  bool operator==(const MaterialOrigin&) const = default;
};

struct NamedMaterial {
  std::string name;                        // "sand:medium"
  EchoModel model = EchoModel::kAcoustic;  // the amplitudes of the paper's model have another meaning
  GsabParameters<double> centre;
  // One standard deviation about the centre: of D itself, and as a factor on each of the others, which have a
  // normal law of their logarithm.
  GsabParameters<double> spread;
  // Level to which A, C and E refer: source level plus gain, in the paper's model source level minus db_min.
  // Absent: they are backscattering strength per unit area, so that an absolute level is the sonar's own.
  std::optional<double> level_db = {};
  double frequency_min_hz = 0.0;  // band of the source
  double frequency_max_hz = 0.0;
  std::string source;
  std::string comment;
  std::optional<MaterialOrigin> origin = {};  // absent for materials that no fit of this program made

  bool operator==(const NamedMaterial&) const = default;
};

// Materials of the literature, in the order of `sonarcal materials --list`.
const std::vector<NamedMaterial>& BuiltInMaterials();

// Throws DataError with the nearest name, or with all names, if there is none of this name.
const NamedMaterial& FindMaterial(std::string_view name, const std::vector<NamedMaterial>& materials);

// Centre of the material in the units of these parameters: A, C and E scaled from the material's level to
// theirs. Throws DataError if the material is one of another image model.
GsabParameters<double> CentreFor(const NamedMaterial& material, const ParameterSet& parameters);

// Level to which A, C and E of these parameters refer, see NamedMaterial::level_db.
double ReferenceLevelDb(const ParameterSet& parameters);

// Peak of the echo of a rough surface at normal incidence, as backscattering strength per unit area in power:
// R^2 / (8 pi tan(slope)^2), with R = (Z - 1) / (Z + 1). It is the Kirchhoff approximation at high frequency
// for slopes of a normal law; B of the curve then is the RMS slope. `impedance_ratio`: Z, density times sound
// speed over that of water, above 0.
double SpecularAmplitude(double impedance_ratio, double rms_slope_deg);

}  // namespace sonarcal
