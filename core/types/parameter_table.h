// The table of all physical parameters: each key of params.json (core/types/parameters.h), in the order of
// the file. To add a parameter, add its member and its entry here; file, fit, live view and reference page
// follow.
#pragma once

#include <numbers>
#include <type_traits>

#include "core/types/parameter_info.h"
#include "core/types/parameters.h"

namespace sonarcal {

namespace internal {

// Levels beyond these are mistakes, such as a misplaced decimal point. Several levels may add up to more than
// single precision holds, 385 dB of power: sim::Simulator refuses such echoes, and may show such noise as
// full scale.
inline constexpr double kMaxLevelDb = 500.0;
inline constexpr double kMaxPowerRatio = 1e30;

// Surprising changes: a factor of ten in power, 20 dB in a level.
inline constexpr double kPowerStep = std::numbers::ln10;
inline constexpr double kLevelStepDb = 20.0;

// Amplitude of a backscatter curve. A fit of the acoustic model keeps it within the curves of real surfaces,
// as backscattering strength per unit area.
constexpr ParameterInfo CurveAmplitude(std::string_view key, std::string_view meaning, std::string_view label,
                                       double max_fit) {
  return {.key = key,
          .meaning = meaning,
          .unit = "power ratio",
          .label = label,
          .required = true,
          .zero = "none",
          .min = 0.0,
          .max = kMaxPowerRatio,
          .scale = ParameterScale::kLogarithmic,
          .step = kPowerStep,
          .paper_fit = FitLimits{1e-6, 1e6},
          .acoustic_fit = FitLimits{1e-7, max_fit}};
}

// Half-width of a peak. Widths below 0.1 degrees are not distinguishable from a mirror, widths above 60
// degrees not from the cosine.
constexpr ParameterInfo CurveWidth(std::string_view key, std::string_view meaning, std::string_view label,
                                   FitLimits real_surfaces) {
  return {.key = key,
          .meaning = meaning,
          .unit = "deg",
          .label = label,
          .required = true,
          .min = 0.0,
          .max = 1000.0,
          .above_min = true,
          .scale = ParameterScale::kLogarithmic,
          .paper_fit = FitLimits{0.1, 60.0},
          .acoustic_fit = real_surfaces};
}

// Two-way half-power width of the point spread function.
constexpr ParameterInfo BeamWidth(std::string_view key, std::string_view meaning, std::string_view label,
                                  FitLimits fit) {
  return {.key = key,
          .meaning = meaning,
          .unit = "deg",
          .label = label,
          .models = kEchoPowerModels,
          .zero = "that of the sonar",
          .min = 0.0,
          .max = 360.0,
          .scale = ParameterScale::kLogarithmic,
          .acoustic_fit = fit};
}

constexpr ParameterInfo ApertureTaper(std::string_view key, std::string_view meaning,
                                      std::string_view label) {
  return {.key = key,
          .meaning = meaning,
          .unit = "1",
          .label = label,
          .models = kEchoPowerModels,
          .min = 0.0,
          .max = 1.0};
}

// A level in dB of the sonar equation, the receiver or the display.
constexpr ParameterInfo Level(ParameterInfo info) {
  if (info.unit.empty()) info.unit = "dB";
  info.min = -kMaxLevelDb;
  info.max = kMaxLevelDb;
  info.step = kLevelStepDb;
  return info;
}

constexpr ParameterInfo LevelPerBeam(std::string_view key, std::string_view meaning) {
  return {.key = key,
          .meaning = meaning,
          .unit = "dB",
          .models = kEchoPowerModels,
          .by_default = "0 for each beam",
          .min = -kMaxLevelDb,
          .max = kMaxLevelDb};
}

}  // namespace internal

// The limits of acoustic fits are those of curves of real surfaces: peaks of -70 to +20 dB, no narrower than
// half a degree (a narrower peak is a mirror and absorbs errors of the model), a slow part of -70 to 0 dB.
template <typename T>
struct ParameterTable<GsabParameters<T>> {
  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor&& visit) {
    visit(internal::CurveAmplitude("A", "Specular amplitude", "A, specular amplitude", 100.0), self.a);
    visit(internal::CurveWidth("B_deg", "Half-width of the specular peak", "B, specular half-width",
                               {0.5, 20.0}),
          self.b_deg);
    visit(internal::CurveAmplitude("C", "Level at oblique incidence", "C, oblique level", 1.0), self.c);
    visit(ParameterInfo{.key = "D",
                        .meaning = "Exponent of the cosine: 1 Lommel-Seeliger, 2 Lambert",
                        .unit = "1",
                        .label = "D, exponent of the cosine",
                        .required = true,
                        .min = 0.0,
                        .max = 100.0,
                        .paper_fit = FitLimits{0.0, 8.0},
                        .acoustic_fit = FitLimits{0.0, 5.0}},
          self.d);
    visit(internal::CurveAmplitude("E", "Transitional amplitude", "E, transitional amplitude", 10.0), self.e);
    visit(internal::CurveWidth("F_deg", "Half-width of the transition", "F, transitional half-width",
                               {3.0, 60.0}),
          self.f_deg);
  }
};

