// Geometry of the sonar and placement of objects, found from small SYNTHETIC recordings of the coherent
// model, which is not the one fitted.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "calib/acoustic_fit.h"
#include "calib/models/acoustic_frame_model.h"
#include "calib/parameters/object_placement.h"
#include "calib/parameters/placement_steps.h"
#include "calib/problem_builder.h"
#include "calib/solve.h"
#include "core/types/error.h"
#include "sim/rays/acoustic_fan.h"
#include "tests/calib/small_tank.h"

namespace sonarcal::calib {
namespace {

using testing::SmallSonar;
using testing::SmallTank;
using testing::SmallTankPoses;

constexpr SonarGeometry kTrue = {.range_offset_m = -0.03,
                                 .range_scale = 1.012,
                                 .azimuth_offset_deg = 0.7,
                                 .azimuth_scale = 0.98,
                                 .azimuth_cubic = 0.0};

class GeometryFit : public ::testing::Test {
 protected:
  GeometryFit() : simulator_(SmallTank(), SmallSonar(), Options()) {
    truth_ = testing::SmallTankAcousticTruth();
    truth_.display = {.db_min = 110.0, .db_max = 190.0};
  }

  static sim::SimulationOptions Options() {
    sim::SimulationOptions options = testing::SmallTankOptions();
    options.fan = sim::AcousticFanOptions(SmallSonar(), {});
    options.bits = 8;
    return options;
  }

  // Recorded by a sonar whose axes are those of `geometry`, in a scene of its own.
  std::vector<AcousticFrame> Recorded(const Scene& scene, const SonarGeometry& geometry) const {
    SonarModel sonar = SmallSonar();
    sonar.axes = Corrected(sonar.axes, geometry);
    const sim::Simulator simulator(scene, sonar, Options());
    ParameterSet coherent = truth_;
    coherent.model = EchoModel::kCoherent;
    std::vector<AcousticFrame> frames;
    const std::vector<Pose> poses = SmallTankPoses();
    for (int i = 0; i < static_cast<int>(poses.size()); ++i) {
      frames.push_back({.index = i,
                        .world_from_sonar = poses[i],
                        .recorded = RecordedPowers(simulator.Render(poses[i], coherent, i), truth_.display)});
    }
    return frames;
  }

  static void ExpectFound(const FitReport& report, const std::string& name, double truth,
                          double largest_sigma) {
    const FittedParameter* parameter = report.Find(name);
    ASSERT_NE(parameter, nullptr) << name;
    ASSERT_TRUE(parameter->sigma) << name;
    EXPECT_LT(std::abs(parameter->value - truth), 4.0 * *parameter->sigma)
        << name << " " << parameter->value << " +- " << *parameter->sigma << ", truth " << truth;
    EXPECT_LT(*parameter->sigma, largest_sigma) << name;
  }

