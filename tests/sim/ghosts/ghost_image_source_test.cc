// Ghosts against image sources: the sonar's image behind a flat mirror sees each point of an object at the
// distance and from the side that the mirrored leg has. Sums over points of the object, no ray.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/sim/ghost_world.h"

namespace sonarcal::sim {
namespace {

using namespace testing;  // NOLINT: the helpers of tests/sim

// A point of an object: where it is, which way its surface looks, how much of it there is.
struct Point {
  Eigen::Vector3d at_m;
  Eigen::Vector3d normal;
  double area_m2;
};

// What the sonar at the origin, looking along +y, gets from points by a flat mirror through `on_mirror`.
class ImageSource {
 public:
  ImageSource(const GhostAcoustics& acoustics, const Eigen::Vector3d& on_mirror,
              const Eigen::Vector3d& mirror_normal)
      : acoustics_(acoustics),
        image_m_(2.0 * on_mirror.dot(mirror_normal) * mirror_normal),
        normal_(mirror_normal),
        power_(kGhostBins, kGhostBeams) {}

  void Add(const Point& point) {
    const Leg straight = LegFrom(Eigen::Vector3d::Zero(), point, point.at_m);
    // The sonar sees the point where its image lies.
    const Eigen::Vector3d seen_at = point.at_m - 2.0 * (point.at_m - 0.5 * image_m_).dot(normal_) * normal_;
    const Leg mirrored = LegFrom(image_m_, point, seen_at);
    if (!(mirrored.cosine > 0.0)) return;
    const double reflected = std::pow(10.0, -kLossDb / 10.0);
    Arrive(point.area_m2 * mirrored.power * mirrored.power * reflected * reflected *
               SlowSigma(Curve(), mirrored.cosine, mirrored.cosine, std::acos(mirrored.cosine)),
           mirrored.length_m, {mirrored.azimuth_rad});
    if (!(straight.cosine > 0.0)) return;
    // Out by one leg, back by the other, and the reverse: the fields of both at a beam.
    const double tilt_rad = std::acos((straight.back + mirrored.back).normalized().dot(point.normal));
    Arrive(point.area_m2 * mirrored.power * straight.power * reflected *
               SlowSigma(Curve(), mirrored.cosine, straight.cosine, tilt_rad),
           0.5 * (mirrored.length_m + straight.length_m), {mirrored.azimuth_rad, straight.azimuth_rad});
  }

  const Grid<double>& power() const { return power_; }

 private:
  struct Leg {
    double length_m;
    double cosine;
    double azimuth_rad;
    double power;  // what it leaves of a source
    Eigen::Vector3d back;
  };

  Leg LegFrom(const Eigen::Vector3d& from_m, const Point& point, const Eigen::Vector3d& seen_at) const {
    const Eigen::Vector3d way = point.at_m - from_m;
    const double length_m = way.norm();
    const ParameterSet& p = acoustics_.parameters;
    const double level_db = 0.5 * (p.source_level_db + p.receiver.gain_db) - 20.0 * std::log10(length_m) -
                            kAlphaDbPerM * length_m;
    const double there_and_back =
        SlowResponse(std::asin(seen_at.z() / length_m), kGhostElevationWidthDeg * kPi / 180.0);
    return {length_m, -way.dot(point.normal) / length_m, std::atan2(seen_at.x(), seen_at.y()),
            std::pow(10.0, level_db / 10.0) * std::sqrt(there_and_back), -way / length_m};
  }

  void Arrive(double power, double range_m, const std::vector<double>& azimuths_rad) {
    for (int beam = 0; beam < kGhostBeams; ++beam) {
      double field = 0.0;
      for (const double azimuth_rad : azimuths_rad) {
        field += std::sqrt(SlowResponse(azimuth_rad - acoustics_.sonar.axes.beam_azimuth_rad[beam],
                                        kGhostAzimuthWidthDeg * kPi / 180.0));
      }
      const double heard = power * field * field;
      if (heard == 0.0) continue;
      for (int bin = 0; bin < kGhostBins; ++bin) {
        power_(bin, beam) += heard * SlowResponse(range_m - (2.5 + (bin + 0.5) * 0.05), kPulseM);
      }
    }
  }

  const GsabParameters<double>& Curve() const { return acoustics_.parameters.materials.at("default").gsab; }

