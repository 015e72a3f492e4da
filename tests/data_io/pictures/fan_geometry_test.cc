#include "data_io/pictures/fan_geometry.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include "core/types/error.h"
#include "core/types/units.h"
#include "data_io/pictures/picture_frames.h"
#include "data_io/pictures/picture_geometry.h"
#include "tests/support/recordings.h"

namespace sonarcal::data_io {
namespace {

struct Drawn {
  FanGeometry fan;
  int rows = 0;
  int cols = 0;
};

// Each pixel by itself, from its centre; a share of them dark.
Mask Draw(const Drawn& drawn, double dark, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform;
  Mask lit(drawn.rows, drawn.cols);
  for (int row = 0; row < drawn.rows; ++row) {
    for (int col = 0; col < drawn.cols; ++col) {
      const double right = (col - drawn.fan.apex_x_px) / drawn.fan.x_scale;
      const double ahead = drawn.fan.apex_y_px - row;
      const double radius = std::hypot(right, ahead);
      const bool inside = radius >= drawn.fan.radius_min_px && radius <= drawn.fan.radius_max_px &&
                          std::abs(DegFromRad(std::atan2(right, ahead))) <= drawn.fan.half_angle_deg;
      lit(row, col) = inside && uniform(random) >= dark ? 1 : 0;
    }
  }
  return lit;
}

const Drawn kDrawn[] = {{{159.5, 600.0, 136.4, 574.4, 15.13, 1.0}, 480, 320},
                        {{159.5, 745.0, 288.0, 717.0, 15.13, 0.8}, 480, 320},
                        {{361.9, 1343.0, 309.0, 1340.0, 15.13, 1.0}, 1079, 726},
                        {{400.0, 420.0, 40.0, 400.0, 65.0, 1.0}, 440, 800},
                        {{250.3, 500.7, 10.0, 480.0, 30.0, 1.1}, 520, 520}};

// A narrow fan's apex is where two lines meet at a sharp angle: radii may shift with it, the arcs may not.
TEST(FanGeometry, IsFoundByItsEdges) {
  for (const Drawn& drawn : kDrawn) {
    const FanGeometry& fan = drawn.fan;
    for (const double dark : {0.0, 0.3, 0.7}) {
      const auto found = FindFanGeometry(Draw(drawn, dark, 1));
      ASSERT_TRUE(found) << fan.half_angle_deg << ' ' << dark;
      EXPECT_NEAR(found->apex_x_px, fan.apex_x_px, 0.5);
      EXPECT_NEAR(found->apex_y_px, fan.apex_y_px, 2.5);
      EXPECT_NEAR(found->apex_y_px - found->radius_min_px, fan.apex_y_px - fan.radius_min_px, 0.6);
      EXPECT_NEAR(found->apex_y_px - found->radius_max_px, fan.apex_y_px - fan.radius_max_px, 0.6);
      EXPECT_NEAR(found->half_angle_deg, fan.half_angle_deg, 0.15);
      EXPECT_NEAR(found->x_scale / fan.x_scale, 1.0, 0.007);
    }
  }
}

// A wedge without an echo, at one side.
TEST(FanGeometry, DarkPlacesWithinDoNotMatter) {
  const Drawn& drawn = kDrawn[2];
  Mask lit = Draw(drawn, 0.1, 1);
  for (int row = 400; row < 700; ++row) {
    for (int col = 0; col < 340; ++col) lit(row, col) = 0;
  }
  const auto found = FindFanGeometry(lit);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->apex_x_px, drawn.fan.apex_x_px, 0.5);
  EXPECT_NEAR(found->half_angle_deg, drawn.fan.half_angle_deg, 0.15);
  EXPECT_NEAR(found->radius_min_px / found->radius_max_px, drawn.fan.radius_min_px / drawn.fan.radius_max_px,
              2e-3);
}

// The first two share size and outer edges, but not the window: as a viewer draws two ranges of one sonar.
TEST(FanGeometry, AnotherWindowShowsItself) {
  const Drawn& a = kDrawn[0];
  const Drawn& b = kDrawn[1];
  for (const double dark : {0.0, 0.3, 0.7}) {
    EXPECT_FALSE(ShowsAnotherFan(Draw(a, dark, 1), a.fan)) << dark;
    EXPECT_FALSE(ShowsAnotherFan(Draw(b, dark, 1), b.fan)) << dark;
    EXPECT_TRUE(ShowsAnotherFan(Draw(a, dark, 1), b.fan)) << dark;
    EXPECT_TRUE(ShowsAnotherFan(Draw(b, dark, 1), a.fan)) << dark;
  }
  Drawn shorter = a;
  shorter.fan.radius_max_px -= 60.0;
  EXPECT_TRUE(ShowsAnotherFan(Draw(shorter, 0.3, 1), a.fan));
}

TEST(FanGeometry, DarkPlacesAreNoOtherFan) {
  const Drawn& drawn = kDrawn[2];
  const auto darkened = [&](auto is_dark) {
    Mask lit = Draw(drawn, 0.3, 1);
    for (int row = 0; row < lit.rows(); ++row) {
      for (int col = 0; col < lit.cols(); ++col) {
        if (is_dark(row, col)) lit(row, col) = 0;
      }
    }
    return lit;
  };
  EXPECT_FALSE(ShowsAnotherFan(darkened([](int, int col) { return col < 340; }), drawn.fan));
  EXPECT_FALSE(ShowsAnotherFan(darkened([](int row, int) { return row > 700; }), drawn.fan));
  EXPECT_FALSE(ShowsAnotherFan(darkened([](int row, int) { return row < 200; }), drawn.fan));
  EXPECT_FALSE(ShowsAnotherFan(darkened([](int row, int col) { return row + col < 600; }), drawn.fan));
  EXPECT_FALSE(ShowsAnotherFan(Mask(drawn.rows, drawn.cols), drawn.fan));
}

TEST(FanGeometry, MasksThatAreNoFanHaveNoGeometry) {
  EXPECT_FALSE(FindFanGeometry(Mask(100, 100)));
  EXPECT_FALSE(FindFanGeometry(Mask(100, 100, 1)));  // a square has upright sides
  Mask few(100, 100);
  few(3, 4) = few(50, 60) = 1;
  EXPECT_FALSE(FindFanGeometry(few));
  EXPECT_FALSE(FindFanGeometry(Mask(1, 4000, 1)));
  EXPECT_FALSE(FindFanGeometry(Mask(4000, 1, 1)));
  Mask triangle(60, 60);  // on its base: its left side is inclined as the right side of a fan
  for (int row = 0; row < 60; ++row) {
    for (int col = 30 - row / 2; col < 30 + row / 2; ++col) triangle(row, col) = 1;
  }
  EXPECT_FALSE(FindFanGeometry(triangle));
  // Noise all over: whatever is found is at least valid.
  std::mt19937 random(3);
  for (int draw = 0; draw < 200; ++draw) {
    Mask noise(2 + static_cast<int>(random() % 60), 2 + static_cast<int>(random() % 60));
    for (std::uint8_t& pixel : noise.values()) pixel = random() % 3 == 0 ? 1 : 0;
    if (const auto found = FindFanGeometry(noise)) {
      EXPECT_NO_THROW(found->Validate("noise"));
    }
  }
}

// Quadrilaterals: the fit of an arc to a straight edge may give any radius. Whatever is found is valid.
TEST(FanGeometry, StraightEdgesGiveAValidGeometryOrNone) {
  constexpr int kSide = 300;
  std::mt19937 random(4);
  std::uniform_real_distribution<double> uniform;
  int fans = 0;
  for (int draw = 0; draw < 100; ++draw) {
    const double bottom = kSide * uniform(random);  // the sides meet here
    const double left = uniform(random);            // columns a row
    const double right = uniform(random);
    const double top = kSide * uniform(random);
    const double slope = 2.0 * uniform(random) - 1.0;
    Mask lit(kSide, kSide);
    for (int row = 0; row < kSide; ++row) {
      for (int col = 0; col < kSide; ++col) {
        const double ahead = kSide - row;
        const double aside = col - bottom;
        if (aside > -left * ahead && aside < right * ahead && ahead < top + slope * aside) lit(row, col) = 1;
      }
    }
    if (const auto found = FindFanGeometry(lit)) {
      EXPECT_NO_THROW(found->Validate("quadrilateral")) << draw;
      ++fans;
    }
  }
  EXPECT_GT(fans, 0);
}

PolarAxes TwoBeams() {
  PolarAxes axes;
  axes.range_min_m = 1.0;
  axes.range_max_m = 3.0;
  axes.range_bins = 4;
  axes.beam_azimuth_rad = {RadFromDeg(-10.0), RadFromDeg(20.0)};
  return axes;
}

// Each pixel tells its own place, so that the samples show which pixel was taken.
TEST(SampleFan, TakesThePixelNearestToTheCentreOfBeamAndBin) {
  const FanGeometry fan{.apex_x_px = 50.0,
                        .apex_y_px = 120.0,
                        .radius_min_px = 20.0,
                        .radius_max_px = 100.0,
                        .half_angle_deg = 25.0,
                        .x_scale = 1.1};
  Grid<float> picture(110, 101);
  for (int row = 0; row < picture.rows(); ++row) {
    for (int col = 0; col < picture.cols(); ++col) picture(row, col) = static_cast<float>(1000 * row + col);
  }
  const Grid<float> polar = SampleFan(picture, fan, TwoBeams(), "fan.png");
  ASSERT_EQ(polar.rows(), 4);
  ASSERT_EQ(polar.cols(), 2);
  // Bin 2 is centred at 2.25 m: 20 + 1.25 * 40 = 70 pixels from the apex.
  EXPECT_EQ(polar(2, 0), 1000.0F * 51 + 37);
  EXPECT_EQ(polar(2, 1), 1000.0F * 54 + 76);
}

TEST(SampleFan, RefusesAPictureThatDoesNotHoldTheFan) {
  const FanGeometry fan{.apex_x_px = 361.9,
                        .apex_y_px = 1343.0,
                        .radius_min_px = 309.0,
                        .radius_max_px = 1340.0,
                        .half_angle_deg = 25.0};
  try {
    SampleFan(Grid<float>(500, 300), fan, TwoBeams(), "fan.png");
    FAIL() << "the fan is larger";
  } catch (const DataError& error) {
    EXPECT_TRUE(std::string(error.what())
                    .starts_with("fan.png: 500 x 300 pixels, which do not hold the whole fan {\"apex_px\""))
        << error.what();
  }
}

// Published pictures whose geometry was found by another program (recordings/README.md): window ratio and
// where the arcs cross the middle, to the 2 pixels to which it is known (of the first picture the far arc is
// said to cross in row 3; the first lit pixel is in row 1). x_scale is said there as rows a column.
TEST(FanGeometryOfRecordings, GeometryOfRealPicturesEqualsTheKnownOne) {
  struct Known {
    const char* file;
    double apex_y_px;
    double radius_min_px;
    double radius_max_px;
    double x_scale;
  };
  for (const Known& known :
       {Known{"aris3000_uxo/other_pose_fan.png", 1343.0, 309.0, 1340.0, 1.0},
        Known{"aris3000_watertank/Images/marine-debris-aris3k-300.png", 599.5, 136.4, 574.4, 1.0 / 1.008},
        Known{"aris3000_watertank/Images/marine-debris-aris3k-0.png", 745.0, 288.0, 717.0, 1.0 / 1.252}}) {
    SONARCAL_NEEDS_RECORDING(path, known.file);
    const Grid<float> grey = OpenPictures(path)->Read(0);
    Mask lit(grey.rows(), grey.cols());
    for (std::size_t i = 0; i < lit.size(); ++i) lit.values()[i] = grey.values()[i] > 0.0F ? 1 : 0;
    const auto found = FindFanGeometry(lit);
    ASSERT_TRUE(found) << known.file;
    EXPECT_NEAR(found->apex_y_px - found->radius_min_px, known.apex_y_px - known.radius_min_px, 2.5);
    EXPECT_NEAR(found->apex_y_px - found->radius_max_px, known.apex_y_px - known.radius_max_px, 2.5);
    EXPECT_NEAR(found->radius_min_px / found->radius_max_px, known.radius_min_px / known.radius_max_px, 3e-3);
    EXPECT_NEAR(found->half_angle_deg, 15.13, 0.2);
    EXPECT_NEAR(found->x_scale / known.x_scale, 1.0, 0.02);
  }
}

}  // namespace
}  // namespace sonarcal::data_io
