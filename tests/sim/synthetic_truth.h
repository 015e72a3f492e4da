// A synthetic recording with all its parameters (truth.json), made by a coherent simulation that shares no
// line with this project, and a simulator that knows them.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "core/types/units.h"
#include "data_io/open_recording.h"
#include "data_io/scenes/scene_io.h"
#include "sim/simulator.h"
#include "tests/support/recordings.h"

namespace sonarcal::testing {

class SyntheticTruth : public ::testing::Test {
 protected:
  void Open(const std::filesystem::path& folder) {
    truth_ = nlohmann::json::parse(std::ifstream(folder / "truth.json"));
    recording_ = data_io::OpenRecording(folder);
    const nlohmann::json& cell = truth_["cell"];
    parameters_.model = EchoModel::kAcoustic;
    parameters_.source_level_db = truth_["source_level_db"];
    parameters_.receiver.noise_db = truth_["noise_level_db"];
    parameters_.display = {.db_min = truth_["image"]["db_min"], .db_max = truth_["image"]["db_max"]};
    parameters_.beam = {.azimuth_width_deg = cell["azimuth_half_power_deg_at_centre"],
                        .elevation_width_deg = cell["elevation_half_power_deg"],
                        .azimuth_pattern = AzimuthPattern::kAperture,
                        .azimuth_taper = 1.0,
                        .azimuth_table_db = {}};
    parameters_.pulse.length_m = cell["range_half_power_m"];
    for (const auto& [name, gsab] : truth_["gsab"].items()) {
      parameters_.materials[name].gsab = {gsab["A"], gsab["B"], gsab["C"], gsab["D"], gsab["E"], gsab["F"]};
    }
    if (truth_["multipath"]) {
      for (const auto& [name, pressure] : truth_["reflection_pressure"].items()) {
        parameters_.mirrors[name].loss_db = -20.0 * std::log10(std::abs(pressure.get<double>()));
      }
      // "flat to 24 deg, cosine amplitude roll-off to zero at 45 deg"
      parameters_.beam.transmit_even_deg = 24.0;
      parameters_.beam.transmit_end_deg = 45.0;
      parameters_.beam.mirror_lobes = MirrorLobes::kMain;  // docs/studies/ghosts.md
    }
    sim::SimulationOptions options;
    options.fan = {.sampling = sim::Sampling::kBeams,
                   .cols = 2 * 256,
                   .rows = 2500,
                   .elevation_span_deg = 176.0,
                   .azimuth_margin_deg = 4.0,
                   .row_crowding = 6.0};
    options.water = *recording_->info().water;
    options.absorption = sim::AbsorptionFormula::kAinslieMcColm;  // of the simulation that made the recording
    simulator_.emplace(data_io::ReadGltf(folder / "scene.gltf"), recording_->info().sonar, options);
  }

  sim::AcousticGeometry geometry() const { return {simulator_->sonar(), truth_["absorption_db_per_m"]}; }

  Grid<float> Power(const sim::EchoList& echoes, const ParameterSet& parameters) const {
    return sim::ExpectedPower(sim::MakeScatterMap(echoes, simulator_->fan(), geometry(), parameters),
                              geometry(), parameters)
        .value;
  }

  // Only `name` scatters, and nothing is noisy.
  ParameterSet Alone(const std::string& name) const {
    ParameterSet parameters = parameters_;
    for (auto& [material, values] : parameters.materials) {
      if (material == name) continue;
      values.gsab.a = values.gsab.c = values.gsab.e = 0.0;
    }
    parameters.receiver.noise_db.reset();
    return parameters;
  }

  double NoisePower() const { return PowerFromDb(*parameters_.receiver.noise_db); }

  double RecordedPower(float grey) const {
    const auto& display = parameters_.display;
    return PowerFromDb(display.db_min + grey / 255.0 * (display.db_max - display.db_min));
  }

  nlohmann::json truth_;
  std::unique_ptr<RecordingSource> recording_;
  ParameterSet parameters_;
  std::optional<sim::Simulator> simulator_;
};

struct MeanRatio {
  void Add(double ratio) {
    sum += ratio;
    count += 1.0;
  }
  double Db() const { return DbFromPower(sum / count); }

  double sum = 0.0;
  double count = 0.0;
};

}  // namespace sonarcal::testing