  sim::Simulator simulator_;
  ParameterSet truth_;
};

TEST_F(GeometryFit, RangeAndAzimuthAreFoundWithTheNoise) {
  ParameterSet initial = truth_;
  initial.receiver.noise_db = *truth_.receiver.noise_db + 3.0;
  const FitConfig config{.free = std::vector<std::string>{"receiver.noise_db", "geometry.range_*",
                                                          "geometry.azimuth_offset_deg",
                                                          "geometry.azimuth_scale"}};
  const AcousticFit fit = FitAcousticModel(simulator_, Recorded(SmallTank(), kTrue), initial, config);
  ASSERT_TRUE(fit.usable);
  EXPECT_FALSE(fit.moved_poses);
  ExpectFound(fit.report, "geometry.range_offset_m", kTrue.range_offset_m, 0.01);
  ExpectFound(fit.report, "geometry.range_scale", kTrue.range_scale, 0.005);
  ExpectFound(fit.report, "geometry.azimuth_offset_deg", kTrue.azimuth_offset_deg, 0.2);
  ExpectFound(fit.report, "geometry.azimuth_scale", kTrue.azimuth_scale, 0.02);
  EXPECT_EQ(fit.report.Find("geometry.tilt_deg"), nullptr) << "not free";
  // The fitted simulator has the fitted axes; a scene of another size and a turned mount are named.
  EXPECT_TRUE(fit.simulator->sonar().axes.Matches(Corrected(SmallSonar().axes, fit.geometry)));
  ASSERT_EQ(fit.report.ambiguities.size(), 2U);
  EXPECT_NE(fit.report.ambiguities[0].find("smaller"), std::string::npos) << fit.report.ambiguities[0];
  EXPECT_NE(fit.report.ambiguities[1].find("to the right"), std::string::npos) << fit.report.ambiguities[1];
}

TEST_F(GeometryFit, AnObjectIsFoundWhereItStood) {
  Scene moved = SmallTank();
  ObjectPlacement placement;
  placement.step << 0.06, -0.04, 0.0, 0.0, 0.0, 4.0;
  PlaceableObject(moved, "box").Place(placement, moved);
  const FitConfig config{
      .free = std::vector<std::string>{"object.box.x_m", "object.box.y_m", "object.box.yaw_deg"}};
  const AcousticFit fit = FitAcousticModel(simulator_, Recorded(moved, {}), truth_, config);
  ASSERT_TRUE(fit.usable);
  ExpectFound(fit.report, "object.box.x_m", 0.06, 0.02);
  ExpectFound(fit.report, "object.box.y_m", -0.04, 0.02);
  ExpectFound(fit.report, "object.box.yaw_deg", 4.0, 1.5);
  // The top of the box, one metre up, lies where the fit says.
  const Scene& fitted = fit.simulator->caster().scene();
  EXPECT_NEAR(fitted.vertices_m.back().z(), 1.0, 1e-6);
}

// Two fits about one point, each with its own grid of rays, end apart by what the difference of their scores
// predicts.
TEST_F(GeometryFit, ErrorsOfTheScoreAreTheMoveFromOneGridOfRaysToAnother) {
  const std::vector<AcousticFrame> frames = Recorded(SmallTank(), {});
  sim::SimulationOptions options = Options();
  options.fan.rows /= 8;
  const sim::Simulator simulator(SmallTank(), SmallSonar(), options);
  options.fan.rows += options.fan.rows / 7;
  const sim::Simulator other_simulator(SmallTank(), SmallSonar(), options);
  AcousticFrameModel model(simulator, frames, truth_, {"box"});
  AcousticFrameModel by_other_rays(other_simulator, frames, truth_, {"box"});
  FitConfig config{.free = std::vector<std::string>{"object.box.x_m", "object.box.y_m"}};
  std::vector<CatalogEntry> catalog = model.catalog();
  FitState state{.active = {}, .values = model.initial_values()};
  const std::vector<bool> free = ApplyFitConfigWithPriors(state.values, config, catalog);
  for (std::size_t i = 0; i < free.size(); ++i) {
    if (free[i]) state.active.push_back(static_cast<int>(i));
  }
  ASSERT_EQ(state.active.size(), 2U);
  model.Linearise(state.values, state.active);
  by_other_rays.Linearise(state.values, state.active);
  const SolveLimits exact{.function_tolerance = 1e-14};
  ASSERT_TRUE(SolveFit(model, catalog, exact, {}, state).usable);
  FitState others = state;
  ASSERT_TRUE(SolveFit(by_other_rays, catalog, exact, {}, others).usable);

  NormalEquations equations = Accumulate(model, catalog, state, {});
  Eigen::MatrixXd information = equations.information;
  information.diagonal() += equations.prior;
  Eigen::VectorXd difference = Eigen::VectorXd::Zero(2);
  const std::vector<Eigen::VectorXd> errors = ScoreErrors(model, by_other_rays, catalog, state);
  EXPECT_EQ(errors.size(), frames.size());
  for (const Eigen::VectorXd& error : errors) difference += std::numbers::sqrt2 * error;
  const Eigen::VectorXd predicted = information.ldlt().solve(difference);
  Eigen::VectorXd moved(2);
  for (int k = 0; k < 2; ++k) moved(k) = others.values[state.active[k]] - state.values[state.active[k]];
  EXPECT_GT(moved.norm(), 1e-4) << "m, otherwise nothing is tested";
  EXPECT_LT((moved - predicted).norm(), 0.2 * moved.norm())
      << moved.transpose() << ", " << predicted.transpose();

  // The standard errors of a fit grow by it.
  const ModelFit alone = Fit(model, state.values, config);
  const ModelFit with_others = Fit(model, state.values, config, {}, &by_other_rays);
  for (const char* name : {"object.box.x_m", "object.box.y_m"})
    EXPECT_GT(*with_others.report.Find(name)->sigma, *alone.report.Find(name)->sigma) << name;
}

TEST_F(GeometryFit, AnUnknownObjectIsRefused) {
  const FitConfig config{.free = std::vector<std::string>{"object:lighthouse"}};
  EXPECT_THROW(FitAcousticModel(simulator_, Recorded(SmallTank(), {}), truth_, config), DataError);
}

// The slope along a scale is that along the offset, times range or azimuth. Check: traces with scaled axes.
TEST_F(GeometryFit, SlopesAlongScalesAreThoseOfTracedImages) {
  constexpr double kNoise = 1e12;
  sim::RayFanOptions dense = simulator_.options().fan;
  dense.rows *= 4;
  dense.cols *= 4;
  std::vector<AcousticFrame> frames = Recorded(SmallTank(), {});
  frames.resize(1);
  AcousticFrameModel model(simulator_, frames, truth_);
  std::vector<int> geometric;
  for (std::size_t i = 0; i < model.catalog().size(); ++i) {
    if (ChangesAxes(model.catalog()[i])) geometric.push_back(static_cast<int>(i));
  }
  const ParameterValues values = model.initial_values();
  model.Linearise(values, geometric);
  ASSERT_EQ(model.echoes()[0].slopes.size(), 5U);
  for (const EchoSlope& slope : model.echoes()[0].slopes) {
    const double step = 0.25 * PlacementDifference(SmallSonar().axes, model.catalog()[slope.entry]);
    const auto traced = [&](double by) {
      ParameterValues moved = values;
      moved[slope.entry] += by;
      return model.EchoPowerFrom(0, frames[0].world_from_sonar, truth_, model.RaysAt(moved, dense));
    };
    const Grid<double> above = traced(step);
    const Grid<double> below = traced(-step);
    double product = 0.0;
    double of_slope = 0.0;
    double of_traced = 0.0;
    for (std::size_t i = 0; i < above.size(); ++i) {
      // What the mean power of a pixel changes by, as a share of it.
      const double power = 0.5 * (above.values()[i] + below.values()[i]);
      const double expected = (above.values()[i] - below.values()[i]) / (2.0 * step * (power + kNoise));
      const double found = slope.logarithm[i] * power / (power + kNoise);
      product += expected * found;
      of_slope += found * found;
      of_traced += expected * expected;
    }
    ASSERT_GT(of_traced, 0.0);
    EXPECT_GT(product / std::sqrt(of_slope * of_traced), 0.9) << model.catalog()[slope.entry].name;
    EXPECT_NEAR(of_slope / of_traced, 1.0, 0.25) << model.catalog()[slope.entry].name;
  }
}

}  // namespace
}  // namespace sonarcal::calib
