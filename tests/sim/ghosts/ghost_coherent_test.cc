// Ghosts of the acoustic model against those of point scatterers and an array, where nobody says how the two
// ways of a pair add.
#include <gtest/gtest.h>

#include <cmath>

#include "core/types/units.h"
#include "sim/ghosts/ghost_power.h"
#include "sim/simulator.h"
#include "tests/sim/meshes.h"
#include "tests/sim/slow_paper_model.h"

namespace sonarcal::sim {
namespace {

using namespace testing;  // NOLINT: the helpers of tests/sim

constexpr int kBins = 24;
constexpr int kBeams = 28;
constexpr double kNoiseDb = 96.0;

// A plate that leans back, above a floor and between a wall at the right, which shows it some degrees aside
// and in part within its own beam.
Scene PlateBetweenMirrors() {
  Scene scene;
  AddQuad(scene, {-6, -2, -0.4}, {12, 0, 0}, {0, 12, 0}, "floor");
  AddQuad(scene, {0.16, 0.5, -0.4}, {0, 6, 0}, {0, 0, 2}, "wall");
  AddQuad(scene, {-0.2, 3.2, -0.3}, {0.3, 0, 0}, {0, 0.1, 0.6}, "plate");
  return scene;
}

ParameterSet Parameters() {
  ParameterSet p;
  p.model = EchoModel::kCoherent;
  p.source_level_db = 180.0;
  p.materials["default"].gsab = {.a = 0.0, .b_deg = 1.0, .c = 0.0, .d = 1.0, .e = 0.0, .f_deg = 1.0};
  p.materials["plate"].gsab = {.a = 0.16, .b_deg = 12.0, .c = 4e-3, .d = 2.0, .e = 0.016, .f_deg = 20.0};
  p.mirrors = {{"floor", {3.0}}, {"wall", {5.0}}};
  p.beam.azimuth_pattern = AzimuthPattern::kAperture;
  p.pulse.length_m = 0.1;
  p.receiver.noise_db = kNoiseDb;
  p.display = {.db_min = 60.0, .db_max = 180.0};
  return p;
}

SimulationOptions Options(int cols, int rows) {
  SimulationOptions options;
  options.fan = {.sampling = Sampling::kBeams,
                 .cols = cols,
                 .rows = rows,
                 .elevation_span_deg = 40.0,
                 .azimuth_margin_deg = 12.0};
  return options;
}

// As in coherent_image_test.cc: at one look a pixel's power has the standard deviation of its mean, so that
// z = (mean / expected - 1) sqrt(n) has a mean square of 1; a bias of 10 % (0.4 dB) adds 2.5 at 250 draws.
// Were the two ways of a pair to add in power, the floor's ghosts would be 3 dB down.
TEST(CoherentGhosts, MeanOfManySamplesIsTheExpectedImage) {
  constexpr int kDraws = 250;
  SonarModel sonar = MakeSonar(EvenAzimuthsDeg(kBeams, 1.0), 22.0, 2.8, 4.0, kBins);
  sonar.azimuth_beam_width_deg = 2.0;
  const ParameterSet parameters = Parameters();
  const Simulator acoustic(PlateBetweenMirrors(), sonar, Options(12 * kBeams, 1200));
  const AcousticGeometry geometry{sonar, acoustic.absorption_db_per_m()};
  const EchoList echoes = acoustic.TraceEchoes(Pose{});
  const Grid<float> direct = ExpectedPower(acoustic.Scatter(echoes, parameters), geometry, parameters).value;
  const Grid<float> expected =
      ExpectedPower(acoustic.Scatter(echoes, parameters, acoustic.TraceGhosts(Pose{}, parameters)), geometry,
                    parameters)
          .value;

  const RayCaster caster(PlateBetweenMirrors());
  const MirrorSurface mirrors(caster.scene(), ReflectingMaterials(caster.material_names(), parameters));
  const RayFan fan(sonar, Options(9 * kBeams, 120).fan);
  const CoherentGeometry coherent{.caster = caster,
                                  .fan = fan,
                                  .sonar = sonar,
                                  .absorption_db_per_m = acoustic.absorption_db_per_m(),
                                  .mirrors = &mirrors,
                                  .ghost_fan = &fan};
  Grid<double> sum(kBins, kBeams);
  for (int draw = 0; draw < kDraws; ++draw) {
    const Grid<float> power = CoherentPower(coherent, Pose{}, parameters, {draw + 1U, 10'000U + draw}).value;
    for (std::size_t i = 0; i < sum.size(); ++i) sum.values()[i] += power.values()[i];
  }
  double mean_square = 0.0;
  double by_ghosts = 0.0;
  int pixels = 0;
  int ghost_pixels = 0;
  for (int bin = 3; bin < kBins - 3; ++bin) {
    for (int beam = 0; beam < kBeams; ++beam) {
      const double ratio = sum(bin, beam) / kDraws / double{expected(bin, beam)};
      const double z = (ratio - 1.0) * std::sqrt(kDraws);
      EXPECT_LT(std::abs(z), 5.5) << "bin " << bin << ", beam " << beam;
      mean_square += z * z;
      ++pixels;
      if (!(expected(bin, beam) > 3.0F * direct(bin, beam))) continue;
      by_ghosts += ratio;
      ++ghost_pixels;
    }
  }
  RecordProperty("mean_square", std::to_string(mean_square / pixels));
  RecordProperty("ghosts_db", std::to_string(DbFromPower(by_ghosts / ghost_pixels)));
  EXPECT_GT(ghost_pixels, 60);
  // Speckle is correlated over some ten pixels.
  EXPECT_NEAR(mean_square / pixels, 1.0, 5.0 * std::sqrt(2.0 * 10.0 / pixels));
  EXPECT_NEAR(by_ghosts / ghost_pixels, 1.0, 4.5 / std::sqrt(kDraws * ghost_pixels / 10.0));
}

}  // namespace
}  // namespace sonarcal::sim
