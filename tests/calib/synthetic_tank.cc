#include "tests/calib/synthetic_tank.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iostream>

#include "data_io/open_recording.h"
#include "data_io/scenes/scene_io.h"
#include "sim/physics/display.h"
#include "sim/physics/gsab.h"
#include "sim/rays/acoustic_fan.h"

namespace sonarcal::testing {
namespace {

ParameterSet Known(const ImageScale& scale) {
  ParameterSet known;
  known.model = EchoModel::kAcoustic;
  known.source_level_db = 200.0;
  known.display = {.db_min = scale.db_min.value(), .db_max = scale.db_max.value()};
  known.materials["default"].gsab = {.a = 0.05, .b_deg = 5.0, .c = 0.005, .d = 1.5, .e = 0.02, .f_deg = 15.0};
  known.beam.azimuth_width_deg = 1.0;
  known.beam.elevation_width_deg = 20.0;
  known.beam.mirror_lobes =
      MirrorLobes::kMain;  // as the simulation that made the recordings (docs/studies/ghosts.md)
  known.pulse.length_m = 0.0254;
  return known;
}

sim::SimulationOptions Options(const RecordingInfo& info, const ParameterSet& parameters) {
  sim::SimulationOptions options;
  options.water = info.water.value();
  options.absorption = sim::AbsorptionFormula::kAinslieMcColm;  // of the simulation that made the recording
  options.fan = sim::AcousticFanOptions(info.sonar, parameters);
  return options;
}

}  // namespace

SyntheticTank::SyntheticTank(const std::filesystem::path& folder)
    : recording(data_io::OpenRecording(folder)),
      truth(nlohmann::json::parse(std::ifstream(folder / "truth.json"))),
      known(Known(recording->info().scale)),
      simulator(data_io::ReadGltf(folder / "scene.gltf"), recording->info().sonar,
                Options(recording->info(), known)) {}

std::vector<calib::AcousticFrame> SyntheticTank::Frames(const std::vector<int>& indices) const {
  std::vector<calib::AcousticFrame> frames;
  for (const int index : indices) {
    const Frame frame = recording->ReadFrame(index);
    frames.push_back({.index = index,
                      .world_from_sonar = frame.info.world_from_sonar.value(),
                      .recorded = calib::RecordedPowers(frame.image, known.display)});
  }
  return frames;
}

Pose SyntheticTank::TruePose(int frame) const {
  const nlohmann::json& pose = truth["frames"][static_cast<std::size_t>(frame)]["world_from_sonar"];
  const std::vector<double> p = pose["position_m"];
  const std::vector<double> q = pose["quaternion_wxyz"];
  return {Eigen::Quaterniond(q.at(0), q.at(1), q.at(2), q.at(3)), {p.at(0), p.at(1), p.at(2)}};
}

GsabParameters<double> SyntheticTank::TrueCurve(const std::string& material) const {
  const nlohmann::json& g = truth.at("gsab").at(material);
  return {g["A"], g["B"], g["C"], g["D"], g["E"], g["F"]};
}

ParameterSet SyntheticTank::TrueParameters() const {
  ParameterSet parameters = known;
  parameters.source_level_db = truth["source_level_db"];
  for (const auto& [name, curve] : truth["gsab"].items()) parameters.materials[name].gsab = TrueCurve(name);
  const nlohmann::json& cell = truth["cell"];
  parameters.beam.azimuth_width_deg = cell["azimuth_half_power_deg_at_centre"];
  parameters.beam.elevation_width_deg = cell["elevation_half_power_deg"];
  parameters.pulse.length_m = cell["range_half_power_m"];
  parameters.receiver.noise_db = TrueNoiseDb();
  if (!truth.at("multipath").get<bool>()) return parameters;
  for (const auto& [name, pressure] : truth.at("reflection_pressure").items())
    parameters.mirrors[name].loss_db = -20.0 * std::log10(std::abs(pressure.get<double>()));
  // "flat to 24 deg, cosine amplitude roll-off to zero at 45 deg"
  parameters.beam.transmit_even_deg = 24.0;
  parameters.beam.transmit_end_deg = 45.0;
  return parameters;
}

CurveAgreement ExpectCurve(const SyntheticTank& tank, const calib::FitReport& report,
                           const std::string& material) {
  constexpr int kMinPixels = 90;  // in a bin of incidence
  constexpr double kBinDeg = 5.0;
  const nlohmann::json& pixels = tank.truth.at("incidence_coverage").at("pixels").at(material);
  const auto curve = std::find_if(report.curves.begin(), report.curves.end(),
                                  [&](const calib::FittedCurve& of) { return of.material == material; });
  CurveAgreement agreement;
  EXPECT_NE(curve, report.curves.end()) << material;
  if (curve == report.curves.end()) return agreement;
  int in_band = 0;
  for (std::size_t i = 0; i < curve->incidence_deg.size(); ++i) {
    const double deg = curve->incidence_deg[i];
    const auto bin = std::min(static_cast<std::size_t>(deg / kBinDeg), pixels.size() - 1);
    // At 90 degrees a cosine has no level.
    if (pixels[bin].get<int>() < kMinPixels || deg > 89.0) continue;
    const double error_db = std::abs(curve->backscatter_db[i] - sim::GsabDb(tank.TrueCurve(material), deg));
    const double band_db = calib::kSigmasOf95 * curve->sigma_db[i];
    EXPECT_LE(error_db, std::max(band_db, kMaxCurveErrorDb)) << material << " at " << deg;
    ++agreement.angles;
    in_band += error_db <= band_db ? 1 : 0;
    agreement.largest_error_db = std::max(agreement.largest_error_db, error_db);
  }
  EXPECT_GT(agreement.angles, 0) << material;
  agreement.share_in_band = static_cast<double>(in_band) / agreement.angles;
  std::cout << fmt::format("  {}: {} angles, {:.2f} of them in the 95 % band, largest error {:.2f} dB\n",
                           material, agreement.angles, agreement.share_in_band, agreement.largest_error_db);
  return agreement;
}

double SpeckleFloorOf(double power, const DisplayParameters<double>& display) {
  constexpr int kDraws = 400;
  std::vector<double> shown;
  double mean = 0.0;
  for (int k = 0; k < kDraws; ++k) {
    const double draw = -power * std::log1p(-(k + 0.5) / kDraws);
    shown.push_back(std::clamp(sim::DisplayValue(display, draw), 0.0, 1.0));
    mean += shown.back() / kDraws;
  }
  double floor = 0.0;
  for (const double value : shown) floor += std::abs(value - mean) / kDraws;
  return floor;
}

}  // namespace sonarcal::testing