  const GhostAcoustics& acoustics_;
  Eigen::Vector3d image_m_;
  Eigen::Vector3d normal_;
  Grid<double> power_;
};

// Points of a plate from `corner` along u and v, n by n.
std::vector<Point> PlatePoints(const Eigen::Vector3d& corner, const Eigen::Vector3d& u,
                               const Eigen::Vector3d& v, int n) {
  std::vector<Point> points;
  const Eigen::Vector3d across = u.cross(v);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      points.push_back(
          {corner + (i + 0.5) / n * u + (j + 0.5) / n * v, across.normalized(), across.norm() / n / n});
    }
  }
  return points;
}

// Pixels within `tolerance` of the image source's, of its peak; and their sum within a tenth of that.
void ExpectLike(const Grid<float>& power, const Grid<double>& expected, double tolerance) {
  const double peak = *std::max_element(expected.values().begin(), expected.values().end());
  ASSERT_GT(peak, 0.0);
  double sum = 0.0;
  double expected_sum = 0.0;
  for (int bin = 0; bin < kGhostBins; ++bin) {
    for (int beam = 0; beam < kGhostBeams; ++beam) {
      ASSERT_NEAR(power(bin, beam), expected(bin, beam), tolerance * peak)
          << "bin " << bin << ", beam " << beam;
      sum += power(bin, beam);
      expected_sum += expected(bin, beam);
    }
  }
  EXPECT_NEAR(sum / expected_sum, 1.0, 0.25 * tolerance);
}

// A wall at the right, along the way the sonar looks; a plate beside it that faces the sonar. Straight and in
// the mirror the plate stands some 13 degrees apart: three arrivals. A pulse of two bins is sampled eight
// times, so that sharing moves a pixel by 8 ln 2 / 8 / 64 = 1.1 % of its peak at most, columns of a fifth of
// a beam 0.4 %; the plate's edges are sharp to a ray, 0.04 x 0.05 degrees of its 4 x 6.
TEST(Ghosts, PlateBeforeAWallByImageSource) {
  const GhostAcoustics acoustics;
  Scene scene;
  AddQuad(scene, {0.5, 0.5, -3}, {0, 6, 0}, {0, 0, 6}, "mirror");
  AddQuad(scene, {-0.1, 3.5, -0.15}, {0.25, 0, 0}, {0, 0, 0.4}, "plate");
  ImageSource image(acoustics, {0.5, 0, 0}, {-1, 0, 0});
  for (const Point& point : PlatePoints({-0.1, 3.5, -0.15}, {0.25, 0, 0}, {0, 0, 0.4}, 60)) image.Add(point);
  const GhostList ghosts = acoustics.Trace(scene, Pose{}, acoustics.Fan(18 * kGhostBeams, 1200));
  ExpectLike(acoustics.Power(ghosts), image.power(), 0.03);
}

// Of a floor the two ways of a pair come back from one direction: fields add.
TEST(Ghosts, SphereAboveAFloorByImageSource) {
  const GhostAcoustics acoustics;
  constexpr double kRadiusM = 0.3;
  const Eigen::Vector3d centre(0.1, 3.6, -0.05);
  Scene scene;
  AddQuad(scene, {-6, -2, -0.6}, {12, 0, 0}, {0, 12, 0}, "mirror");
  AddSphere(scene, centre, kRadiusM, 160, "sphere");
  ImageSource image(acoustics, {0, 0, -0.6}, {0, 0, 1});
  constexpr int kRings = 200;
  for (int ring = 0; ring < kRings; ++ring) {
    for (int sector = 0; sector < 2 * kRings; ++sector) {
      const double polar = kPi * (ring + 0.5) / kRings;
      const double around = kPi * (sector + 0.5) / kRings;
      const Eigen::Vector3d normal(std::sin(polar) * std::cos(around), std::sin(polar) * std::sin(around),
                                   std::cos(polar));
      image.Add({centre + kRadiusM * normal, normal,
                 kRadiusM * kRadiusM * std::sin(polar) * (kPi / kRings) * (kPi / kRings)});
    }
  }
  const GhostList ghosts = acoustics.Trace(scene, Pose{}, acoustics.Fan(6 * kGhostBeams, 2000));
  ExpectLike(acoustics.Power(ghosts), image.power(), 0.03);
}

}  // namespace
}  // namespace sonarcal::sim
