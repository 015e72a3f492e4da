#include "calib/fit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "calib/fit_starts.h"
#include "calib/paper/paper_frame_model.h"
#include "calib/problem_builder.h"
#include "sim/physics/gsab.h"
#include "tests/calib/curve_model.h"
#include "tests/calib/small_tank.h"

namespace sonarcal::calib {
namespace {

using testing::MakeFitFrames;
using testing::SmallSonar;
using testing::SmallTank;
using testing::SmallTankOptions;
using testing::SmallTankTruth;

ParameterSet FarFromTruth() {
  ParameterSet start = SmallTankTruth();
  start.display.db_max = 172.0;
  for (auto& [name, material] : start.materials) {
    material.gsab = {.a = 10.0, .b_deg = 6.0, .c = 1.0, .d = 2.0, .e = 3.0, .f_deg = 20.0};
  }
  start.jitter.sigma_range_m = 0.05;
  start.jitter.sigma_azimuth_deg = 1.2;
  return start;
}

class PaperFitTest : public ::testing::Test {
 protected:
  // A noisy sample of the paper model, ray by ray, in whole grey levels: not the blurred mean that is fitted.
  static std::vector<FitFrame> NoisyFrames(std::uint64_t seed) {
    sim::SimulationOptions options = SmallTankOptions();
    options.noise = true;
    options.seed = seed;
    const sim::Simulator noisy(SmallTank(), SmallSonar(), options);
    return MakeFitFrames(noisy, [&](const sim::EchoList& echoes, int frame) {
      return noisy.RenderEchoes(echoes, SmallTankTruth(), frame);
    });
  }

  sim::Simulator simulator_{SmallTank(), SmallSonar(), SmallTankOptions()};
  sim::ImageGeometry geometry_{simulator_.sonar(), simulator_.absorption_db_per_m()};
  std::vector<std::string> materials_ = {"floor", "box"};
};

TEST_F(PaperFitTest, TheTrueParametersAreFoundWithinThreeStandardErrors) {
  const std::vector<FitFrame> frames = NoisyFrames(7);
  const std::int64_t rays_before = simulator_.caster().rays_cast();
  const FitResult fit = FitPaperModel(frames, geometry_, materials_, FarFromTruth(), {}, {});
  EXPECT_EQ(simulator_.caster().rays_cast(), rays_before) << "a fit of materials casts no ray";
  ASSERT_TRUE(fit.usable) << fit.report.termination;
  EXPECT_LT(fit.report.cost_final, fit.report.cost_initial);

  sim::PaperParameters<double> truth = sim::PaperParametersFor(SmallTankTruth(), materials_);
  int free_count = 0;
  for (const CatalogEntry& entry : BuildCatalog(materials_)) {
    const FittedParameter* fitted = fit.report.Find(entry.name);
    ASSERT_NE(fitted, nullptr) << entry.name;
    if (fitted->status != ParameterStatus::kFree) continue;
    ++free_count;
    ASSERT_TRUE(fitted->sigma.has_value()) << entry.name;
    EXPECT_NEAR(fitted->value, PaperSlot(truth, entry), 3.0 * *fitted->sigma) << entry.name;
  }
  EXPECT_GE(free_count, 12);
  // A sigma so wide that it could not fail would say nothing: the dB range is known to a tenth of itself.
  EXPECT_LT(*fit.report.Find("display.db_max")->sigma, 1.0);

  // The curves, where the data show them well.
  for (const std::string& name : materials_) {
    for (const double incidence_deg : {15.0, 30.0, 45.0, 60.0}) {
      EXPECT_NEAR(sim::GsabDb(fit.parameters.Material(name).gsab, incidence_deg),
                  sim::GsabDb(SmallTankTruth().Material(name).gsab, incidence_deg), 1.5)
          << name << " at " << incidence_deg;
    }
  }
}

TEST_F(PaperFitTest, AMaterialThatIsNotSeenIsNotIdentifiable) {
  std::vector<FitFrame> frames = NoisyFrames(8);
  frames.resize(1);
  materials_.emplace_back("lid");
  for (FitFrame& frame : frames) frame.echoes.materials = 3;
  ParameterSet start = SmallTankTruth();
  start.materials["lid"];
  const FitConfig config{.free = std::vector<std::string>{"material.lid.gsab.*", "display.db_max"},
                         .fixed = {},
                         .bounds = {},
                         .held_out = {}};
  const FitResult fit = FitPaperModel(frames, geometry_, materials_, start, config, {});
  ASSERT_TRUE(fit.usable);
  const FittedParameter* lid = fit.report.Find("material.lid.gsab.C");
  EXPECT_EQ(lid->status, ParameterStatus::kUnidentifiable);
  EXPECT_FALSE(lid->sigma.has_value());
  EXPECT_EQ(lid->value, lid->initial);
  EXPECT_THAT(fit.report.unidentifiable_directions,
              ::testing::Contains(::testing::HasSubstr("material.lid")));
}

TEST_F(PaperFitTest, AMaterialThatIsNotSeenKeepsNoLevelFromBeingFound) {
  std::vector<FitFrame> frames = NoisyFrames(8);
  materials_.emplace_back("lid");
  for (FitFrame& frame : frames) frame.echoes.materials = 3;
  ParameterSet dark = SmallTankTruth();
  for (auto& [name, material] : dark.materials) {
    for (double* amplitude : {&material.gsab.a, &material.gsab.c, &material.gsab.e}) *amplitude *= 1e-6;
  }
  dark.materials["lid"] = dark.materials["box"];
  const PaperFrameModel model(frames, geometry_, materials_, dark);
  const std::vector<CatalogEntry>& catalog = model.catalog();
  const ParameterValues start = model.Values(dark);
  std::vector<bool> free;
  for (const CatalogEntry& entry : catalog) {
    free.push_back(entry.group == ParameterGroup::kGsab && !entry.name.starts_with("material.lid."));
  }
  const ParameterValues found = SearchLevel(model, catalog, free, start);
  for (std::size_t i = 0; i < catalog.size(); ++i) {
    if (!IsAmplitude(catalog[i])) continue;
    if (free[i]) {
      EXPECT_GT(found[i], 1e3 * start[i]) << catalog[i].name;
    } else {
      EXPECT_EQ(found[i], start[i]) << catalog[i].name;
    }
  }
}

TEST_F(PaperFitTest, TheGaugeIsNotGivenASmallSigma) {
  // Source level, db_min and a common factor on every curve are one number: freeing all must leave some of it
  // held.
  const FitConfig config{.free = std::vector<std::string>{"source_level", "display", "materials"},
                         .fixed = {},
                         .bounds = {},
                         .held_out = {}};
  const FitResult fit = FitPaperModel(NoisyFrames(9), geometry_, materials_, SmallTankTruth(), config, {});
  ASSERT_TRUE(fit.usable);
  EXPECT_FALSE(fit.report.unidentifiable_directions.empty());
  int level_parameters_held = 0;
  for (const char* name : {"source_level_db", "display.db_min", "display.db_max"}) {
    level_parameters_held += fit.report.Find(name)->status == ParameterStatus::kUnidentifiable ? 1 : 0;
  }
  for (const FittedParameter& p : fit.report.parameters) {
    if (p.status == ParameterStatus::kUnidentifiable) {
      EXPECT_FALSE(p.sigma.has_value()) << p.name;
    }
  }
  EXPECT_GE(level_parameters_held, 1);
}

TEST_F(PaperFitTest, PixelsThatDoNotCountDoNotBendTheFit) {
  std::vector<FitFrame> frames = NoisyFrames(10);
  frames.resize(2);
  const FitConfig config{
      .free = std::vector<std::string>{"display.db_max"}, .fixed = {}, .bounds = {}, .held_out = {}};
  FitOptions options;
  options.starts = 1;
  for (FitFrame& frame : frames) {
    frame.use.assign(frame.measured.size(), 1);
    for (std::size_t i = 0; i < frame.measured.size() / 2; ++i) {
      frame.measured[i] = 1.0;  // something bright that the scene does not contain
      frame.use[i] = 0;
    }
  }
  const FitResult fit = FitPaperModel(frames, geometry_, materials_, SmallTankTruth(), config, options);
  ASSERT_TRUE(fit.usable);
  EXPECT_NEAR(fit.report.Find("display.db_max")->value, 170.0,
              3.0 * *fit.report.Find("display.db_max")->sigma);
}

class LikelihoodFitTest : public ::testing::Test {
 protected:
  LikelihoodFitTest() {
    options_.starts = 1;
    options_.threads = 1;
    options_.test_others = false;
  }

