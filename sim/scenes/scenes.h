// Scenes built from options: a tank, mock-ups in it, and a body of revolution with an ogive nose.
//
// World of the tank: metres, origin in a corner of its floor, x along its length, y along its width, z up
// from the floor.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/types/pose.h"
#include "core/types/scene.h"
#include "core/types/units.h"
#include "sim/scenes/mockup.h"
#include "sim/scenes/scene_primitives.h"

namespace sonarcal::sim {

struct TankOptions {
  double length_m = 12.0;          // along x
  double width_m = 10.0;           // along y
  double depth_m = 1.5;            // of the water, along z
  bool surface = false;            // add the water surface
  double max_edge_m = kUndivided;  // longest side of the mesh's quadrilaterals
  std::string floor_material = "floor";
  std::string wall_material = "wall";
  std::string surface_material = "surface";

  // Throws DataError that names the field, its value and the limit.
  void Validate() const;
};

// Standard 12 x 10 x 1.5 m (the default), alternative 15 x 10 x 2 m.
TankOptions TankOfSize(SizeVariant size);

// Faces in contact with the water, with normals into the water.
Scene MakeTank(const TankOptions& options = {});

// Placement of an object on the floor: the middle of its footprint, and a rotation to the left about z.
struct Place {
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;
};

Eigen::Isometry3d WorldFromObject(const Place& place);

// A tank with two mock-ups. At the default places a sonar that looks along +y sees the cross of the first, 12
// degrees off face-on, and the pipes of the second, 15 degrees off. Both fit into either size of tank.
struct MockupTankOptions {
  TankOptions tank;
  MockupOptions mockup;
  std::array<Place, 2> places = {Place{4.8, 6.4, 12.0 * kRadPerDeg}, Place{7.2, 6.2, -75.0 * kRadPerDeg}};
};

MockupTankOptions MockupTankOfSize(SizeVariant size);

Scene MakeMockupTank(const MockupTankOptions& options = {});

// Poses world_from_sonar for recordings of the tank, in three sets: 1 shows the first mock-up of
// MockupTankOptions, 2 the second, 3 both. All look along +y, parallel to the floor and 0.75 m above it. The
// middles of the targets lie 3 to 6 m away and well within +-22.5 degrees. Throws DataError for another
// number.
std::vector<Pose> MockupTankPoses(int set);
inline constexpr int kMockupTankPoseSets = 3;

// A body of revolution: a nose that is a tangent ogive, a cylinder, and a tail that tapers straight to a flat
// end. Object frame: origin on the axis at mid-length, +x through the nose.
struct BodyOptions {
  double length_m = 0.737;
  double diameter_m = 0.208;
  double nose_length_m = 0.18;
  double tail_length_m = 0.20;
  double tail_diameter_m = 0.09;  // diameter of the flat end
  double max_edge_m = 0.02;       // longest side of the mesh's quadrilaterals
  std::string material = "body";

  // Throws DataError that names the field, its value and the limit.
  void Validate() const;
};

// Distance of the body's surface from its axis, `from_tip_m` behind the tip of the nose (0..length_m),
// without the flat end.
double BodyRadiusM(const BodyOptions& options, double from_tip_m);

Scene MakeBody(const BodyOptions& options = {});

}  // namespace sonarcal::sim
