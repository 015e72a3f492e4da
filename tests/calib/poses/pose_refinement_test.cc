// Poses of a known scene: the algebra of moves, and fits to small SYNTHETIC recordings made by the coherent
// model, which is not the one fitted.
#include "calib/poses/pose_refinement.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "calib/acoustic_fit.h"
#include "calib/parameters/pose_step.h"
#include "calib/poses/pose_ambiguity.h"
#include "calib/poses/pose_problem.h"
#include "sim/rays/acoustic_fan.h"
#include "tests/calib/small_tank.h"
#include "tests/calib/synthetic_tank.h"
#include "tests/support/recordings.h"

namespace sonarcal::calib {
namespace {

using testing::SmallSonar;
using testing::SmallTank;
using testing::SmallTankPoses;

PoseStep SomeStep(double scale) {
  PoseStep step;
  step << 0.02, -0.03, 0.025, 1.0, -1.3, 1.2;
  return scale * step;
}

TEST(PoseStep, StepsAndTheirInverse) {
  const Pose from = {RotationFromYawPitchRoll(0.7, -0.4, 0.2), {1.0, -2.0, 0.8}};
  const Pose to = MovePose(from, SomeStep(1.0));
  EXPECT_TRUE(StepBetween(from, to).isApprox(SomeStep(1.0), 1e-9));
  EXPECT_TRUE(StepBetween(to, to).isZero(1e-12));
  const Pose again = PoseFromNamedValues(NamedValues(to));
  EXPECT_NEAR(again.rotation.angularDistance(to.rotation), 0.0, 1e-9);
  // A step ahead of a sonar that looks along X is a step along X.
  const Pose along_x = {RotationFromYawPitchRoll(-std::numbers::pi / 2, 0.0, 0.0), {0.0, 0.0, 0.0}};
  EXPECT_NEAR(MovePose(along_x, 0.1 * PoseStep::Unit(1)).position_m.x(), 0.1, 1e-12);
}

// Of named values, angles the short way round.
PoseStep NamedDifference(const Pose& a, const Pose& b) {
  PoseStep difference = NamedValues(a) - NamedValues(b);
  for (int k = 3; k < kPoseSteps; ++k) difference(k) = std::remainder(difference(k), 360.0);
  return difference;
}

// Nine tenths of an error are gone, or what the data allow by the fit's own account. Returns the number of
// components that the fit determined.
int ExpectMostIsGone(const Pose& truth, const Pose& before, const Pose& after, const FitReport& report,
                     const std::string& name, const std::vector<int>& of = {0, 1, 2, 3, 4, 5}) {
  const PoseStep was = NamedDifference(before, truth);
  const PoseStep is = NamedDifference(after, truth);
  int told = 0;
  for (const int k : of) {
    const FittedParameter* parameter = report.Find("pose." + name + "." + kPoseNames[k]);
    if (parameter == nullptr) ADD_FAILURE() << kPoseNames[k] << " of " << name << " is not free";
    if (parameter == nullptr || !parameter->sigma) continue;
    ++told;
    EXPECT_LT(std::abs(is(k)), std::max(0.1 * std::abs(was(k)), 3.5 * *parameter->sigma))
        << parameter->name << " off by " << was(k) << ", now " << is(k) << " +- " << *parameter->sigma;
    EXPECT_LT(*parameter->sigma, k < 3 ? 0.02 : 1.0) << parameter->name;
  }
  return told;
}

// What is left of an error, in parts of it: 2 cm and 1 degree count alike.
double Left(const Pose& truth, const Pose& before, const Pose& after) {
  PoseStep scale;
  scale << 0.02, 0.02, 0.02, 1.0, 1.0, 1.0;
  return StepBetween(truth, after).cwiseQuotient(scale).norm() /
         StepBetween(truth, before).cwiseQuotient(scale).norm();
}

class SmallTankFrames : public ::testing::Test {
 protected:
  SmallTankFrames() : simulator_(SmallTank(), SmallSonar(), Options()) {
    truth_.model = EchoModel::kAcoustic;
    truth_.source_level_db = 200.0;
    truth_.display = {.db_min = 90.0, .db_max = 190.0};
    truth_.materials["floor"].gsab = {.a = 0.05, .b_deg = 5, .c = 0.004, .d = 1.5, .e = 0.01, .f_deg = 15};
    truth_.materials["box"].gsab = {.a = 0.1, .b_deg = 5, .c = 0.02, .d = 1.2, .e = 0.02, .f_deg = 15};
    truth_.receiver.noise_db = 110.0;
  }

