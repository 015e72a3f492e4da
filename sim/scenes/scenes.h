// The scenes that the comparisons need, built from options: the test tank and mock-ups of Park 2024
// (Section 6), and the bomb of the ARIS 3000 recordings.
//
// World of the tank: metres, origin in a corner of its floor, x along its length, y along its width, z up
// from the floor. Where the paper is silent the choice is ours and said so.
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
  bool surface = false;            // add the water surface, which the paper's scene does not have
  double max_edge_m = kUndivided;  // longest side of the mesh's quadrilaterals
  std::string floor_material = "floor";
  std::string wall_material = "wall";
  std::string surface_material = "surface";

  // Throws DataError that names the field, its value and the limit.
  void Validate() const;
};

// 12 x 10 x 1.5 m (Table 5, the default), or the 15 x 10 x 2 m of the text.
TankOptions TankOfPaper(PaperSize size);

// Faces in contact with the water, with normals into the water.
Scene MakeTank(const TankOptions& options = {});

// Placement of an object on the floor: the middle of its footprint, and a rotation to the left about z.
struct Place {
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;
};

Eigen::Isometry3d WorldFromObject(const Place& place);

// Fig. 9 shows two mock-ups in the tank. The paper gives neither positions nor headings, so these are
// assumptions. A sonar that looks along +y sees the cross of the first, 12 degrees off face-on, and the pipes
// of the second, 15 degrees off. Both fit into either size of tank.
struct PaperTankOptions {
  TankOptions tank;
  MockupOptions mockup;
  std::array<Place, 2> places = {Place{4.8, 6.4, 12.0 * kRadPerDeg}, Place{7.2, 6.2, -75.0 * kRadPerDeg}};
};

PaperTankOptions PaperTankOfPaper(PaperSize size);

Scene MakePaperTank(const PaperTankOptions& options = {});

// Poses world_from_sonar for the paper's three data sets: 1 shows the first mock-up of PaperTankOptions, 2
// the second, 3 both. As on the paper's rig, which "can move forward, backward, left and right at a fixed
// height" and looks parallel to the floor, all look along +y from 0.75 m above the floor. The positions are
// assumptions. The middles of the targets lie 3 to 6 m away and well within +-22.5 degrees. Throws DataError
// for another number.
std::vector<Pose> PaperTankPoses(int dataset);
inline constexpr int kPaperTankPoseSets = 3;

// The 100-lb bomb of the ARIS 3000 recordings (DFKI UXO data set 2024): a body of revolution. Object frame:
// origin on the axis at mid-length, +x through the nose. Published: length, diameter and that the nose is an
// ogive. Assumed: that the ogive is tangent to the cylinder, the length of the nose (0.18 m makes our
// pictures fit the recorded ones), and the tail, a straight taper to a flat end; fins and lugs are left out.
struct BodyOptions {
  double length_m = 0.737;
  double diameter_m = 0.208;
  double nose_length_m = 0.18;    // assumed
  double tail_length_m = 0.20;    // assumed
  double tail_diameter_m = 0.09;  // diameter of the flat end; assumed
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