  testing::CurveModel model_{
      {.truth = {.a = 0.126, .b_deg = 5.5, .c = 0.01, .d = 1.3, .e = 0.025, .f_deg = 17.0}}};
  ParameterValues start_ = model_.truth();
  FitConfig config_{.free = std::vector<std::string>{"materials"}};
  FitOptions options_;
};

// A prior about C, half the start, a fifth of it wide.
TEST_F(LikelihoodFitTest, TheInitialCostContainsThePriorsAsTheFinalOneDoes) {
  start_[2] *= 2.0;
  config_.priors[model_.catalog()[2].name] = std::pair{0.5 * start_[2], 0.1 * start_[2]};
  const ModelFit fit = Fit(model_, start_, config_, options_);
  ASSERT_TRUE(fit.usable);
  const double of_prior = 0.5 * std::pow(std::log(2.0) / 0.2, 2);
  EXPECT_NEAR(fit.report.cost_initial, CostAt(model_, start_, 1) + of_prior, 1e-6);
  EXPECT_LT(fit.report.cost_final, fit.report.cost_initial);
}

TEST_F(LikelihoodFitTest, AFitThatItsLimitOfIterationsEndsWarns) {
  start_[2] *= 4.0;
  start_[3] *= 0.5;
  const ModelFit whole = Fit(model_, start_, config_, options_);
  ASSERT_TRUE(whole.usable);
  EXPECT_THAT(whole.report.warnings, ::testing::IsEmpty());
  ASSERT_GT(whole.report.iterations, 2);

  options_.max_iterations = 1;
  const ModelFit cut = Fit(model_, start_, config_, options_);
  ASSERT_TRUE(cut.usable);
  ASSERT_EQ(cut.report.warnings.size(), 1U);
  EXPECT_THAT(cut.report.warnings.front(),
              ::testing::HasSubstr("the fit reached max_iterations = 1 before it converged"));
}

TEST_F(PaperFitTest, InvalidFitConfigurationsAreRefused) {
  const std::vector<FitFrame> frames = NoisyFrames(11);
  const auto fit = [&](const FitConfig& config, const std::vector<FitFrame>& with) {
    FitPaperModel(with, geometry_, materials_, SmallTankTruth(), config, {});
  };
  EXPECT_THROW(
      fit({.free = std::vector<std::string>{"materiels"}, .fixed = {}, .bounds = {}, .held_out = {}}, frames),
      DataError);
  EXPECT_THROW(fit({.free = std::vector<std::string>{"display.db_max"},
                    .fixed = {"display"},
                    .bounds = {},
                    .held_out = {}},
                   frames),
               DataError);
  EXPECT_THROW(fit({}, {}), DataError);
  std::vector<FitFrame> short_frame = frames;
  short_frame[0].measured.pop_back();
  EXPECT_THROW(fit({}, short_frame), DataError);
}

}  // namespace
}  // namespace sonarcal::calib
