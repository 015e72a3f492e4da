// Jacket of an offshore platform, made of pipes: the third environment of Park 2024 (Section 5, Fig. 5c): 5 x
// 5 x 8.5 m. The paper gives only the size. The frame is an assumption: four legs that lean inwards between
// upright feet and heads, level pipes between them, and a cross of braces in each bay of each side.
//
// Object frame: origin in the middle of the footprint, z up. The mesh is a union of closed cylinders that
// penetrate each other, so a ray from outside always hits an outside. Nothing extends beyond the size. One
// material.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/types/scene.h"

namespace sonarcal::sim {

struct JacketOptions {
  double length_m = 5.0;  // along x, over the feet
  double width_m = 5.0;   // along y
  double height_m = 8.5;
  double top_share = 0.55;       // fraction of length and width, over the heads
  int bays = 3;                  // number of bays from the lowest level to the highest, 1..20
  double foot_diameter_m = 0.6;  // diameter of the upright pieces at the legs' ends
  double leg_diameter_m = 0.4;
  double level_diameter_m = 0.28;
  double brace_diameter_m = 0.22;
  int sectors = 24;          // min sectors of a pipe's circumference, 8..10000; rounded up to a multiple of 4
  double max_edge_m = 0.25;  // longest side of the mesh's quadrilaterals
  std::string material = "jacket";

  // Throws DataError that names the field, its value and the limit.
  void Validate() const;
};

// Pipe, defined by its axis.
struct Pipe {
  Eigen::Vector3d from_m;
  Eigen::Vector3d to_m;
  double radius_m;
};

std::vector<Pipe> JacketPipes(const JacketOptions& options = {});

// Number of plane sectors of a pipe's circumference.
int JacketSectors(const JacketOptions& options, double radius_m);

Scene MakeJacket(const JacketOptions& options = {});

}  // namespace sonarcal::sim
