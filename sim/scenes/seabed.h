// Smooth seabed with relief, like the first environment of Park 2024 (Section 5, Fig. 5a): 10 x 10 x 2 m. The
// paper gives only the size; the relief is an assumption.
//
// World: metres, origin below the middle, x along the length, y along the width, z up from the lowest point.
// The height is a sum of broad Gaussian hills and hollows and of two trains of ripples. All are drawn from
// the seed; the sum is then scaled to 0 .. height_m. It is a function of x and y only: the mesh's resolution
// does not change it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/types/scene.h"

namespace sonarcal::sim {

struct SeabedOptions {
  double length_m = 10.0;        // along x
  double width_m = 10.0;         // along y
  double height_m = 2.0;         // from the lowest to the highest point
  std::uint64_t seed = 1;        // a seed gives one seabed of this kind
  int hills = 14;                // number of hills and hollows, 1..1000
  double ripple_length_m = 1.1;  // from crest to crest
  // height of a ripple's crest over its middle, as a fraction of height_m; 0..0.2
  double ripple_share = 0.02;
  double max_edge_m = 0.05;  // longest side of the mesh's cells as seen from above
  std::string material = "seabed";

  // Throws DataError that names the field, its value and the limit.
  void Validate() const;
};

// Height of a seabed at any point. The same seed gives the same seabed on any machine.
class SeabedRelief {
 public:
  // Throws DataError as SeabedOptions::Validate does.
  explicit SeabedRelief(const SeabedOptions& options);

  // Height, 0 .. height_m. The extremes are those of a grid of 200 x 200 cells. Values beyond them between
  // the grid points (by less than a thousandth of the height) are clamped.
  double HeightM(double x_m, double y_m) const;

 private:
  struct Hill {
    double x_m;
    double y_m;
    double width_m;  // standard deviation
    double height;   // -1 .. 1; negative for a hollow
  };
  struct Ripple {
    double x_rad_per_m;
    double y_rad_per_m;
    double phase_rad;
    double height;
  };

  double Raw(double x_m, double y_m) const;

  std::vector<Hill> hills_;
  std::vector<Ripple> ripples_;
  double height_m_;
  double lowest_ = 0.0;  // min of Raw
  double scale_m_ = 1.0;
};

// Open surface with normals up.
Scene MakeSeabed(const SeabedOptions& options = {});

}  // namespace sonarcal::sim