  static sim::SimulationOptions AllRays() {
    sim::SimulationOptions options = testing::SmallTankOptions();
    options.fan = sim::AcousticFanOptions(SmallSonar(), {});
    options.bits = 8;
    return options;
  }

  // Half of the rows that a fit has by default: twice as fast, and the cost is rougher. The bounds are the
  // same.
  static sim::SimulationOptions Options() {
    sim::SimulationOptions options = AllRays();
    options.fan.rows /= 2;
    return options;
  }

  AcousticFrame Recorded(const sim::Simulator& simulator, const Pose& pose, const Pose& recorded,
                         int index) const {
    ParameterSet coherent = truth_;
    coherent.model = EchoModel::kCoherent;
    return {.index = index,
            .world_from_sonar = recorded,
            .recorded = RecordedPowers(simulator.Render(pose, coherent, index), truth_.display)};
  }

  sim::Simulator simulator_;
  ParameterSet truth_;
};

// Entries of the pose of frame 0, in the order of kPoseNames.
std::vector<int> PoseEntries(const std::vector<CatalogEntry>& catalog) {
  std::vector<int> entries;
  for (std::size_t i = 0; i < catalog.size(); ++i) {
    if (catalog[i].group == ParameterGroup::kPose && catalog[i].frame == 0)
      entries.push_back(static_cast<int>(i));
  }
  return entries;
}

Scene BoxInOpenWater() {
  Scene box = SmallTank();
  std::erase_if(box.triangles, [&, i = std::size_t{0}](const auto&) mutable {
    return box.material_names[box.triangle_material[i++]] == "floor";
  });
  box.triangle_material.assign(box.triangles.size(), box.MaterialIndex("box"));
  return box;
}

// From about the middle of the height of that box: mirrored top to bottom it looks the same.
Pose BesideTheMiddle() {
  return {RotationFromYawPitchRoll(0.05, -0.04, 0.02), {0.1, -2.3, 0.55}};
}

TEST(NearestTurnsTest, AddsWholeTurnsToAnglesOnly) {
  PoseStep named;
  named << 400.0, 0.0, -400.0, -179.0, 10.0, 177.0;
  PoseStep near;
  near << 0.0, 0.0, 0.0, 178.0, 12.0, -540.0;
  PoseStep expected;
  expected << 400.0, 0.0, -400.0, 181.0, 10.0, -543.0;
  EXPECT_TRUE(NearestTurns(named, near).isApprox(expected, 1e-12)) << NearestTurns(named, near);
}

TEST_F(SmallTankFrames, TheCostOfAPoseHasTheWeightsOfTheFit) {
  const Pose pose = SmallTankPoses()[0];
  const std::vector<AcousticFrame> frames = {Recorded(simulator_, pose, pose, 0)};
  AcousticFrameModel model(simulator_, frames, truth_);
  const ParameterValues& values = model.initial_values();
  const PoseView::Rays rays = model.RaysAt(values, simulator_.options().fan);
  const auto evaluated = [&](const PoseSmoothing& smoothing) {
    const PoseView view(model, 0, model.Parameters(values), smoothing, rays, pose);
    return view.Evaluate(view.Expected(pose, rays));
  };
  for (const PoseSmoothing& smoothing : {PoseSmoothing{}, PoseSmoothing{.bins = 4.0, .beams = 2.0}}) {
    model.TakeRepeatShares({std::vector<float>()});
    const PoseView::Evaluation full = evaluated(smoothing);
    model.TakeRepeatShares({std::vector<float>(model.pixel_count(), 0.25F)});
    const PoseView::Evaluation quarter = evaluated(smoothing);
    EXPECT_GT(full.cost, 1.0);
    EXPECT_NEAR(quarter.cost, 0.25 * full.cost, 1e-9 * full.cost);
    EXPECT_TRUE(quarter.score.isApprox(0.25 * full.score, 1e-9));
    EXPECT_TRUE(quarter.information.isApprox(0.25 * full.information, 1e-9));
  }
  std::vector<float> share;
  for (std::size_t pixel = 0; pixel < model.pixel_count(); ++pixel)
    share.push_back(0.2F + 0.1F * static_cast<float>(pixel % 7));
  model.TakeRepeatShares({share});
  const double traced = model.TracedCost(values, simulator_.options().fan);
  EXPECT_NEAR(model.speckle_cell().pixels() * evaluated({}).cost, traced, 1e-4 * traced);
}

// The angles of a pose are named from -180 to 180 degrees. This sonar looks along yaw 180.
TEST_F(SmallTankFrames, AHeadingNearHalfATurnMovesBySmallSteps) {
  const Pose pose = SmallTankPoses()[3];
  const std::vector<AcousticFrame> frames = {Recorded(simulator_, pose, pose, 3)};
  const AcousticFrameModel model(simulator_, frames, truth_);
  const std::vector<int> entries = PoseEntries(model.catalog());
  const ParameterValues& values = model.initial_values();
  const PoseProblem problem(model, model.catalog(), {}, 8, {0}, entries, values);
  for (const double turn_deg : {-2.0, 2.0}) {
    PoseStep step = PoseStep::Zero();
    step(kTurnOfSonar) = turn_deg;
    const ParameterValues moved = problem.MovedSonar(values, step);
    EXPECT_NEAR(StepBetween(pose, model.PoseOf(0, moved))(kTurnOfSonar), turn_deg, 1e-6);
    for (const int entry : entries)
      EXPECT_LT(std::abs(moved[entry] - values[entry]), 2.5) << model.catalog()[entry].name;
  }
}

TEST(OtherPoses, AFrameGoesToTheBestThatIsBetterByMoreThanAsked) {
  const std::vector<OtherPose> others = {
      {.frame = 0, .entries = {{1, 10.0}, {2, 20.0}}, .worse_by = -5.0, .sentence = {}},
      {.frame = 0, .entries = {{1, 11.0}, {2, 21.0}}, .worse_by = -9.0, .sentence = {}},
      {.frame = 0, .entries = {{1, 12.0}, {2, 22.0}}, .worse_by = 3.0, .sentence = {}},
      {.frame = 1, .entries = {{3, 30.0}}, .worse_by = -1.0, .sentence = {}},
      {.frame = 2, .entries = {{4, 40.0}}, .worse_by = 0.5, .sentence = {}}};
  ParameterValues values = {0.0, 1.0, 2.0, 3.0, 4.0};
  EXPECT_EQ(TakeBetterPoses(others, 2.0, values).size(), 1U);
  EXPECT_EQ(values, (ParameterValues{0.0, 11.0, 21.0, 3.0, 4.0}));
  EXPECT_EQ(TakeBetterPoses(others, 0.0, values).size(), 2U);
  EXPECT_EQ(values, (ParameterValues{0.0, 11.0, 21.0, 30.0, 4.0}));
  EXPECT_EQ(TakeBetterPoses({}, 0.0, values).size(), 0U);
}

// Bounds of today, not of the theory: three frames of a box on a bare floor do not separate pitch from the
// slope of a backscatter curve over range. Measured: angles end up to 1.3 deg off, positions up to 8 mm; with
// all rows of rays 2.2 deg and 27 mm.
TEST_F(SmallTankFrames, PosesWithUnknownCurvesEndWithin4CmAnd3Degrees) {
  const std::vector<Pose> poses = SmallTankPoses();
  std::vector<AcousticFrame> frames;
  for (int i : {0, 1, 3}) {
    frames.push_back(Recorded(simulator_, poses[i], MovePose(poses[i], SomeStep(i == 1 ? -1.0 : 1.0)), i));
  }
  ParameterSet initial = truth_;
  initial.materials.clear();
  initial.materials["default"].gsab = {.a = 0.05, .b_deg = 5, .c = 0.005, .d = 1.5, .e = 0.02, .f_deg = 15};
  const FitConfig config{.free = std::vector<std::string>{"materials", "receiver.noise_db", "pose"}};
  FitOptions options;
  options.starts = 1;
  const AcousticFit fit = FitAcousticModel(simulator_, frames, initial, config, options);
  ASSERT_TRUE(fit.usable);
  EXPECT_TRUE(fit.moved_poses);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const PoseStep error = NamedDifference(fit.world_from_sonar[i], poses[frames[i].index]);
    EXPECT_LT(error.head<3>().cwiseAbs().maxCoeff(), 0.04) << "frame " << frames[i].index << ", m";
    EXPECT_LT(error.tail<3>().cwiseAbs().maxCoeff(), 3.0) << "frame " << frames[i].index << ", degrees";
  }
  EXPECT_EQ(fit.report.Find("pose.mount.yaw_deg"), nullptr) << "not free";
}

// The others end up to five of their sigmas off.
TEST_F(SmallTankFrames, PlaceAndHeadingAreFoundTogetherWithTheNoise) {
  const std::vector<Pose> poses = SmallTankPoses();
  std::vector<AcousticFrame> frames;
  for (int i : {0, 1, 3}) {
    frames.push_back(Recorded(simulator_, poses[i], MovePose(poses[i], SomeStep(i == 1 ? -1.0 : 1.0)), i));
  }
  ParameterSet initial = truth_;
  initial.receiver.noise_db = 113.0;
  const FitConfig config{.free = std::vector<std::string>{"receiver.noise_db", "pose"},
                         .pose_prior = {.position_m = 0.025, .angle_deg = 1.2}};
  FitOptions options;
  options.starts = 1;
  const AcousticFit fit = FitAcousticModel(simulator_, frames, initial, config, options);
  ASSERT_TRUE(fit.usable);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const Pose& truth = poses[frames[i].index];
    const int told = ExpectMostIsGone(truth, frames[i].world_from_sonar, fit.world_from_sonar[i], fit.report,
                                      std::to_string(frames[i].index), {1, 5});
    // Frame 1 looks obliquely to the y axis: a step aside and a turn, which its picture hardly tells apart,
    // change its y, too. What its picture does tell is the way ahead.
    EXPECT_GE(told, frames[i].index == 1 ? 0 : 2) << frames[i].index;
    constexpr int kAhead = 1;
    EXPECT_LT(std::abs(StepBetween(truth, fit.world_from_sonar[i])(kAhead)),
              0.1 * std::abs(StepBetween(truth, frames[i].world_from_sonar)(kAhead)))
        << frames[i].index;
  }
}

