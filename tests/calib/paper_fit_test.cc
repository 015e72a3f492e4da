// The fit of the paper's model to SYNTHETIC recordings of 8 bits that the model itself simulated, with errors
// of range and azimuth: the truth lies within the stated errors, from any start, and what is degenerate is
// said.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "calib/fit.h"
#include "sim/paper/paper_values.h"
#include "sim/physics/gsab.h"
#include "tests/calib/small_tank.h"

namespace sonarcal::calib {
namespace {

using testing::MakeFitFrames;
using testing::SmallSonar;
using testing::SmallTank;
using testing::SmallTankOptions;

constexpr int kDraws = 5;

class PaperFitToItself : public ::testing::Test {
 protected:
  static sim::SimulationOptions Options(std::uint64_t seed) {
    sim::SimulationOptions options = SmallTankOptions();
    options.bits = 8;
    options.noise = true;
    options.seed = seed;
    return options;
  }

  static ParameterSet Start() { return sim::PaperValues(SmallSonar(), {"floor", "box"}); }

  // On the narrow display of the paper's values most of the floor is below one grey level.
  static ParameterSet Truth() {
    ParameterSet truth = Start();
    truth.materials["floor"].gsab = {.a = 50.0, .b_deg = 5.0, .c = 70.0, .d = 1.5, .e = 40.0, .f_deg = 14.0};
    truth.materials["box"].gsab = {.a = 120.0, .b_deg = 3.0, .c = 30.0, .d = 1.0, .e = 60.0, .f_deg = 11.0};
    return truth;
  }

  static std::vector<FitFrame> Frames(std::uint64_t seed) {
    const sim::Simulator noisy(SmallTank(), SmallSonar(), Options(seed));
    return MakeFitFrames(noisy, [&](const sim::EchoList& echoes, int frame) {
      return noisy.RenderEchoes(echoes, Truth(), frame);
    });
  }

  FitResult FitFrom(const ParameterSet& start, const std::vector<FitFrame>& frames) const {
    return FitPaperModel(frames, geometry_, materials_, start, {}, {});
  }

  // Fits to kDraws independent recordings, computed once for all tests.
  const std::vector<FitResult>& Fits() const {
    static const std::vector<FitResult> kFits = [this] {
      std::vector<FitResult> made;
      for (int draw = 0; draw < kDraws; ++draw) made.push_back(FitFrom(Start(), Frames(10 + draw)));
      return made;
    }();
    return kFits;
  }

  sim::Simulator simulator_{SmallTank(), SmallSonar(), Options(1)};
  sim::ImageGeometry geometry_{simulator_.sonar(), simulator_.absorption_db_per_m()};
  std::vector<std::string> materials_ = {"floor", "box"};
};

TEST_F(PaperFitToItself, TheTruthLiesWithinTheStatedErrors) {
  sim::PaperParameters<double> truth = sim::PaperParametersFor(Truth(), materials_);
  int fitted = 0;
  int within_two = 0;
  int angles = 0;
  int angles_within_two = 0;
  double largest = 0.0;
  for (const FitResult& fit : Fits()) {
    ASSERT_TRUE(fit.usable) << fit.report.termination;
    EXPECT_THAT(fit.report.warnings, ::testing::IsEmpty());
    for (const CatalogEntry& entry : BuildCatalog(materials_)) {
      const FittedParameter* parameter = fit.report.Find(entry.name);
      if (parameter->status != ParameterStatus::kFree) continue;
      const double off = (parameter->value - PaperSlot(truth, entry)) / parameter->sigma.value();
      ++fitted;
      within_two += std::abs(off) < 2.0 ? 1 : 0;
      largest = std::max(largest, std::abs(off));
    }
    for (const FittedCurve& curve : fit.report.curves) {
      const GsabParameters<double> of_truth = Truth().Material(curve.material).gsab;
      for (std::size_t i = 0; i < curve.incidence_deg.size(); ++i) {
        const double deg = curve.incidence_deg[i];
        if (deg < 10.0 || deg > 80.0) continue;
        ++angles;
        const double off_db = curve.backscatter_db[i] - sim::GsabDb(of_truth, deg);
        angles_within_two += std::abs(off_db) < 2.0 * curve.sigma_db[i] ? 1 : 0;
      }
    }
  }
  // The span, both errors and a value of a curve at least: the parts of a curve are rarely told one by one.
  EXPECT_GE(fitted, 4 * kDraws);
  EXPECT_GE(angles, 2 * 10 * kDraws);
  EXPECT_GE(angles_within_two, angles * 85 / 100) << "of " << angles;
  EXPECT_GE(within_two, fitted * 85 / 100) << "of " << fitted;
  EXPECT_LT(largest, 4.0);
}

// Two starts: the paper's values, and a display of 70 dB with other curves. The expected images are compared,
// because parameters that the frames do not determine stay at their priors.
TEST_F(PaperFitToItself, AnotherStartEndsAtTheSamePlace) {
  const std::vector<FitFrame> frames = Frames(3);
  ParameterSet other = Start();
  other.display.db_max = 220.0;
  for (auto& [name, material] : other.materials)
    material.gsab = {.a = 3.0, .b_deg = 8.0, .c = 2.0, .d = 2.5, .e = 1.0, .f_deg = 30.0};
  const FitResult first = FitFrom(Start(), frames);
  const FitResult second = FitFrom(other, frames);
  ASSERT_TRUE(first.usable && second.usable);
  EXPECT_NEAR(second.report.cost_final / first.report.cost_final, 1.0, 1e-3);
  const PaperFrameModel model(frames, geometry_, materials_, Start());
  EXPECT_LT(model.RmsDifference(model.Values(first.parameters), model.Values(second.parameters)), 1e-3);
}

// On average over draws: standard errors alone would hide a bias that all draws share.
TEST_F(PaperFitToItself, TheFloorsCurveHasNoBias) {
  double mean_off_db = 0.0;
  for (const FitResult& fit : Fits()) {
    ASSERT_TRUE(fit.usable);
    mean_off_db += (sim::GsabDb(fit.parameters.Material("floor").gsab, 60.0) -
                    sim::GsabDb(Truth().Material("floor").gsab, 60.0)) /
                   kDraws;
  }
  EXPECT_NEAR(mean_off_db, 0.0, 2.0);
}

}  // namespace
}  // namespace sonarcal::calib
