#include "sim/scenes/scene_primitives.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "core/types/error.h"
#include "core/types/units.h"

namespace sonarcal::sim {
namespace {

using Eigen::Vector3d;

constexpr int kMinCylinderSectors = 16;
constexpr int kMinTurnedSectors = 24;

void RequirePositive(double value_m, const char* what) {
  if (!(value_m > 0.0 && std::isfinite(value_m))) {
    throw DataError("{} of {} m, expected a positive length", what, value_m);
  }
}

// Number of pieces of a length, each at most max_edge_m.
int Divisions(double length_m, double max_edge_m) {
  if (!(max_edge_m > 0.0)) throw DataError("a longest edge of {} m, expected a positive length", max_edge_m);
  const double pieces = std::ceil(length_m / max_edge_m * (1.0 - 1e-12));  // tolerates a rounded quotient
  if (!(pieces <= static_cast<double>(kMaxPrimitiveTriangles))) {
    throw DataError("a length of {} m in edges of {} m would make more than {} triangles", length_m,
                    max_edge_m, kMaxPrimitiveTriangles);
  }
  return std::max(1, static_cast<int>(pieces));
}

void RequireTriangles(double count) {
  if (count > static_cast<double>(kMaxPrimitiveTriangles)) {
    throw DataError("a shape of {:.0f} triangles, expected at most {}: allow longer edges", count,
                    kMaxPrimitiveTriangles);
  }
}

Scene OfMaterial(const std::string& material) {
  Scene scene;
  scene.MaterialIndex(material);
  return scene;
}

void AddTriangle(Scene* scene, int a, int b, int c) {
  scene->triangles.emplace_back(a, b, c);
  scene->triangle_material.push_back(0);
}

// Adds a quadrilateral a-b-c-d, counter-clockwise. Its corners may coincide in pairs at a pole.
void AddQuad(Scene* scene, int a, int b, int c, int d) {
  if (a != b) AddTriangle(scene, a, b, c);
  if (c != d) AddTriangle(scene, a, c, d);
}

// Transform that rotates +X to a direction and moves the origin.
Eigen::Isometry3d Along(const Vector3d& axis_m, const Vector3d& origin_m) {
  Eigen::Isometry3d transform = Eigen::Isometry3d::Identity();
  transform.rotate(Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitX(), axis_m));
  transform.pretranslate(origin_m);
  return transform;
}

}  // namespace

Scene MakePatch(const Vector3d& corner_m, const Vector3d& side_u_m, const Vector3d& side_v_m,
                double max_edge_m, const std::string& material) {
  if (!(side_u_m.cross(side_v_m).norm() > 0.0)) {
    throw DataError("a patch between parallel sides, expected sides that span an area");
  }
  const int count_u = Divisions(side_u_m.norm(), max_edge_m);
  const int count_v = Divisions(side_v_m.norm(), max_edge_m);
  RequireTriangles(2.0 * count_u * count_v);

  Scene scene = OfMaterial(material);
  for (int v = 0; v <= count_v; ++v) {
    for (int u = 0; u <= count_u; ++u) {
      const Vector3d point_m = corner_m + side_u_m * (double(u) / count_u) + side_v_m * (double(v) / count_v);
      scene.vertices_m.emplace_back(point_m.cast<float>());
    }
  }
  const int row = count_u + 1;
  for (int v = 0; v < count_v; ++v) {
    for (int u = 0; u < count_u; ++u) {
      const int at = v * row + u;
      AddQuad(&scene, at, at + 1, at + row + 1, at + row);
    }
  }
  return scene;
}