// The error of a pose in units of what the likelihood says of it, e^T I e / 6 with the expected information I
// at the true pose, has the mean 1 if pixels count as I counts them. It has 2 here (measured 2.0 +- 0.4 over
// eight draws): the speckle of the coherent model hangs together farther than its grain, and rays come and
// go at edges. One draw varies by 2 sqrt(2 / 6), so that no limit holds for one; the mean of four by half of
// that. The start has more than 100.
TEST_F(SmallTankFrames, PosesAreFoundIfAllElseIsKnown) {
  constexpr int kDraws = 4;
  constexpr double kMean = 2.0;
  const sim::Simulator simulator(SmallTank(), SmallSonar(), AllRays());
  const Pose pose = SmallTankPoses()[1];
  std::vector<AcousticFrame> frames;
  for (int draw = 0; draw < kDraws; ++draw)
    frames.push_back(Recorded(simulator, pose, MovePose(pose, SomeStep(1.5)), 4 + draw));
  const std::vector<Pose> fitted = FitPosesOnly(simulator, frames, truth_);
  ASSERT_EQ(fitted.size(), frames.size());

  std::vector<AcousticFrame> at_truth = {frames.front()};
  at_truth.front().world_from_sonar = pose;
  const AcousticFrameModel model(simulator, at_truth, truth_);
  const std::vector<int> entries = PoseEntries(model.catalog());
  const ParameterValues& truth = model.initial_values();
  const PoseProblem problem(model, model.catalog(), {}, 1, {0}, entries, truth);
  const Eigen::MatrixXd information =
      problem.NormalAt(problem.At(truth), problem.SlopesAt(truth)).information;
  const auto in_its_units = [&](const Pose& found) {
    const PoseStep error = NamedDifference(found, pose);
    return error.dot(information * error) / kPoseSteps;
  };
  double mean = 0.0;
  for (const Pose& found : fitted) mean += in_its_units(found) / kDraws;
  EXPECT_LT(mean, kMean * (1.0 + 4.0 * std::sqrt(2.0 / (kPoseSteps * kDraws))));
  EXPECT_GT(in_its_units(frames.front().world_from_sonar), 100.0) << "no error worth removing";
}

