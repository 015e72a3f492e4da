#include "calib/parameters/parameter_catalog.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "core/types/units.h"

namespace sonarcal::calib {
namespace {

using ::testing::ElementsAre;
using ::testing::ElementsAreArray;

std::vector<std::string> NamesOf(const std::vector<CatalogEntry>& catalog) {
  std::vector<std::string> names;
  for (const CatalogEntry& entry : catalog) {
    if (!IsPlacement(entry)) names.push_back(entry.name);
  }
  return names;
}

const CatalogEntry& Find(const std::vector<CatalogEntry>& catalog, const std::string& name) {
  return *std::ranges::find(catalog, name, &CatalogEntry::name);
}

// Ten beams of 2 degrees, 100 bins of 0.04 m.
SonarModel Sonar() {
  SonarModel sonar;
  sonar.axes.range_min_m = 1.0;
  sonar.axes.range_max_m = 5.0;
  sonar.axes.range_bins = 100;
  for (int beam = 0; beam < 10; ++beam) sonar.axes.beam_azimuth_rad.push_back(RadFromDeg(2.0 * beam - 9.0));
  return sonar;
}

TEST(ParameterCatalog, HasTheParametersOfThePaperModelInTheirOrder) {
  EXPECT_THAT(NamesOf(BuildCatalog({"floor"})),
              ElementsAre("source_level_db", "display.db_min", "display.db_max", "material.floor.gsab.A",
                          "material.floor.gsab.B_deg", "material.floor.gsab.C", "material.floor.gsab.D",
                          "material.floor.gsab.E", "material.floor.gsab.F_deg", "jitter.sigma_range_m",
                          "jitter.sigma_azimuth_deg", "jitter.reference_range_m"));
}

TEST(ParameterCatalog, HasTheParametersOfTheAcousticModelInTheirOrder) {
  const std::vector<std::string> expected = {"source_level_db",
                                             "receiver.gain_db",
                                             "receiver.noise_db",
                                             "receiver.noise_slope_db_per_m",
                                             "beam.azimuth_width_deg",
                                             "beam.elevation_width_deg",
                                             "pulse.length_m",
                                             "material.floor.gsab.A",
                                             "material.floor.gsab.B_deg",
                                             "material.floor.gsab.C",
                                             "material.floor.gsab.D",
                                             "material.floor.gsab.E",
                                             "material.floor.gsab.F_deg"};
  EXPECT_THAT(NamesOf(BuildAcousticCatalog({"floor"}, Sonar(), {})), ElementsAreArray(expected));
  std::vector<std::string> with_mirror = expected;
  with_mirror.insert(with_mirror.end(), {"beam.transmit_end_deg", "mirror.floor.loss_db"});
  EXPECT_THAT(NamesOf(BuildAcousticCatalog({"floor"}, Sonar(), {}, {1})), ElementsAreArray(with_mirror));
}

TEST(ParameterCatalog, PlacementsAreTheGeometryAndEachObjectAsDeclared) {
  const std::vector<CatalogEntry> catalog = BuildAcousticCatalog({"floor"}, Sonar(), {}, {}, {"mock.up"});
  SonarGeometry geometry;
  int geometry_count = 0;
  int object_count = 0;
  for (const CatalogEntry& entry : catalog) {
    if (entry.group == ParameterGroup::kGeometry) {
      ++geometry_count;
      SetGeometry(entry.name, DeclaredValue(entry), geometry);
    }
    object_count += entry.group == ParameterGroup::kObject ? 1 : 0;
  }
  EXPECT_EQ(geometry_count, 6);
  EXPECT_EQ(object_count, 9);
  EXPECT_EQ(geometry, SonarGeometry());
  EXPECT_EQ(DeclaredValue(Find(catalog, "object.mock.up.scale_z")), 1.0);
  EXPECT_EQ(DeclaredValue(Find(catalog, "object.mock.up.yaw_deg")), 0.0);
  // The corrected window begins ahead of the sonar, which is 1 m from it.
  EXPECT_EQ(Find(catalog, "geometry.range_offset_m").lower, -0.7);
}

TEST(ParameterCatalog, LimitsFollowTheSonar) {
  const auto catalog = BuildAcousticCatalog({"floor"}, Sonar(), {}, {1});
  const auto expect = [&](const std::string& name, double lower, double upper, double step) {
    const CatalogEntry& entry = Find(catalog, name);
    EXPECT_NEAR(entry.lower, lower, 1e-12) << name;
    EXPECT_NEAR(entry.upper, upper, 1e-12) << name;
    EXPECT_NEAR(entry.typical_step, step, 1e-12) << name;
  };
  expect("beam.azimuth_width_deg", 0.25, 32.0, 1.0);
  expect("beam.elevation_width_deg", 0.125, 120.0, 1.0);
  expect("pulse.length_m", 0.005, 0.64, 1.0);
  expect("receiver.noise_slope_db_per_m", -25.0, 25.0, 5.0);
  expect("beam.transmit_end_deg", 11.0, 70.0, 20.0);
  expect("mirror.floor.loss_db", 0.0, 60.0, 10.0);
}

// Ten beams whose outer edges lie `edge_deg` off the axis.
SonarModel SonarUpTo(double edge_deg) {
  SonarModel sonar = Sonar();
  for (double& azimuth_rad : sonar.axes.beam_azimuth_rad) azimuth_rad *= edge_deg / 10.0;
  return sonar;
}

TEST(ParameterCatalog, LimitsStayWithinThoseOfTheFile) {
  const auto transmit_end = [](double edge_deg) {
    return Find(BuildAcousticCatalog({"floor"}, SonarUpTo(edge_deg), {}, {1}), "beam.transmit_end_deg");
  };
  EXPECT_NEAR(transmit_end(29.0).upper, 89.0, 1e-9);
  EXPECT_EQ(transmit_end(60.0).upper, 90.0);
  EXPECT_NEAR(transmit_end(60.0).lower, 61.0, 1e-9);
  const std::vector<CatalogEntry> none = BuildAcousticCatalog({"floor"}, SonarUpTo(89.5), {}, {1});
  EXPECT_EQ(std::ranges::count(none, std::string("beam.transmit_end_deg"), &CatalogEntry::name), 0);
  SonarModel sonar = Sonar();
  sonar.elevation_beam_width_deg = 200.0;
  EXPECT_EQ(Find(BuildAcousticCatalog({"floor"}, sonar, {}), "beam.elevation_width_deg").upper, 360.0);
}

TEST(ParameterCatalog, SlotsAreThePlacesOfTheValues) {
  ParameterSet set;
  set.receiver.noise_db = 1.0;
  set.materials["wall"];
  set.mirrors["wall"];
  const auto catalog = BuildAcousticCatalog({"floor", "wall"}, Sonar(), {}, {0, 1});
  const auto slot = [&](const std::string& name) -> double* {
    return &AcousticSlot(set, {"floor", "wall"}, Find(catalog, name));
  };
  EXPECT_EQ(slot("source_level_db"), &set.source_level_db);
  EXPECT_EQ(slot("receiver.gain_db"), &set.receiver.gain_db);
  EXPECT_EQ(slot("receiver.noise_db"), &*set.receiver.noise_db);
  EXPECT_EQ(slot("receiver.noise_slope_db_per_m"), &set.receiver.noise_slope_db_per_m);
  EXPECT_EQ(slot("beam.elevation_width_deg"), &set.beam.elevation_width_deg);
  EXPECT_EQ(slot("beam.transmit_end_deg"), &set.beam.transmit_end_deg);
  EXPECT_EQ(slot("pulse.length_m"), &set.pulse.length_m);
  EXPECT_EQ(slot("material.wall.gsab.D"), &set.materials["wall"].gsab.d);
  EXPECT_EQ(slot("mirror.wall.loss_db"), &set.mirrors["wall"].loss_db);
}

TEST(ParameterCatalog, BeamsStayWithinAFactorOfTwoOfTheWidthsThatTheSonarStates) {
  SonarModel sonar = Sonar();
  const std::vector<CatalogEntry> unknown = BuildAcousticCatalog({"floor"}, sonar, {0});
  sonar.elevation_beam_width_deg = 14.0;
  const std::vector<CatalogEntry> known = BuildAcousticCatalog({"floor"}, sonar, {0});
  EXPECT_EQ(Find(known, "beam.elevation_width_deg").lower, 7.0);
  EXPECT_EQ(Find(known, "beam.elevation_width_deg").upper, 28.0);
  for (const char* name : {"beam.azimuth_width_deg", "pulse.length_m"}) {  // not stated
    EXPECT_EQ(Find(known, name).lower, Find(unknown, name).lower) << name;
    EXPECT_EQ(Find(known, name).upper, Find(unknown, name).upper) << name;
  }
}

// A prior of "none" is one that does not pull.
TEST(ParameterCatalog, AStepHasTheScaleOfThePriorIfItPulls) {
  CatalogEntry entry;
  entry.typical_step = 2.0;
  EXPECT_EQ(entry.StepSigma(), 2.0);
  entry.prior = Prior{.coordinate = 0.0, .sigma = 0.5};
  EXPECT_EQ(entry.StepSigma(), 0.5);
  entry.prior->sigma = std::numeric_limits<double>::infinity();
  EXPECT_EQ(entry.StepSigma(), 2.0);
}

}  // namespace
}  // namespace sonarcal::calib