Scene MakeBox(const Vector3d& min_m, const Vector3d& max_m, double max_edge_m, const std::string& material) {
  const Vector3d size_m = max_m - min_m;
  std::array<int, 3> count;
  for (int axis = 0; axis < 3; ++axis) {
    RequirePositive(size_m[axis], "a box with a side");
    count[axis] = Divisions(size_m[axis], max_edge_m);
  }
  RequireTriangles(4.0 *
                   (double(count[0]) * count[1] + double(count[1]) * count[2] + double(count[2]) * count[0]));

  // Faces share vertices because a vertex is identified by its position in the lattice.
  Scene scene = OfMaterial(material);
  std::map<std::array<int, 3>, int> vertex_at;
  const auto vertex = [&](const std::array<int, 3>& place) {
    const auto [found, added] = vertex_at.try_emplace(place, static_cast<int>(scene.vertices_m.size()));
    if (added) {
      Vector3d point_m;
      for (int axis = 0; axis < 3; ++axis) {
        // Uses the far corner itself, free of rounding.
        point_m[axis] = place[axis] == count[axis]
                            ? max_m[axis]
                            : min_m[axis] + size_m[axis] * (double(place[axis]) / count[axis]);
      }
      scene.vertices_m.emplace_back(point_m.cast<float>());
    }
    return found->second;
  };

  for (int normal = 0; normal < 3; ++normal) {
    const int u_axis = (normal + 1) % 3;
    const int v_axis = (normal + 2) % 3;
    for (int u = 0; u < count[u_axis]; ++u) {
      for (int v = 0; v < count[v_axis]; ++v) {
        const auto corner = [&](int side, int du, int dv) {
          std::array<int, 3> place;
          place[normal] = side;
          place[u_axis] = u + du;
          place[v_axis] = v + dv;
          return vertex(place);
        };
        const int far = count[normal];
        AddQuad(&scene, corner(far, 0, 0), corner(far, 1, 0), corner(far, 1, 1), corner(far, 0, 1));
        AddQuad(&scene, corner(0, 0, 0), corner(0, 0, 1), corner(0, 1, 1), corner(0, 1, 0));
      }
    }
  }
  return scene;
}

std::vector<ProfilePoint> RefineProfile(const std::vector<ProfilePoint>& profile, double max_edge_m) {
  std::vector<ProfilePoint> refined;
  for (std::size_t i = 0; i + 1 < profile.size(); ++i) {
    const ProfilePoint& from = profile[i];
    const ProfilePoint& to = profile[i + 1];
    const int pieces =
        Divisions(std::hypot(to.axial_m - from.axial_m, to.radius_m - from.radius_m), max_edge_m);
    RequireTriangles(static_cast<double>(refined.size()) + pieces);
    for (int piece = 0; piece < pieces; ++piece) {
      const double part = double(piece) / pieces;
      refined.push_back({from.axial_m + part * (to.axial_m - from.axial_m),
                         from.radius_m + part * (to.radius_m - from.radius_m)});
    }
  }
  if (!profile.empty()) refined.push_back(profile.back());
  return refined;
}

int SectorsFor(double radius_m, double max_edge_m, int at_least) {
  RequirePositive(radius_m, "a circle with a radius");
  return std::max(at_least, Divisions(2.0 * kPi * radius_m, max_edge_m));
}

Scene MakeRevolution(const std::vector<ProfilePoint>& profile, int sectors, bool ring,
                     const std::string& material) {
  RequireTriangles(2.0 * sectors);
  std::vector<Eigen::Vector2d> circle;
  for (int sector = 0; sector < sectors; ++sector) {
    const double angle_rad = 2.0 * kPi * sector / sectors;
    circle.emplace_back(std::cos(angle_rad), std::sin(angle_rad));
  }
  return MakeLoft(profile, circle, ring, material);
}

Scene MakeTurnedSolid(const std::vector<ProfilePoint>& outline, double max_edge_m,
                      const std::string& material) {
  if (outline.size() < 2) throw DataError("an outline of {} points, expected at least two", outline.size());
  double largest_m = 0.0;
  for (const ProfilePoint& point : outline) {
    RequirePositive(point.radius_m, "an outline with a radius");
    largest_m = std::max(largest_m, point.radius_m);
  }
  std::vector<ProfilePoint> profile = {{outline.front().axial_m, 0.0}};
  profile.insert(profile.end(), outline.begin(), outline.end());
  profile.push_back({outline.back().axial_m, 0.0});
  return MakeRevolution(RefineProfile(profile, max_edge_m),
                        SectorsFor(largest_m, max_edge_m, kMinTurnedSectors), false, material);
}