// By two draws of speckle: four frames have so few blocks of pixels that a sigma may by chance be half of
// what it should be, and one error of one draw four of them.
TEST_F(SmallTankFrames, AMountOffsetIsDeterminedByAllFramesTogether) {
  const std::vector<Pose> recorded = SmallTankPoses();
  const Pose mount = MovePose({}, SomeStep(1.0));
  const PoseStep was = NamedDifference(Pose{}, mount);
  double squares = 0.0;
  for (const int draw : {0, 10}) {
    std::vector<AcousticFrame> frames;
    for (int i = 0; i < 4; ++i)
      frames.push_back(Recorded(simulator_, recorded[i] * mount, recorded[i], draw + i));
    const FitConfig config{.free = std::vector<std::string>{"mount"}};
    const AcousticFit fit = FitAcousticModel(simulator_, frames, truth_, config);
    ASSERT_TRUE(fit.usable);
    const PoseStep is = NamedDifference(fit.mount, mount);
    for (int k = 0; k < kPoseSteps; ++k) {
      const FittedParameter* parameter = fit.report.Find(std::string("pose.mount.") + kPoseNames[k]);
      ASSERT_TRUE(parameter != nullptr && parameter->sigma);
      EXPECT_LT(*parameter->sigma, k < 3 ? 0.02 : 1.0) << parameter->name;
      squares += std::pow(is(k) / std::max(0.1 * std::abs(was(k)), *parameter->sigma), 2);
    }
    EXPECT_LT(StepBetween(fit.world_from_sonar[2], recorded[2] * fit.mount).norm(), 1e-9);
    EXPECT_EQ(fit.report.Find("pose.0.yaw_deg"), nullptr) << "nobody freed it";
  }
  // A tenth of what it was or one sigma, root mean square.
  EXPECT_LT(std::sqrt(squares / (2 * kPoseSteps)), 1.5);
}