template <>
struct ParameterTable<MaterialParameters> {
  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor&& visit) {
    visit(ParameterGroupInfo{.key = "gsab",
                             .meaning = "Backscatter curve A exp(-delta^2 / 2 B^2) + C cos(delta)^D + "
                                        "E exp(-delta^2 / 2 F^2) of the incidence angle delta",
                             .by_default = "for a fit, the centre of `prior`; otherwise refused",
                             .topic = ParameterTopic::kMaterials},
          self.gsab);
    visit(ParameterInfo{.key = "prior",
                        .meaning = "Material whose prior a fit takes, by its name in `sonarcal materials`",
                        .by_default = "prior about the values given"},
          self.prior);
  }
};

// A mirror returns no more than it receives. Beyond 60 dB its multipath echoes are below all others.
template <>
struct ParameterTable<MirrorParameters> {
  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor&& visit) {
    visit(ParameterInfo{.key = "loss_db",
                        .meaning = "Loss of one reflection, at any angle: -20 log10 of the pressure "
                                   "reflection coefficient",
                        .unit = "dB",
                        .label = "Loss",
                        .models = kEchoPowerModels,
                        .required = true,
                        .min = 0.0,
                        .max = 200.0,
                        .step = 10.0,
                        .acoustic_fit = FitLimits{0.0, 60.0}},
          self.loss_db);
  }
};

template <typename T>
struct ParameterTable<DisplayParameters<T>> {
  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor&& visit) {
    visit(internal::Level({.key = "db_min",
                           .meaning = "Level shown as 0",
                           .label = "Level shown as black",
                           .required = true,
                           .paper_fit = FitLimits{-500.0, 500.0}}),
          self.db_min);
    visit(internal::Level({.key = "db_max",
                           .meaning = "Level shown as full scale, above `db_min`",
                           .label = "Level shown as full scale",
                           .required = true,
                           .paper_fit = FitLimits{-500.0, 500.0}}),
          self.db_max);
    visit(
        ParameterInfo{
            .key = "law", .meaning = "Display law", .label = "Display law", .models = kEchoPowerModels},
        self.law);
    visit(
        internal::Level({.key = "soft_db",
                         .meaning = "Level that softens the logarithm; laws `soft_log` and `soft_amplitude`",
                         .label = "Softening level",
                         .models = kEchoPowerModels}),
        self.soft_db);
    visit(ParameterInfo{.key = "exponent",
                        .meaning = "Exponent of the amplitude; law `power`",
                        .unit = "1",
                        .label = "Exponent of the law 'power'",
                        .models = kEchoPowerModels,
                        .min = 0.0,
                        .max = 10.0,
                        .above_min = true,
                        .scale = ParameterScale::kLogarithmic,
                        .control = ControlRange{0.01, 10.0}},
          self.exponent);
  }
};