Scene MakeLoft(const std::vector<ProfilePoint>& profile, const std::vector<Eigen::Vector2d>& section,
               bool ring, const std::string& material) {
  const int sectors = static_cast<int>(section.size());
  SONARCAL_CHECK(profile.size() >= 3 && sectors >= 3, "{} profile points, {} sectors", profile.size(),
                 sectors);
  RequireTriangles(2.0 * static_cast<double>(profile.size()) * sectors);
  const std::size_t last = profile.size() - 1;
  for (std::size_t i = 0; i <= last; ++i) {
    const bool pole = !ring && (i == 0 || i == last);
    const double radius_m = profile[i].radius_m;
    if (pole ? radius_m != 0.0 : !(radius_m > 0.0)) {
      throw DataError("point {} of {} of a profile lies {} m from its axis, expected {}", i, profile.size(),
                      radius_m, pole ? "0 at an end" : "a positive distance");
    }
  }

  Scene scene = OfMaterial(material);
  std::vector<int> first_vertex;  // circle of each profile point; a pole has one vertex only
  for (const ProfilePoint& point : profile) {
    first_vertex.push_back(static_cast<int>(scene.vertices_m.size()));
    const int count = point.radius_m == 0.0 ? 1 : sectors;
    for (int sector = 0; sector < count; ++sector) {
      const Eigen::Vector2d across_m = point.radius_m * section[sector];
      scene.vertices_m.emplace_back(Vector3d(point.axial_m, across_m.x(), across_m.y()).cast<float>());
    }
  }
  const auto vertex = [&](std::size_t point, int sector) {
    return first_vertex[point] + (profile[point].radius_m == 0.0 ? 0 : sector % sectors);
  };
  const std::size_t spans = ring ? profile.size() : last;
  for (std::size_t i = 0; i < spans; ++i) {
    const std::size_t next = (i + 1) % profile.size();
    for (int sector = 0; sector < sectors; ++sector) {
      AddQuad(&scene, vertex(i, sector), vertex(i, sector + 1), vertex(next, sector + 1),
              vertex(next, sector));
    }
  }
  return scene;
}

Scene MakeCylinder(const Vector3d& base_m, const Vector3d& axis_m, double radius_m, double max_edge_m,
                   const std::string& material) {
  const double length_m = axis_m.norm();
  RequirePositive(length_m, "a cylinder with a length");
  const int sectors = SectorsFor(radius_m, max_edge_m, kMinCylinderSectors);
  const std::vector<ProfilePoint> profile = {
      {0.0, 0.0}, {0.0, radius_m}, {length_m, radius_m}, {length_m, 0.0}};
  return Moved(MakeRevolution(RefineProfile(profile, max_edge_m), sectors, false, material),
               Along(axis_m, base_m));
}

Scene MakeTube(const Vector3d& base_m, const Vector3d& axis_m, double inner_radius_m, double outer_radius_m,
               double max_edge_m, const std::string& material) {
  const double length_m = axis_m.norm();
  RequirePositive(length_m, "a tube with a length");
  RequirePositive(inner_radius_m, "a tube with an inner radius");
  RequirePositive(outer_radius_m - inner_radius_m, "a tube with a wall");
  const int sectors = SectorsFor(outer_radius_m, max_edge_m, kMinCylinderSectors);
  const std::vector<ProfilePoint> loop = {{0.0, inner_radius_m},
                                          {0.0, outer_radius_m},
                                          {length_m, outer_radius_m},
                                          {length_m, inner_radius_m},
                                          {0.0, inner_radius_m}};
  std::vector<ProfilePoint> profile = RefineProfile(loop, max_edge_m);
  profile.pop_back();  // the ring closes itself
  return Moved(MakeRevolution(profile, sectors, true, material), Along(axis_m, base_m));
}

Scene Moved(Scene scene, const Eigen::Isometry3d& world_from_scene) {
  for (Eigen::Vector3f& vertex_m : scene.vertices_m) {
    vertex_m = (world_from_scene * vertex_m.cast<double>()).cast<float>();
  }
  return scene;
}

}  // namespace sonarcal::sim