TEST_F(SmallTankFrames, UndeterminedPoseComponentsStayAndAreNamed) {
  // Nothing but a floor: where over it and under which heading is nowhere in the image.
  Scene floor;
  floor.material_names = {"floor"};
  floor.vertices_m = {{-50, -50, 0}, {50, -50, 0}, {50, 50, 0}, {-50, 50, 0}};
  floor.triangles = {{0, 1, 2}, {0, 2, 3}};
  floor.triangle_material = {0, 0};
  const sim::Simulator simulator(floor, SmallSonar(), Options());
  const Pose pose = {RotationFromYawPitchRoll(0.3, -0.6, 0.0), {1.0, 2.0, 1.5}};
  const Pose recorded = MovePose(pose, SomeStep(1.0));
  const FitConfig config{.free = std::vector<std::string>{"pose"}};
  const AcousticFit fit =
      FitAcousticModel(simulator, {Recorded(simulator, pose, recorded, 7)}, truth_, config);
  ASSERT_TRUE(fit.usable);
  std::string all;
  for (const std::string& words : fit.report.unidentifiable_directions) all += words + "\n";
  for (const char* name : {"pose.7.x_m", "pose.7.y_m", "pose.7.yaw_deg"}) {
    const FittedParameter* parameter = fit.report.Find(name);
    ASSERT_NE(parameter, nullptr);
    EXPECT_EQ(parameter->status, ParameterStatus::kUnidentifiable) << name;
    EXPECT_NE(all.find(name), std::string::npos) << name << " in: " << all;
  }
  EXPECT_NEAR(fit.report.Find("pose.7.x_m")->value, recorded.position_m.x(), 0.01);
  EXPECT_NEAR(fit.world_from_sonar[0].position_m.z(), pose.position_m.z(), 0.01);
  EXPECT_TRUE(fit.report.other_poses.empty()) << fit.report.other_poses.front();
}

TEST_F(SmallTankFrames, AMirrorImageIsNamed) {
  const sim::Simulator simulator(BoxInOpenWater(), SmallSonar(), Options());
  const Pose pose = BesideTheMiddle();
  const Pose mirror = ReflectedPose(pose, 0.0, 1.0);
  EXPECT_NEAR(mirror.position_m.z(), 0.45, 1e-12);
  const auto image = [&](const Pose& from) {
    return simulator.RenderExpected(simulator.TraceEchoes(from), truth_);
  };
  const Grid<float> from_pose = image(pose).value;
  const Grid<float> from_mirror = image(mirror).value;
  double difference = 0.0;
  for (std::size_t i = 0; i < from_pose.size(); ++i)
    difference += std::abs(from_pose.values()[i] - from_mirror.values()[i]);
  EXPECT_LT(difference / static_cast<double>(from_pose.size()), 0.02) << "grey levels of 255";

  const FitConfig config{.free = std::vector<std::string>{"pose"}};
  const AcousticFit fit = FitAcousticModel(simulator, {Recorded(simulator, pose, pose, 2)}, truth_, config);
  ASSERT_TRUE(fit.usable);
  std::string all;
  for (const std::string& words : fit.report.other_poses) all += words + "\n";
  EXPECT_NE(all.find("pose.2: its mirror image"), std::string::npos) << all;
}