// A fit starts from errors above 0. Errors far below a bin have no effect.
template <typename T>
struct ParameterTable<JitterParameters<T>> {
  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor&& visit) {
    visit(ParameterInfo{.key = "sigma_range_m",
                        .meaning = "Standard deviation of the range error, at short range and at the "
                                   "reference frequency",
                        .unit = "m",
                        .label = "Range error, at short range",
                        .models = kPaperModel,
                        .zero = "none",
                        .min = 0.0,
                        .max = 100.0,
                        .scale = ParameterScale::kLogarithmic,
                        .paper_fit = FitLimits{1e-4, 1.0}},
          self.sigma_range_m);
    visit(ParameterInfo{.key = "sigma_azimuth_deg",
                        .meaning = "Standard deviation of the azimuth error, at short range and at the "
                                   "reference frequency",
                        .unit = "deg",
                        .label = "Azimuth error, at short range",
                        .models = kPaperModel,
                        .zero = "none",
                        .min = 0.0,
                        .max = 360.0,
                        .scale = ParameterScale::kLogarithmic,
                        .paper_fit = FitLimits{1e-3, 10.0}},
          self.sigma_azimuth_deg);
    visit(ParameterInfo{.key = "reference_range_m",
                        .meaning = "Range R0 of the growth law",
                        .unit = "m",
                        .label = "Reference range of the errors",
                        .models = kPaperModel,
                        .min = 0.0,
                        .max = 1e12,
                        .above_min = true,
                        .scale = ParameterScale::kLogarithmic,
                        .paper_fit = FitLimits{0.1, 1000.0}},
          self.reference_range_m);
    visit(ParameterInfo{.key = "reference_frequency_hz",
                        .meaning = "Frequency f0 at which the two standard deviations hold",
                        .unit = "Hz",
                        .label = "Reference frequency of the errors",
                        .models = kPaperModel,
                        .min = 0.0,
                        .max = 1e12,
                        .above_min = true,
                        .scale = ParameterScale::kLogarithmic,
                        .control = ControlRange{1e3, 1e8}},
          self.reference_frequency_hz);
    visit(ParameterInfo{.key = "growth",
                        .meaning = "Growth g with range R: `root` sqrt(1 + R^2/R0^2), `linear` 1 + R^2/R0^2",
                        .label = "Growth of the errors with range",
                        .models = kPaperModel},
          self.growth);
  }
};

template <>
struct ParameterTable<ReceiverParameters> {
  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor&& visit) {
    visit(internal::Level({.key = "gain_db",
                           .meaning = "Gain of the echoes",
                           .label = "Gain",
                           .models = kEchoPowerModels,
                           .acoustic_fit = FitLimits{-500.0, 500.0}}),
          self.gain_db);
    visit(ParameterInfo{.key = "time_varied_gain",
                        .meaning = "Gain over range R of echoes and of the noise before it: 0, 20 log10 R, "
                                   "40 log10 R, or 40 log10 R + 2 alpha R",
                        .label = "Time-varied gain",
                        .models = kEchoPowerModels},
          self.time_varied_gain);
    visit(internal::Level({.key = "noise_db",
                           .meaning = "Noise floor before the time-varied gain, at range 0",
                           .label = "Noise level before time-varied gain",
                           .models = kEchoPowerModels,
                           .by_default = "no such noise",
                           .acoustic_fit = FitLimits{-500.0, 500.0}}),
          self.noise_db);
    visit(ParameterInfo{.key = "noise_slope_db_per_m",
                        .meaning = "Trend with range of the noise before the time-varied gain",
                        .unit = "dB/m",
                        .label = "Trend of the noise with range",
                        .models = kEchoPowerModels,
                        .min = -1000.0,
                        .max = 1000.0,
                        .step = internal::kLevelStepDb,
                        .acoustic_fit = FitLimits{-100.0, 100.0, LimitUnit::kPerWindow}},
          self.noise_slope_db_per_m);
    visit(internal::LevelPerBeam("noise_taper_db",
                                 "Level per beam that is added to the noise before the time-varied gain"),
          self.noise_taper_db);
    visit(internal::Level({.key = "noise_after_gain_db",
                           .meaning = "Noise floor after the time-varied gain",
                           .label = "Noise level after time-varied gain",
                           .models = kEchoPowerModels,
                           .by_default = "no such noise"}),
          self.noise_after_gain_db);
    visit(internal::LevelPerBeam("noise_after_gain_taper_db",
                                 "Level per beam that is added to the noise after the time-varied gain"),
          self.noise_after_gain_taper_db);
    visit(ParameterInfo{.key = "looks",
                        .meaning = "Independent looks averaged in a pixel; 1 gives exponential power",
                        .unit = "1",
                        .label = "Looks averaged per pixel",
                        .models = kEchoPowerModels,
                        .min = 0.0,
                        .max = 1e6,
                        .above_min = true,
                        .scale = ParameterScale::kLogarithmic,
                        .control = ControlRange{1.0, 1000.0}},
          self.looks);
    visit(ParameterInfo{.key = "diffuse_share",
                        .meaning =
                            "Share of the mean power without texture, for noise laws with fewer looks than 1",
                        .unit = "1",
                        .models = kEchoPowerModels,
                        .min = 0.0,
                        .max = 0.999},
          self.diffuse_share);
  }
};

