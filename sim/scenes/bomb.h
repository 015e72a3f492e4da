// The 100-lb bomb of the ARIS 3000 recordings (DFKI UXO data set 2024), with the outline that its image
// shows.
//
// Published: the length, the greatest diameter, and that the nose is an ogive. The radii between were fitted
// to ONE recorded frame, together with the pose, as the body of revolution of the published size that
// explains that frame best. They are what a sonar saw from one side, with pose, point spread function and
// backscatter curve free to trade against them: no measurement of the object, whose fins or lugs would show
// here as rings. MakeBody (sim/scenes/scenes.h) has the plain outline that assumes nothing but a tangent
// ogive and a taper.
//
// Object frame: origin on the axis at mid-length, +x through the nose.
#pragma once

#include <string>
#include <vector>

#include "core/types/scene.h"
#include "sim/scenes/scene_primitives.h"

namespace sonarcal::sim {

// From the flat tail to the flat tip, on the axis at both ends.
std::vector<ProfilePoint> BombOutline();

Scene MakeBomb(double max_edge_m = 0.01, const std::string& material = "body");

}  // namespace sonarcal::sim
