// The acoustic fit on a SYNTHETIC recording made by another kind of simulation (complex point scatterers, an
// array of elements), against its truth.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <fstream>

#include <nlohmann/json.hpp>

#include "calib/acoustic_fit.h"
#include "data_io/open_recording.h"
#include "data_io/scene_io.h"
#include "sim/acoustic_fan.h"
#include "sim/physics/gsab.h"
#include "tests/support/recordings.h"

namespace sonarcal {
namespace {

constexpr std::array<int, 6> kFrames = {0, 1, 3, 4, 5, 7};

// What a user of that sonar knows: its beam and pulse, and that materials are neither mirrors nor black.
ParameterSet WhatIsKnown(const ImageScale& scale) {
  ParameterSet known;
  known.model = EchoModel::kAcoustic;
  known.source_level_db = 200.0;
  known.display = {.db_min = scale.db_min.value(), .db_max = scale.db_max.value()};
  known.materials["default"].gsab = {.a = 0.05, .b_deg = 5.0, .c = 0.005, .d = 1.5, .e = 0.02, .f_deg = 15.0};
  known.beam.azimuth_width_deg = 1.0;
  known.beam.elevation_width_deg = 20.0;
  known.pulse.length_m = 0.0254;
  return known;
}

// Angles that the truth says are covered: by at least this many pixels a bin of five degrees.
constexpr int kCovered = 90;

void ExpectCurve(const nlohmann::json& truth, const std::string& material,
                 const GsabParameters<double>& fitted, double tolerance_db) {
  const nlohmann::json& g = truth.at("gsab").at(material);
  const GsabParameters<double> true_curve = {g["A"], g["B"], g["C"], g["D"], g["E"], g["F"]};
  const nlohmann::json& pixels = truth.at("incidence_coverage").at("pixels").at(material);
  int covered = 0;
  for (std::size_t bin = 0; bin < pixels.size(); ++bin) {
    if (pixels[bin].get<int>() < kCovered) continue;
    ++covered;
    const double deg = 5.0 * static_cast<double>(bin) + 2.5;
    EXPECT_NEAR(GsabDb(fitted, deg), GsabDb(true_curve, deg), tolerance_db) << material << " at " << deg;
  }
  EXPECT_GT(covered, 0);
}

TEST(SyntheticTank, CurvesAndNoiseComeBack) {
  SONARCAL_NEEDS_RECORDING(folder, "synthetic_tank");
  const auto recording = OpenRecording(folder);
  const nlohmann::json truth = nlohmann::json::parse(std::ifstream(folder / "truth.json"));
  SimulationOptions options;
  options.water = recording->info().water.value();
  ParameterSet initial = WhatIsKnown(recording->info().scale);
  options.fan = AcousticFanOptions(recording->info().sonar, initial);
  const Simulator simulator(ReadGltf(folder / "scene.gltf"), recording->info().sonar, options);
  std::vector<AcousticFrame> frames;
  for (const int index : kFrames) {
    const Frame frame = recording->ReadFrame(index);
    frames.push_back({.index = index,
                      .world_from_sonar = frame.info.world_from_sonar.value(),
                      .recorded = RecordedPowers(frame.image, initial.display)});
  }
  initial.receiver.noise_db = NoiseStartDb(frames, 1.0);
  FitOptions fit_options;
  fit_options.starts = 2;
  const std::int64_t rays_before = simulator.caster().rays_cast();
  const AcousticFit fit = FitAcousticModel(simulator, frames, initial, {}, fit_options);
  EXPECT_EQ(simulator.caster().rays_cast() - rays_before,
            static_cast<std::int64_t>(kFrames.size()) * simulator.fan().size())
      << "each frame is traced once";
  ASSERT_TRUE(fit.usable) << fit.report.termination;
  EXPECT_NEAR(fit.parameters.receiver.noise_db.value(), truth["noise_level_db"].get<double>(), 0.3);
  ExpectCurve(truth, "floor", fit.parameters.Material("floor").gsab, 1.5);
  ExpectCurve(truth, "mockup", fit.parameters.Material("mockup").gsab, 1.5);
  ExpectCurve(truth, "wall", fit.parameters.Material("wall").gsab, 1.5);
  for (const char* name : {"material.floor.gsab.C", "material.floor.gsab.D", "material.mockup.gsab.C"}) {
    const FittedParameter* parameter = fit.report.Find(name);
    ASSERT_NE(parameter, nullptr);
    EXPECT_TRUE(parameter->sigma.has_value()) << name;
  }
}

}  // namespace
}  // namespace sonarcal
