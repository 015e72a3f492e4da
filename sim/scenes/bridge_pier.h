// Bridge pier as a simple polyhedron, the second environment of Park 2024 (Section 5, Fig. 5b): 4 x 4 x 9.5
// m. The paper gives only the size. The shape is an assumption: a footing, a tapering shaft, and a head that
// widens to carry the deck.
//
// Object frame: origin in the middle of the footprint, x along the length, y along the width, z up. One
// closed mesh of plane faces.
#pragma once

#include <string>
#include <vector>

#include "core/types/scene.h"
#include "sim/scenes/scene_primitives.h"

namespace sonarcal::sim {

struct BridgePierOptions {
  double length_m = 4.0;  // along x, of footing and head
  double width_m = 4.0;   // along y
  double height_m = 9.5;
  double footing_height_m = 1.5;
  double flare_height_m = 1.3;  // height over which the shaft widens to the head
  double head_height_m = 1.2;
  double shaft_foot_share = 0.6;  // fraction of length and width at the shaft's foot
  double shaft_top_share = 0.5;   // fraction where the flare begins
  double max_edge_m = 0.25;       // longest side of the mesh's quadrilaterals
  std::string material = "pier";

  // Throws DataError that names the field, its value and the limit.
  void Validate() const;
};

// Profile of the pier: half of its width as a fraction of half its full width, at heights from the middle of
// the underside to the middle of the top. Linear between the points.
std::vector<ProfilePoint> BridgePierProfile(const BridgePierOptions& options = {});

Scene MakeBridgePier(const BridgePierOptions& options = {});

}  // namespace sonarcal::sim
