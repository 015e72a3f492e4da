#include "calib/selection/model_variants.h"

#include <fmt/format.h>

namespace sonarcal::calib {
namespace {

std::string AzimuthName(const BeamParameters& beam) {
  switch (beam.azimuth_pattern) {
    case AzimuthPattern::kGaussian:
      return "Gaussian";
    case AzimuthPattern::kTable:
      return "table";
    case AzimuthPattern::kAperture:
      break;
  }
  return fmt::format("aperture, taper {:g}", beam.azimuth_taper);
}

std::string ElevationName(const BeamParameters& beam) {
  switch (beam.elevation_pattern) {
    case ElevationPattern::kGaussian:
      return "Gaussian";
    case ElevationPattern::kCosine:
      return "cosine";
    case ElevationPattern::kAperture:
      break;
  }
  return fmt::format("aperture, taper {:g}", beam.elevation_taper);
}

std::string MirrorLobesName(const BeamParameters& beam) {
  return beam.mirror_lobes == MirrorLobes::kAll ? "through all lobes" : "through the main lobe";
}

// Returns the given beam and those of the others that differ from it.
std::vector<ModelVariant> BeamVariants(const BeamParameters& given, const std::vector<BeamParameters>& others,
                                       std::string (*name)(const BeamParameters&),
                                       void (*copy)(const BeamParameters& from, BeamParameters& to)) {
  std::vector<ModelVariant> variants = {{.name = name(given), .given = true}};
  for (const BeamParameters& other : others) {
    if (name(other) == name(given)) continue;
    variants.push_back(
        {.name = name(other), .apply = [other, copy](ParameterSet& p) { copy(other, p.beam); }});
  }
  return variants;
}

}  // namespace

const char* DisplayName(DisplayLaw law) {
  switch (law) {
    case DisplayLaw::kSoftLog:
      return "logarithm softened in power";
    case DisplayLaw::kSoftAmplitude:
      return "logarithm softened in amplitude";
    case DisplayLaw::kPower:
      return "power law";
    case DisplayLaw::kLog:
      break;
  }
  return "logarithm";
}

std::vector<ModelVariant> AzimuthVariants(const BeamParameters& given) {
  std::vector<BeamParameters> others = {{.azimuth_pattern = AzimuthPattern::kGaussian}};
  for (const double taper : {0.0, 0.5, 1.0}) others.push_back({.azimuth_taper = taper});
  return BeamVariants(given, others, AzimuthName, [](const BeamParameters& from, BeamParameters& to) {
    to.azimuth_pattern = from.azimuth_pattern;
    to.azimuth_taper = from.azimuth_taper;
  });
}

std::vector<ModelVariant> ElevationVariants(const BeamParameters& given) {
  std::vector<BeamParameters> others = {{.elevation_pattern = ElevationPattern::kGaussian},
                                        {.elevation_pattern = ElevationPattern::kCosine}};
  for (const double taper : {0.0, 1.0})
    others.push_back({.elevation_pattern = ElevationPattern::kAperture, .elevation_taper = taper});
  return BeamVariants(given, others, ElevationName, [](const BeamParameters& from, BeamParameters& to) {
    to.elevation_pattern = from.elevation_pattern;
    to.elevation_taper = from.elevation_taper;
  });
}

std::vector<ModelVariant> MirrorLobeVariants(const BeamParameters& given) {
  return BeamVariants(
      given, {{.mirror_lobes = MirrorLobes::kAll}, {.mirror_lobes = MirrorLobes::kMain}}, MirrorLobesName,
      [](const BeamParameters& from, BeamParameters& to) { to.mirror_lobes = from.mirror_lobes; });
}

}  // namespace sonarcal::calib
