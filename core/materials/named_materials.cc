#include "core/materials/named_materials.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/text/nearest_word.h"
#include "core/types/error.h"
#include "core/types/units.h"
#include "core/types/words.h"

namespace sonarcal {
namespace {

struct Band {
  double min_hz;
  double max_hz;
};

// One line of the list. A follows from the impedance and the slope. The spread is at least as wide as the
// default prior of a fit: ten in power, e in width, 1 in D.
struct Entry {
  const char* name;
  double density_ratio;      // over that of water
  double sound_speed_ratio;  // likewise
  double b_deg;              // RMS slope of the surface
  double c_db;
  double d;
  double e_db;
  double f_deg;
  double amplitude_spread_db;
  Band band;
  const char* source;
  const char* note;
  const char* basis;  // end of the comment
};

constexpr const char* kSediments =
    "density and sound speed ratios: APL-UW High-Frequency Ocean Environmental Acoustic Models Handbook, "
    "TR 9407 (1994), bottom model of 10 to 100 kHz";
constexpr const char* kTextbook = "density and sound speed: usual textbook values";

// Ends of the comments.
constexpr const char* kSedimentBasis =
    "A follows from density and sound speed by the Kirchhoff approximation. The slope B, C to F and all "
    "spreads are our judgement: no calibrated curve above 400 kHz is known to us (calibrated echo sounders "
    "reach 350 kHz: Wendelboe et al., JASA Express Letters 3, 026001, 2023).";
constexpr const char* kObjectBasis =
    "A follows from density and sound speed by the Kirchhoff approximation. The slope B, C to F and all "
    "spreads are our judgement: no published curve is known to us. The band is where the material is meant "
    "to be used.";

constexpr Band kReport = {10e3, 100e3};
constexpr Band kMeant = {0.1e6, 3e6};
constexpr double kSedimentDb = 13.0;
constexpr double kObjectDb = 15.0;

constexpr Entry kEntries[] = {
    {"clay", 1.145, 0.98, 6, -32, 2, -27, 15, kSedimentDb, kReport, kSediments, "", kSedimentBasis},
    {"silt", 1.149, 0.9873, 6, -29, 2, -25, 15, kSedimentDb, kReport, kSediments, "", kSedimentBasis},
    {"sand:fine", 1.451, 1.1072, 7, -26, 2, -22, 15, kSedimentDb, kReport, kSediments, "", kSedimentBasis},
    {"sand:medium", 1.845, 1.1782, 8, -23, 2, -20, 15, kSedimentDb, kReport, kSediments, "", kSedimentBasis},
    {"sand:coarse", 2.231, 1.2503, 8, -20, 2, -17, 18, kSedimentDb, kReport, kSediments, "", kSedimentBasis},
    {"gravel", 2.492, 1.337, 10, -17, 1.5, -14, 20, kSedimentDb, kReport, kSediments,
     "Sandy gravel of the report. ", kSedimentBasis},
    {"cobble", 2.5, 1.8, 12, -15, 1.5, -13, 25, kSedimentDb, kReport, kSediments,
     "At short range a cobble fills many pixels: then give it a mesh of its own. ", kSedimentBasis},
    {"rock",
     2.5,
     2.3,
     10,
     -27,
     2,
     -20,
     20,
     kObjectDb,
     {0.5e3, 100e3},
     "C and D: Lambert's law with -27 dB, Mackenzie, J. Acoust. Soc. Am. 33 (1961), 0.5 and 1 kHz; density "
     "and sound speed: usual textbook values",
     "Rough rock may be 15 dB stronger at high frequency. ",
     kSedimentBasis},
    {"concrete", 2.4, 2.5, 4, -27, 1.5, -22, 15, kObjectDb, kMeant, kTextbook, "", kObjectBasis},
    {"steel", 7.85, 3.95, 3, -30, 1.5, -22, 12, kObjectDb, kMeant, kTextbook,
     "A plate. Rust, growth and welds change C and E more than the metal does. ", kObjectBasis},
    {"rubber", 1.15, 1.03, 4, -33, 1.5, -28, 15, kObjectDb, kMeant, kTextbook,
     "Compounds differ widely: some match water, filled ones reflect. ", kObjectBasis},
    {"water-surface", 1.2e-3, 0.23, 5, -35, 1.5, -25, 15, kObjectDb, kMeant, kTextbook,
     "Seen from below, with small waves. The slope follows the wind, and bubbles raise C. ", kObjectBasis},
};

GsabParameters<double> WideSpread(double amplitude_spread_db) {
  const double factor = PowerFromDb(amplitude_spread_db);
  return {
      .a = factor, .b_deg = std::numbers::e, .c = factor, .d = 1.0, .e = factor, .f_deg = std::numbers::e};
}

NamedMaterial MaterialOf(const Entry& entry) {
  return {.name = entry.name,
          .centre = {.a = SpecularAmplitude(entry.density_ratio * entry.sound_speed_ratio, entry.b_deg),
                     .b_deg = entry.b_deg,
                     .c = PowerFromDb(entry.c_db),
                     .d = entry.d,
                     .e = PowerFromDb(entry.e_db),
                     .f_deg = entry.f_deg},
          .spread = WideSpread(entry.amplitude_spread_db),
          .frequency_min_hz = entry.band.min_hz,
          .frequency_max_hz = entry.band.max_hz,
          .source = entry.source,
          .comment = std::string(entry.note) + entry.basis};
}

// Table 4 of the paper. Its amplitudes hold for black 50 dB below the source level, as the paper's scenes are
// drawn (sim/paper/paper_values.h); the paper does not state this level.
NamedMaterial PaperMaterial() {
  return {.name = "park-2024",
          .model = EchoModel::kPaper,
          .centre = {},
          .spread = WideSpread(10.0),
          .level_db = 50.0,
          .frequency_min_hz = 900e3,
          .frequency_max_hz = 900e3,
          .source = "Park, Sensors 24 (2024) 7835, Table 4, one set for every surface",
          .comment =
              "For the paper's model only: target strength of one ray, not of an area. The paper does "
              "not say where its values come from. Level and spreads are our judgement."};
}

std::vector<NamedMaterial> MakeBuiltIn() {
  std::vector<NamedMaterial> materials;
  for (const Entry& entry : kEntries) materials.push_back(MaterialOf(entry));
  materials.push_back(PaperMaterial());
  return materials;
}

}  // namespace

double ReferenceLevelDb(const ParameterSet& parameters) {
  return parameters.source_level_db +
         (parameters.model == EchoModel::kPaper ? -parameters.display.db_min : parameters.receiver.gain_db);
}

GsabParameters<double> CentreFor(const NamedMaterial& material, const ParameterSet& parameters) {
  const bool paper = parameters.model == EchoModel::kPaper;
  if (paper != (material.model == EchoModel::kPaper)) {
    throw DataError("material '{}' is one of the {} model, the parameters are those of the {} model",
                    material.name, ToString(material.model), ToString(parameters.model));
  }
  GsabParameters<double> centre = material.centre;
  if (!material.level_db) return centre;
  const double factor = PowerFromDb(*material.level_db - ReferenceLevelDb(parameters));
  centre.a *= factor;
  centre.c *= factor;
  centre.e *= factor;
  return centre;
}

double SpecularAmplitude(double impedance_ratio, double rms_slope_deg) {
  const double reflection = (impedance_ratio - 1.0) / (impedance_ratio + 1.0);
  const double slope = std::tan(RadFromDeg(rms_slope_deg));
  return reflection * reflection / (8.0 * std::numbers::pi * slope * slope);
}

const std::vector<NamedMaterial>& BuiltInMaterials() {
  static const std::vector<NamedMaterial> kMaterials = MakeBuiltIn();
  return kMaterials;
}

const NamedMaterial& FindMaterial(std::string_view name, const std::vector<NamedMaterial>& materials) {
  const auto found = std::ranges::find(materials, name, &NamedMaterial::name);
  if (found != materials.end()) return *found;
  std::vector<std::string> names;
  for (const NamedMaterial& material : materials) names.push_back(material.name);
  throw DataError("no material is called '{}'{}", name, ExpectedWord(name, names));
}

}  // namespace sonarcal