template <>
struct ParameterTable<BeamParameters> {
  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor&& visit) {
    visit(internal::BeamWidth("azimuth_width_deg", "Two-way half-power width in azimuth",
                              "Beam width, azimuth", {0.125, 16.0, LimitUnit::kBeamSpacings}),
          self.azimuth_width_deg);
    visit(internal::BeamWidth("elevation_width_deg", "Two-way half-power width in elevation",
                              "Beam width, elevation", {0.125, 120.0}),
          self.elevation_width_deg);
    visit(ParameterInfo{.key = "azimuth_pattern",
                        .meaning =
                            "Shape of a beam in azimuth: `gaussian` main lobe only, `aperture` line array "
                            "with side lobes, `table` values of `azimuth_table_db`",
                        .label = "Azimuth pattern",
                        .models = kAcousticModel},
          self.azimuth_pattern);
    visit(internal::ApertureTaper("azimuth_taper",
                                  "Shading of the azimuth aperture: 0 uniform (highest side lobe -13 dB), "
                                  "1 Hann (-31 dB)",
                                  "Azimuth taper: 0 uniform, 1 Hann"),
          self.azimuth_taper);
    visit(ParameterInfo{.key = "elevation_pattern",
                        .meaning =
                            "Shape of a beam in elevation: `gaussian` main lobe only, `aperture` shaded by "
                            "`elevation_taper`, `cosine` shaded by a cosine",
                        .label = "Elevation pattern",
                        .models = kEchoPowerModels},
          self.elevation_pattern);
    visit(internal::ApertureTaper("elevation_taper",
                                  "Shading of the elevation aperture: 0 uniform, 1 Hann; pattern `aperture`",
                                  "Elevation taper: 0 uniform, 1 Hann"),
          self.elevation_taper);
    visit(ParameterInfo{.key = "transmit_even_deg",
                        .meaning = "Azimuth off the axis up to which the transmitter sends evenly; multipath "
                                   "echoes only",
                        .unit = "deg",
                        .label = "Even transmission up to (ghosts)",
                        .models = kEchoPowerModels,
                        .min = 0.0,
                        .max = 90.0,
                        .step = 30.0},
          self.transmit_even_deg);
    // A transmitter sends at least to the outer beams, and no further than rays for multipath echoes go.
    visit(ParameterInfo{.key = "transmit_end_deg",
                        .meaning = "Azimuth off the axis where transmission ends, at least "
                                   "`transmit_even_deg`; multipath echoes only",
                        .unit = "deg",
                        .label = "Transmission ends at (ghosts)",
                        .models = kEchoPowerModels,
                        .min = 0.0,
                        .max = 90.0,
                        .step = 20.0,
                        .acoustic_fit = FitLimits{1.0, 60.0, LimitUnit::kBeyondBeams},
                        .control = ControlRange{0.0, 90.0, 30.0}},
          self.transmit_end_deg);
    visit(ParameterInfo{.key = "mirror_lobes",
                        .meaning = "Lobes of the elevation pattern through which mirrors are seen",
                        .label = "Lobes that see mirrors",
                        .models = kEchoPowerModels},
          self.mirror_lobes);
    visit(internal::LevelPerBeam("sensitivity_db", "Sensitivity to echoes per beam"), self.sensitivity_db);
    visit(
        ParameterInfo{.key = "azimuth_table_db",
                      .meaning = "Power response at -n .. n beams off the axis: 2 n + 1 values with the axis "
                                 "in the middle; pattern `table`",
                      .unit = "dB",
                      .models = kAcousticModel,
                      .by_default = "no table",
                      .min = -internal::kMaxLevelDb,
                      .max = 0.0,
                      .min_items = 3},
        self.azimuth_table_db);
  }
};

template <>
struct ParameterTable<PulseParameters> {
  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor&& visit) {
    visit(ParameterInfo{.key = "length_m",
                        .meaning = "Half-power length of the range response",
                        .unit = "m",
                        .label = "Pulse length",
                        .models = kEchoPowerModels,
                        .zero = "one range bin",
                        .min = 0.0,
                        .max = 100.0,
                        .scale = ParameterScale::kLogarithmic,
                        .acoustic_fit = FitLimits{0.125, 16.0, LimitUnit::kRangeBins}},
          self.length_m);
  }
};

