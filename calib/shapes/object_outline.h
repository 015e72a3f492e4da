// Outline of a part of a scene that is known only roughly: few numbers, in metres, that change its shape. A
// fit finds them with poses and curves (`sonarcal fit --free outline:NODE`).
//
// - Body of revolution (mesh_symmetry.h): changes of its radius at stations that are evenly spaced along its
//   axis, from its lower to its upper end. A cubic curve through them (Catmull-Rom) gives the change between
//   them. A radius stays positive, and the length stays the same.
// - Any other shape, also a sphere or a disc: bumps, which are displacements along the normal about points
//   that are spread evenly over the surface. The weights of all bumps at a vertex sum to 1. So equal values
//   displace the whole surface equally.
//
// Stations and points are as far apart as four resolution cells of the sonar in the middle of its window, and
// there are between kMinOutlineValues and kMaxOutlineValues of them.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "core/types/image.h"
#include "core/types/pose.h"
#include "core/types/scene.h"

namespace sonarcal::calib {

inline constexpr int kMinOutlineValues = 8;
inline constexpr int kMaxOutlineValues = 32;

// The form of the numbers.
struct OutlineForm {
  std::string name;         // of the part
  bool revolution = false;  // changes of radii, otherwise bumps
  int count = 0;
  double spacing_m = 0.0;
  Pose mesh_from_body = {};  // +x is the axis of revolution
  double start_m = 0.0;      // lower end along it
  // Half the smallest side of the part; of a body of revolution its largest radius, at most.
  double half_size_m = 0.0;

  // Name of a number, such as "radius_07_m".
  std::string NameOf(int index) const;
  // Standard error with which the outline is known beforehand: a tenth of the half size.
  double sigma_m() const { return 0.1 * half_size_m; }
  // Largest change to either side.
  double limit_m() const { return 0.5 * half_size_m; }
};

// Returns the forms of these parts. Throws DataError for a name that is neither a part nor a material.
std::vector<OutlineForm> OutlineForms(const Scene& scene, const PolarAxes& axes,
                                      const std::vector<std::string>& names);

// Divides the part, so that its vertices can follow the outline.
void DivideForOutline(const OutlineForm& form, Scene& scene);

class ObjectOutline {
 public:
  // `scene` was divided for the outline.
  ObjectOutline(Scene& scene, const OutlineForm& form);

  // Moves the vertices of `scene`, which holds the part as declared, to the outline with these values.
  void Reshape(const std::vector<double>& values_m, Scene& scene) const;

 private:
  struct Vertex {
    std::size_t index = 0;
    Eigen::Vector3d along = Eigen::Vector3d::Zero();  // move per metre of change
    double most_inward_m = 0.0;                       // limit of the change
    std::vector<std::pair<int, double>> weights = {};
  };

  void AddRadii(const OutlineForm& form, const Scene& mesh, const std::vector<std::size_t>& vertices);
  void AddBumps(const OutlineForm& form, const Scene& mesh, const std::vector<std::size_t>& vertices);

  std::vector<Vertex> vertices_;
};

}  // namespace sonarcal::calib
