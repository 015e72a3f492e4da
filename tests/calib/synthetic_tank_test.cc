// The acoustic fit on recordings made by another kind of simulation, with their truth. Synthetic recordings.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include <nlohmann/json.hpp>

#include "calib/acoustic_fit.h"
#include "calib/problem_builder.h"
#include "data_io/open_recording.h"
#include "data_io/scene_io.h"
#include "data_io/types/units.h"
#include "sim/physics/gsab.h"
#include "sim/simulator.h"
#include "tests/support/recordings.h"

namespace sonarcal {
namespace {

TEST(SyntheticTank, CurvesAndNoiseComeBack) {
  const auto folder = testing::FindRecording("synthetic_tank");
  if (!folder) GTEST_SKIP() << "no recordings";
  const auto recording = OpenRecording(*folder);
  const Scene scene = ReadGltf(*folder / "scene.gltf");
  const nlohmann::json truth = nlohmann::json::parse(std::ifstream(*folder / "truth.json"));
  SimulationOptions options;
  options.fan = {.sampling = Sampling::kBeams, .cols = 256, .rows = 4000, .elevation_span_deg = 80.0};
  options.water = recording->info().water.value_or(Water{});
  const Simulator simulator(scene, recording->info().sonar, options);
  const SonarModel& sonar = simulator.sonar();
  ParameterSet initial;
  initial.model = EchoModel::kAcoustic;
  initial.source_level_db = 200.0;
  initial.display = {.db_min = 82.0, .db_max = 148.0};
  for (const std::string& name : simulator.caster().material_names()) {
    initial.materials[name].gsab = {.a = 0.05, .b_deg = 5, .c = 0.005, .d = 1.5, .e = 0.02, .f_deg = 15};
  }
  initial.pulse.length_m = 0.0254;
  initial.beam = {.azimuth_width_deg = 1.0,
                  .elevation_width_deg = 20.0,
                  .azimuth_pattern = AzimuthPattern::kAperture,
                  .azimuth_taper = 1.0,
                  .elevation_pattern = ElevationPattern::kAperture};
  std::vector<AcousticFrame> frames;
  for (int i = 0; i < 6; ++i) {
    const Frame frame = recording->ReadFrame(i);
    frames.push_back({.index = i,
                      .world_from_sonar = *frame.info.world_from_sonar,
                      .recorded = RecordedPowers(frame.image, initial.display)});
  }
  initial.receiver.noise_db = NoiseStartDb(frames, 1.0);
  fmt::print("noise start {}\n", *initial.receiver.noise_db);
  {
    ParameterSet at_truth = initial;
    at_truth.receiver.noise_db = 94.0;
    for (const std::string& name : simulator.caster().material_names()) {
      const auto& t = truth["gsab"][name];
      at_truth.materials[name].gsab = {t["A"], t["B"], t["C"], t["D"], t["E"], t["F"]};
    }
    const AcousticFrameModel model(simulator, frames, at_truth);
    fmt::print("cost at truth {}\n", CostAt(model, model.initial_values(), 6));
    std::ofstream out("/tmp/lead/means.bin", std::ios::binary);
    for (int i = 0; i < 6; ++i) {
      const std::vector<double> mean = model.MeanPower(i, model.initial_values());
      out.write(reinterpret_cast<const char*>(mean.data()), 8 * mean.size());
      std::vector<double> rec;
      for (const auto& r : frames[i].recorded) rec.push_back(r.power);
      out.write(reinterpret_cast<const char*>(rec.data()), 8 * rec.size());
    }
    fmt::print("{} x {}\n", sonar.axes.range_bins, sonar.axes.beam_count());
    fmt::print("entries a pixel {}\n", double(model.echoes(0).entries.size()) / (660 * 256));
    if (std::getenv("TRUTH_ONLY")) return;
  }
  FitConfig config;
  config.free = AcousticFreeByDefault();
  FitOptions fit_options;
  fit_options.starts = std::getenv("STARTS") ? atoi(std::getenv("STARTS")) : 1;
  fit_options.search_level = std::getenv("STARTS") != nullptr;
  fit_options.progress = [](const std::string& line) { fmt::print("{}\n", line); };
  const AcousticFit fit = FitAcousticModel(simulator, frames, initial, config, fit_options);
  fmt::print("{} iterations {} cost {} -> {} in {} s\n", fit.report.termination, fit.report.iterations,
             fit.report.cost_initial, fit.report.cost_final, fit.report.solve_s);
  for (const auto& p : fit.report.parameters) {
    if (p.name.starts_with("pose")) continue;
    fmt::print("{:28} {:10.5g} +- {:8.3g} {}\n", p.name, p.value, p.sigma.value_or(NAN), ToString(p.status));
  }
  for (const auto& [name, material] : fit.parameters.materials) {
    const auto& t = truth["gsab"][name];
    const GsabParameters<double> true_curve = {t["A"], t["B"], t["C"], t["D"], t["E"], t["F"]};
    fmt::print("{}:", name);
    for (double deg = 0; deg <= 88; deg += 8)
      fmt::print(" {}:{:.2f}", deg, GsabDb(material.gsab, deg) - GsabDb(true_curve, deg));
    fmt::print("\n");
  }
}

}  // namespace
}  // namespace sonarcal
