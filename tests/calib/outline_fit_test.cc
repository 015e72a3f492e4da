// Outlines found from small SYNTHETIC recordings. The recordings show meshes of their own, and the fit starts
// at another size.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "calib/acoustic_fit.h"
#include "calib/models/acoustic_frame_model.h"
#include "calib/parameters/fit_config.h"
#include "core/types/error.h"
#include "tests/calib/small_body.h"

namespace sonarcal::calib {
namespace {

// Finer than CoarseSonar: a few hundred pixels on a small body.
SonarModel FineSonar() {
  SonarModel sonar = testing::CoarseSonar();
  sonar.axes = {1.0, 2.0, 200, {}};
  for (int beam = 0; beam < 80; ++beam)
    sonar.axes.beam_azimuth_rad.push_back(RadFromDeg((beam - 39.5) * 0.3));
  sonar.azimuth_beam_width_deg = 0.4;
  sonar.elevation_beam_width_deg = 30.0;
  return sonar;
}

sim::SimulationOptions Options() {
  sim::SimulationOptions options;
  options.fan = {.sampling = sim::Sampling::kBeams,
                 .cols = 80 * 3,
                 .rows = 300,
                 .elevation_span_deg = 30.0,
                 .azimuth_margin_deg = 1.2,
                 .stagger = true,
                 .stagger_rows = true};
  options.noise = true;
  options.bits = 8;
  return options;
}

Scene Sphere(double radius_m, int rings) {
  std::vector<sim::ProfilePoint> profile;
  for (int i = 0; i <= rings; ++i) {
    const double angle = kPi * (1.0 - static_cast<double>(i) / rings);
    profile.push_back({radius_m * std::cos(angle), i % rings == 0 ? 0.0 : radius_m * std::sin(angle)});
  }
  return sim::MakeRevolution(profile, 2 * rings, false, "body");
}

Scene Cylinder(double radius_m, double max_edge_m) {
  return sim::MakeTurnedSolid({{-0.2, radius_m}, {0.2, radius_m}}, max_edge_m, "body");
}

// The sonar 1.5 m from the origin, which lies this far beside its axis.
Pose Looking(double yaw_deg, double pitch_deg, double aside_deg = 0.0) {
  const Eigen::Quaterniond towards =
      RotationFromYawPitchRoll(RadFromDeg(yaw_deg), RadFromDeg(pitch_deg), 0.0);
  return {RotationFromYawPitchRoll(RadFromDeg(yaw_deg + aside_deg), RadFromDeg(pitch_deg), 0.0),
          -1.5 * (towards * Eigen::Vector3d::UnitY())};
}

std::vector<AcousticFrame> Recorded(const Scene& scene, const std::vector<Pose>& poses) {
  const sim::Simulator simulator(scene, FineSonar(), Options());
  const ParameterSet truth = testing::BodyParameters();
  std::vector<AcousticFrame> frames;
  for (int i = 0; i < static_cast<int>(poses.size()); ++i) {
    frames.push_back({.index = i,
                      .world_from_sonar = poses[i],
                      .recorded = RecordedPowers(simulator.Render(poses[i], truth, i), truth.display)});
  }
  return frames;
}

// Values that the frames determine: their mean, and how many are off by more than three standard errors.
struct Found {
  int determined = 0;
  int by_prior = 0;
  int off = 0;
  double mean_m = 0.0;
};

Found Summary(const FitReport& report, double truth_m) {
  Found found;
  double weights = 0.0;
  for (const FittedParameter& p : report.parameters) {
    if (!p.name.starts_with("outline.")) continue;
    if (p.status == ParameterStatus::kUnidentifiable) ++found.by_prior;
    if (p.status != ParameterStatus::kFree || !p.sigma) continue;
    ++found.determined;
    found.off += std::abs(p.value - truth_m) > 3.0 * *p.sigma ? 1 : 0;
    const double weight = 1.0 / (*p.sigma * *p.sigma);
    found.mean_m += weight * p.value;
    weights += weight;
  }
  if (weights > 0.0) found.mean_m /= weights;
  return found;
}

// A fit of `start` to frames of `truth`, with these things free.
AcousticFit FitOutline(const Scene& truth, const Scene& start, const std::vector<Pose>& poses,
                       const FitConfig& config) {
  return FitAcousticModel(sim::Simulator(start, FineSonar(), Options()), Recorded(truth, poses),
                          testing::BodyParameters(), config);
}

TEST(OutlineFit, TheRadiusOfACylinderIsFound) {
  constexpr double kRadius = 0.1;
  constexpr double kLarger = 0.03 * kRadius;
  const AcousticFit fit = FitOutline(Cylinder(kRadius + kLarger, 0.01), Cylinder(kRadius, 0.02),
                                     {Looking(0, 0), Looking(40, -15), Looking(160, 10)},
                                     {.free = std::vector<std::string>{"outline:body"}});
  ASSERT_TRUE(fit.usable);
  const Found found = Summary(fit.report, kLarger);
  EXPECT_GE(found.determined, 8);
  EXPECT_LE(found.off, 1);
  EXPECT_NEAR(found.mean_m, kLarger, 0.0007);
  EXPECT_THAT(fit.report.warnings, ::testing::Contains(::testing::HasSubstr("only another pose of it")));
  // The simulator of the fit has the new outline.
  double radius = 0.0;
  for (const Eigen::Vector3f& v : fit.simulator->caster().scene().vertices_m)
    radius = std::max(radius, double{std::hypot(v.y(), v.z())});
  EXPECT_GT(radius, kRadius + 0.5 * kLarger);
}

TEST(OutlineFit, TheNearSideOfASphereIsFoundAndTheFarSideKeepsItsPrior) {
  constexpr double kRadius = 0.15;
  constexpr double kLarger = 0.03 * kRadius;
  const AcousticFit fit = FitOutline(Sphere(kRadius + kLarger, 48), Sphere(kRadius, 36),
                                     {Looking(0, 0), Looking(30, 0), Looking(-30, -20)},
                                     {.free = std::vector<std::string>{"outline"}});
  ASSERT_TRUE(fit.usable);
  const Found found = Summary(fit.report, kLarger);
  EXPECT_GE(found.determined, 5);
  EXPECT_GE(found.by_prior, 5);
  EXPECT_LE(found.off, 1 + found.determined / 8);
  EXPECT_NEAR(found.mean_m, kLarger, 0.001);
}

TEST(OutlineFit, ThePriorDecidesWhereNothingIsSeen) {
  // Half of the cylinder lies beside the beams.
  const FitConfig config{.free = std::vector<std::string>{"outline:body"},
                         .priors = {{"outline:body", std::pair{0.0, 0.004}},
                                    {"outline.body.radius_13_m", std::pair{0.001, 0.002}}}};
  const AcousticFit fit =
      FitOutline(Cylinder(0.103, 0.01), Cylinder(0.1, 0.02), {Looking(0, 0, 12.0)}, config);
  ASSERT_TRUE(fit.usable);
  for (int station = 10; station <= 13; ++station) {
    const FittedParameter* p = fit.report.Find(fmt::format("outline.body.radius_{:02}_m", station));
    ASSERT_NE(p, nullptr) << station;
    EXPECT_EQ(p->status, ParameterStatus::kUnidentifiable) << station;
    EXPECT_NEAR(p->value, station == 13 ? 0.001 : 0.0, 1e-4) << station << ": the closest prior decides";
  }
}

TEST(OutlineFit, NamesThatMeanNoPartAreRefusedInOneSentence) {
  Scene two = Cylinder(0.1, 0.05);
  two.Append(sim::MakeBox({1.0, 0.0, 0.0}, {1.1, 0.1, 0.1}, sim::kUndivided, "box"));
  const sim::Simulator simulator(two, FineSonar(), Options());
  ParameterSet parameters = testing::BodyParameters();
  parameters.materials["box"] = parameters.materials["body"];
  const std::vector<AcousticFrame> frames = Recorded(Cylinder(0.1, 0.05), {Looking(0, 0)});
  const auto message = [&](const std::string& free) -> std::string {
    try {
      FitAcousticModel(simulator, frames, parameters, {.free = std::vector<std::string>{free}});
    } catch (const DataError& error) {
      return error.what();
    }
    return "none";
  };
  EXPECT_EQ(message("outline:nose"), "no object 'nose' in the scene, expected one of body, box");
  EXPECT_EQ(
      message("outline"),
      "'outline' without a name needs a scene of one part, expected outline:NODE with one of body, box");
}

}  // namespace
}  // namespace sonarcal::calib