// The limits are those of natural waters.
template <>
struct ParameterTable<Water> {
  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor&& visit) {
    const auto number = [&](std::string_view key, std::string_view label, std::string_view unit, double min,
                            double max, double step, auto& member) {
      visit(ParameterInfo{.key = key,
                          .meaning = label,
                          .unit = unit,
                          .label = label,
                          .required = true,
                          .min = min,
                          .max = max,
                          .step = step},
            member);
    };
    number("temperature_c", "Temperature", "C", -4.0, 100.0, 10.0, self.temperature_c);
    number("salinity_ppt", "Salinity", "ppt", 0.0, 350.0, 14.0, self.salinity_ppt);
    number("ph", "pH", "1", 0.0, 14.0, 0.5, self.ph);
    number("depth_m", "Depth", "m", 0.0, 12000.0, 100.0, self.depth_m);
  }
};

template <>
struct ParameterTable<ParameterSet> {
  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor&& visit) {
    visit(ParameterInfo{.key = "model", .meaning = "Image model", .required = true}, self.model);
    visit(internal::Level({.key = "source_level_db",
                           .meaning = "Source level",
                           .unit = "dB re 1 uPa at 1 m",
                           .label = "Source level",
                           .paper_fit = FitLimits{0.0, 300.0},
                           .acoustic_fit = FitLimits{0.0, 300.0}}),
          self.source_level_db);
    visit(
        ParameterInfo{.key = "source_level_sigma_db",
                      .meaning = "Standard error of source level plus gain, measured with a standard target",
                      .unit = "dB",
                      .models = kEchoPowerModels,
                      .by_default = "not measured: backscatter is relative to source level plus gain",
                      .min = 0.0,
                      .max = 200.0},
        self.source_level_sigma_db);
    visit(internal::Level({.key = "noise_level_db",
                           .meaning = "Noise level NL of the sonar equation (paper, Eq. 10)",
                           .label = "Noise level NL (Eq. 10)",
                           .models = kPaperModel}),
          self.noise_level_db);
    visit(internal::Level({.key = "array_gain_db",
                           .meaning = "Array gain AG of the sonar equation (paper, Eq. 10)",
                           .label = "Array gain AG (Eq. 10)",
                           .models = kPaperModel}),
          self.array_gain_db);
    VisitGroups(self, visit);
  }

 private:
  template <typename Self, typename Visitor>
  static void VisitGroups(Self& self, Visitor&& visit) {
    visit(ParameterGroupInfo{.key = "display",
                             .meaning = "Law that turns received power into a grey value",
                             .by_default = "`log`, 0 to 255 dB"},
          self.display);
    visit(ParameterGroupInfo{.key = "materials",
                             .meaning = "Backscatter of each material, by the names of the scene; `default` "
                                        "serves all other names",
                             .required = true,
                             .topic = ParameterTopic::kMaterials,
                             .fit_name = "material"},
          self.materials);
    visit(
        ParameterGroupInfo{.key = "mirror",
                           .meaning = "Materials that also reflect like a mirror, by the names of the scene",
                           .by_default = "no mirrors",
                           .models = kEchoPowerModels,
                           .topic = ParameterTopic::kMirrors},
        self.mirrors);
    visit(ParameterGroupInfo{.key = "jitter",
                             .meaning = "Range and azimuth errors of a ray (paper, Section 3.4)",
                             .by_default = "no errors",
                             .models = kPaperModel,
                             .topic = ParameterTopic::kErrors},
          self.jitter);
    visit(ParameterGroupInfo{.key = "receiver",
                             .meaning = "Gain, noise floor and looks",
                             .by_default = "no gain, no noise",
                             .models = kEchoPowerModels,
                             .topic = ParameterTopic::kReceiver},
          self.receiver);
    visit(ParameterGroupInfo{.key = "beam",
                             .meaning = "Two-way responses of a beam",
                             .by_default = "those of the sonar",
                             .models = kEchoPowerModels,
                             .topic = ParameterTopic::kBeam},
          self.beam);
    visit(ParameterGroupInfo{.key = "pulse",
                             .meaning = "Range response",
                             .by_default = "one range bin",
                             .models = kEchoPowerModels,
                             .topic = ParameterTopic::kBeam},
          self.pulse);
    visit(ParameterGroupInfo{.key = "water",
                             .meaning = "Water for the absorption of sound",
                             .by_default = "that of the recording or sonar",
                             .topic = ParameterTopic::kWater},
          self.water);
  }
};

}  // namespace sonarcal
