// Vertices of a named part of a scene, which a fit moves or reshapes.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/types/scene.h"

namespace sonarcal::calib {

// Indices of the vertices of a named part of the scene, otherwise of a material. Gives a material vertices of
// its own where it shares them with another. Throws DataError if there is neither.
std::vector<std::size_t> VerticesOfObject(Scene& scene, const std::string& name);

// The triangles of these vertices as a scene of its own.
Scene MeshOfVertices(const Scene& scene, const std::vector<std::size_t>& vertices);

double SurfaceAreaM2(const Scene& mesh);

// Divides the triangles of such a part in the middle of their edges until no edge is longer than
// `max_edge_m`. The surface stays the same. Named parts of the part lose their names if it was divided.
void DivideObject(Scene& scene, const std::string& name, double max_edge_m);

}  // namespace sonarcal::calib
