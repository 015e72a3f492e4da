// The acoustic model against recordings that somebody else's coherent simulation made, with all their
// parameters: the one check that shares no line with this project.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include <nlohmann/json.hpp>

#include "data_io/open_recording.h"
#include "data_io/scene_io.h"
#include "data_io/types/units.h"
#include "sim/simulator.h"
#include "tests/support/recordings.h"

namespace sonarcal {
namespace {

class SyntheticTank : public ::testing::Test {
 protected:
  void SetUp() override {
    SONARCAL_NEEDS_RECORDING(folder, "synthetic_tank");
    truth_ = nlohmann::json::parse(std::ifstream(folder / "truth.json"));
    recording_ = OpenRecording(folder);
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
    SimulationOptions options;
    options.fan = {.sampling = Sampling::kBeams,
                   .cols = 2 * 256,
                   .rows = 2500,
                   .elevation_span_deg = 176.0,
                   .azimuth_margin_deg = 4.0,
                   .row_crowding = 6.0};
    options.water = *recording_->info().water;
    simulator_.emplace(ReadGltf(folder / "scene.gltf"), recording_->info().sonar, options);
  }

  AcousticGeometry geometry() const { return {simulator_->sonar(), truth_["absorption_db_per_m"]}; }

  Grid<float> Power(const EchoList& echoes, const ParameterSet& parameters) const {
    return ExpectedPower(MakeScatterMap(echoes, simulator_->fan(), geometry(), parameters), geometry(),
                         parameters)
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
  std::optional<Simulator> simulator_;
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

// Beyond 2.7 m (bin 164) all of the floor that the truth's elevation pattern, two cosine-tapered apertures,
// shows is within 17 degrees of the axis, where a Gaussian of the same width follows it; nearer it is up to 1
// dB below the Gaussian. The two bins at the far end lack what lies beyond the window.
constexpr int kFirstBin = 164;
constexpr int kLastBin = 655;

// Speckle of the recording is correlated over 17 pixels (sum of its measured correlation over both axes), so
// 80'000 floor pixels are 5000 independent ones, standard error 1.4 %, 0.06 dB; of noise more.
TEST_F(SyntheticTank, LevelsAreThoseOfTheRecordedFrames) {
  MeanRatio floor;
  MeanRatio noise;
  std::vector<double> ratios;
  for (int index = 0; index < recording_->frame_count(); index += 2) {
    const Frame frame = recording_->ReadFrame(index);
    const EchoList echoes = simulator_->TraceEchoes(*frame.info.world_from_sonar);
    const Grid<float> all = Power(echoes, parameters_);
    const Grid<float> of_floor = Power(echoes, Alone("floor"));
    for (int bin = kFirstBin; bin < kLastBin; ++bin) {
      for (int beam = 0; beam < all.cols(); ++beam) {
        const double ratio = RecordedPower(frame.image.value(bin, beam)) / double{all(bin, beam)};
        const double others = double{all(bin, beam)} - double{of_floor(bin, beam)};
        if (others < 0.05 * of_floor(bin, beam)) floor.Add(ratio);
        if (all(bin, beam) < 1.02 * NoisePower()) noise.Add(ratio);
        ratios.push_back(ratio);
      }
    }
  }
  EXPECT_GT(floor.count, 60'000);
  EXPECT_GT(noise.count, 60'000);
  EXPECT_NEAR(floor.Db(), 0.0, 0.2);
  EXPECT_NEAR(noise.Db(), 0.0, 0.2);

  // Power over its expectation is exponential everywhere: floor, object, wall, shadow. The display hides what
  // lies below 82 dB, 6 % of noise at 94, hence from a tenth of the mean on.
  std::sort(ratios.begin(), ratios.end());
  double distance = 0.0;
  for (std::size_t i = 0; i < ratios.size(); ++i) {
    if (ratios[i] < 0.1) continue;
    const double share = (static_cast<double>(i) + 0.5) / static_cast<double>(ratios.size());
    distance = std::max(distance, std::abs(share - (1.0 - std::exp(-ratios[i]))));
  }
  RecordProperty("floor_db", std::to_string(floor.Db()));
  RecordProperty("noise_db", std::to_string(noise.Db()));
  RecordProperty("distance", std::to_string(distance));
  // Beyond 2.47 / sqrt(n) with a probability of 1e-5 (Kolmogorov).
  EXPECT_LT(distance, 2.47 / std::sqrt(static_cast<double>(ratios.size()) / 17.0));
}

}  // namespace
}  // namespace sonarcal
