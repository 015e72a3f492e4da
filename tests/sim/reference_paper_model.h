// The paper's model a third time, to hold the whole program against: rays, intersections, absorption, echo,
// binning and display written anew from the equations, in double and one ray after another. Includes nothing
// of the project, casts no ray with Embree and knows no triangles: a surface is a rectangle, or the boundary
// of a convex solid (planes, round walls) with a bore cut out of it, met in closed form.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <limits>
#include <vector>

namespace sonarcal::testing::reference {

using Eigen::Vector3d;

// --- Surfaces

struct Hit {
  double range_m = std::numeric_limits<double>::infinity();
  Vector3d normal = Vector3d::Zero();  // unit; which side it points to does not matter
  int material = -1;
};

// normal . x <= offset.
struct HalfSpace {
  Vector3d normal;
  double offset;
};

// Within a radius of the line through `middle` along the unit vector `axis`; of the point, where it is zero.
struct Round {
  Vector3d middle;
  Vector3d axis;
  double radius;
};

// The points that satisfy all of them.
struct Convex {
  std::vector<HalfSpace> planes = {};
  std::vector<Round> rounds = {};
};

struct Solid {
  Convex outside;
  Convex bore = {};  // cut out of it, unless empty
  int material = 0;
  Vector3d middle = Vector3d::Zero();  // of a sphere that holds the solid, and its radius
  double reach = std::numeric_limits<double>::infinity();
};

struct Rectangle {
  Vector3d corner, side_u, side_v;
  int material;
};

struct World {
  std::vector<Rectangle> rectangles = {};
  std::vector<Solid> solids = {};

  // The nearest surface ahead, from either side.
  Hit Meet(const Vector3d& from, const Vector3d& along) const;

  void Add(Solid solid, const Eigen::Isometry3d& world_from_solid);
};

Solid Box(const Vector3d& low, const Vector3d& high, int material);
Solid Ball(const Vector3d& middle, double radius, int material);

// A cylinder from `base` to `base + axis`, or with an inner radius a tube. sides = 0: round; else the prism
// (4 | sides) inscribed in it with a corner in the direction of a coordinate axis across `axis`, which lies
// along a coordinate axis: what MakeCylinder and MakeTube make of it.
Solid Cylinder(const Vector3d& base, const Vector3d& axis, double radius, int sides, int material,
               double inner_radius = 0.0);

// --- The paper's scene (sim/scenes/scenes.h), from its measures: 12 x 10 x 1.5 m, blocks of 1 x 1 x 1.5 m
// with reliefs of 8 cm, solids that touch sunk 5 mm into one another, cylinders of 16 sides.

enum Material { kFloor, kWall, kMockup };

void AddMockup(World& world, const Eigen::Isometry3d& world_from_mockup);
World Mockup();
World PaperTank();

// --- Sonar and image

struct Gsab {
  double a, b_deg, c, d, e, f_deg;
};

struct Sonar {
  std::vector<double> beam_deg;  // centres, left to right
  double elevation_deg;          // field of view
  double range_min_m, range_max_m;
  int bins;
  double frequency_khz;
};

struct Settings {
  double temperature_c, salinity_ppt, ph, depth_km;
  double source_level_db, db_min, db_max;
  std::vector<Gsab> materials;
  double full_scale = 255.0;
};

enum class Spread { kFrustum, kBeams };

// Ainslie & McColm 1998.
double AbsorptionDbPerM(double frequency_khz, const Settings& settings);

// One frame: where each ray goes, what it adds, and the sums.
class Frame {
 public:
  Frame(const World& world, const Sonar& sonar, const Settings& settings, Spread spread, int cols, int rows,
        const Eigen::Isometry3d& world_from_sonar);

  int bins() const { return sonar_.bins; }
  int beams() const { return static_cast<int>(sonar_.beam_deg.size()); }
  int cols() const { return static_cast<int>(azimuth_rad_.size()); }

  // Grey level of a pixel, clamped and not rounded.
  double Grey(int bin, int beam) const;

  // For each bin of a beam: grey levels that rays may have added or may have left out if they went elsewhere
  // by `doubt_rad` in angle, or met their surface `doubt_m` nearer or farther (along its normal). 0 in a bin
  // that no such ray touches. `doubtful` counts these rays.
  std::vector<double> Doubt(int beam, double doubt_rad, double doubt_m, int* doubtful) const;

 private:
  Vector3d Direction(int row, int col, double right_rad, double up_rad) const;
  int Bin(double range_m) const;
  double Share(const Hit& hit, double cosine, int beam) const;

  const World& world_;
  Sonar sonar_;
  Settings settings_;
  Spread spread_;
  int rows_;
  Eigen::Isometry3d world_from_sonar_;
  double alpha_db_per_m_ = 0.0;
  std::vector<double> azimuth_rad_;  // of a column
  std::vector<int> beam_of_col_;
  std::vector<int> rays_of_beam_;
  std::vector<double> sum_;
};

}  // namespace sonarcal::testing::reference