// One frame of the box in open water. Its pose is free.
class BoxBesideTheMiddle : public SmallTankFrames {
 protected:
  BoxBesideTheMiddle() {
    FitConfig config{.free = std::vector<std::string>{"pose"}};
    ApplyFitConfigWithPriors(model_.initial_values(), config, catalog_);
  }

  static bool NamesAMirrorImage(const std::vector<OtherPose>& others) {
    return std::ranges::any_of(others, [](const OtherPose& other) {
      return other.sentence.find("its mirror image") != std::string::npos;
    });
  }

  Pose pose_ = BesideTheMiddle();
  sim::Simulator in_open_water_{BoxInOpenWater(), SmallSonar(), Options()};
  std::vector<AcousticFrame> frames_ = {Recorded(in_open_water_, pose_, pose_, 2)};
  AcousticFrameModel model_{in_open_water_, frames_, truth_};
  std::vector<CatalogEntry> catalog_ = model_.catalog();
};

// A fit that turns past half a turn goes on counting: its heading and the prior then differ by whole turns
// from the named angles of a pose.
TEST_F(BoxBesideTheMiddle, AMirrorImageIsNamedForAHeadingBeyondHalfATurn) {
  const std::vector<int> entries = PoseEntries(catalog_);
  ParameterValues values = model_.initial_values();
  const int yaw = entries[kTurnOfSonar];
  values[yaw] += 360.0;
  catalog_[yaw].prior->coordinate += 360.0;
  const std::vector<OtherPose> others = OtherPoses(model_, catalog_, entries, values);
  EXPECT_TRUE(NamesAMirrorImage(others));
  for (const OtherPose& other : others) EXPECT_LE(other.worse_by, 4.0) << other.sentence;
}

// The pose of a frame is that of the mount, which the tilt follows.
TEST_F(BoxBesideTheMiddle, AMirrorImageIsThatOfTheTiltedSonar) {
  ParameterValues values = model_.initial_values();
  const auto tilt = std::ranges::find(catalog_, "geometry.tilt_deg", &CatalogEntry::name) - catalog_.begin();
  values[tilt] = 25.0;
  const PoseStep mount = NamedValues(pose_ * model_.MountOf(values).Inverse());
  for (const int entry : PoseEntries(catalog_)) {
    values[entry] = mount(catalog_[entry].index);
    if (catalog_[entry].prior)
      catalog_[entry].prior->coordinate = catalog_[entry].CoordinateFromValue(values[entry]);
  }
  EXPECT_LT(StepBetween(model_.PoseOf(0, values), pose_).norm(), 1e-9);
  const std::vector<OtherPose> others = OtherPoses(model_, catalog_, PoseEntries(catalog_), values);
  EXPECT_TRUE(NamesAMirrorImage(others));
}

// A SYNTHETIC recording made by another kind of simulation: two frames, curves and noise unknown as well.
//
// Roll has a bound of today. Measured: frame 1 keeps -0.24 +- 0.047 deg, five standard errors. At the true
// curves the poses that explain these frames best are rolled by -0.05 to -0.10 deg, so the model is a little
// off there.
TEST(SyntheticTankPoses, ErrorsAreRemovedAndRollStaysWithinItsBound) {
  SONARCAL_NEEDS_RECORDING(folder, "synthetic_tank_poses");
  const testing::SyntheticTank tank(folder);
  const std::vector<AcousticFrame> frames = tank.Frames({0, 1});
  ParameterSet initial = WithNoiseStart(tank.known, frames);
  FitOptions options;
  options.starts = 1;
  const FitConfig config{.free = std::vector<std::string>{"materials", "noise", "pose"}};
  const AcousticFit fit = FitAcousticModel(tank.simulator, frames, initial, config, options);
  ASSERT_TRUE(fit.usable);
  constexpr int kRoll = 3;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const Pose true_pose = tank.TruePose(frames[i].index);
    EXPECT_GE(ExpectMostIsGone(true_pose, frames[i].world_from_sonar, fit.world_from_sonar[i], fit.report,
                               std::to_string(frames[i].index), {0, 1, 2, 4, 5}),
              4);
    EXPECT_LT(Left(true_pose, frames[i].world_from_sonar, fit.world_from_sonar[i]), 0.3);
    EXPECT_LT(std::abs(NamedDifference(fit.world_from_sonar[i], true_pose)(kRoll)), 0.3);
  }
}

}  // namespace
}  // namespace sonarcal::calib
