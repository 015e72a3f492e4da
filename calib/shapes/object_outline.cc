#include "calib/shapes/object_outline.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "calib/shapes/mesh_symmetry.h"
#include "calib/shapes/object_vertices.h"

namespace sonarcal::calib {
namespace {

// Resolution cells between two stations. Speckle leaves one cell unknown by its own power, so a station needs
// several.
constexpr double kCellsApart = 4.0;
// Share of a radius that stays at least.
constexpr double kLeastRadius = 0.02;
// Half the smallest side of a part counts as at least this share of half its largest: a plate can be bent.
constexpr double kThinnest = 0.1;

double ResolutionCell(const PolarAxes& axes) {
  const double middle_m = 0.5 * (axes.range_min_m + axes.range_max_m);
  return std::max(axes.range_bin_m(), middle_m * axes.beam_spacing_rad());
}

OutlineForm FormOf(Scene scene, const PolarAxes& axes, const std::string& name) {
  const Scene mesh = MeshOfVertices(scene, VerticesOfObject(scene, name));
  const MeshSymmetry symmetry = FindSymmetry(mesh);
  OutlineForm form{.name = name, .mesh_from_body = symmetry.mesh_from_body};
  const Pose body_from_mesh = form.mesh_from_body.Inverse();
  Eigen::AlignedBox3d box;
  double radius_m = 0.0;
  for (const Eigen::Vector3f& vertex : mesh.vertices_m) {
    const Eigen::Vector3d point = body_from_mesh * Eigen::Vector3d(vertex.cast<double>());
    box.extend(point);
    radius_m = std::max(radius_m, std::hypot(point.y(), point.z()));
  }
  const double length_m = box.sizes().x();
  // A disc has hardly any length along its axis.
  form.revolution = symmetry.revolution == Revolution::kAxis && length_m > 2.0 * kThinnest * radius_m;
  const double wanted_m = kCellsApart * ResolutionCell(axes);
  const auto count = [](double value) {
    return static_cast<int>(std::lround(std::clamp<double>(value, kMinOutlineValues, kMaxOutlineValues)));
  };
  if (form.revolution) {
    form.count = count(length_m / wanted_m + 1.0);
    form.spacing_m = length_m / (form.count - 1);
    form.start_m = box.min().x();
    form.half_size_m = std::min(radius_m, 0.5 * length_m);
  } else {
    const double area_m2 = SurfaceAreaM2(mesh);
    form.count = count(area_m2 / (wanted_m * wanted_m));
    // A strip has hardly any area: its length alone limits the number of triangles.
    form.spacing_m = std::max(std::sqrt(area_m2 / form.count), box.sizes().maxCoeff() / kMaxOutlineValues);
    form.half_size_m = 0.5 * std::max(box.sizes().minCoeff(), kThinnest * box.sizes().maxCoeff());
  }
  return form;
}

// Weights of the values about a place on a row of stations, counted from the first.
std::vector<std::pair<int, double>> CurveWeights(double place, int count) {
  const int left = std::clamp(static_cast<int>(std::floor(place)), 0, count - 2);
  const double t = std::clamp(place - left, 0.0, 1.0);
  const std::array<double, 4> of = {((-0.5 * t + 1.0) * t - 0.5) * t, (1.5 * t - 2.5) * t * t + 1.0,
                                    ((-1.5 * t + 2.0) * t + 0.5) * t, (0.5 * t - 0.5) * t * t};
  std::vector<std::pair<int, double>> weights;
  for (int k = 0; k < 4; ++k) weights.emplace_back(std::clamp(left - 1 + k, 0, count - 1), of[k]);
  return weights;
}

// Largest radius of a mesh at each place along +x where it has vertices.
class OuterRadius {
 public:
  OuterRadius(const Scene& mesh, const std::vector<Eigen::Vector3d>& points, double length_m)
      : least_m_(1e-6 * length_m) {
    for (const Eigen::Vector3d& point : points) places_.push_back(point.x());
    std::ranges::sort(places_);
    const auto same = [&](double a, double b) { return b - a < least_m_; };
    places_.erase(std::unique(places_.begin(), places_.end(), same), places_.end());
    radii_.assign(places_.size(), 0.0);
    for (const Eigen::Vector3d& point : points) Widen(PlaceOf(point.x()), point);
    for (const Eigen::Vector3i& t : mesh.triangles) {
      for (int i = 0; i < 3; ++i) AddEdge(points[t(i)], points[t((i + 1) % 3)]);
    }
  }

  double At(double x) const { return radii_[PlaceOf(x)]; }

 private:
  std::size_t PlaceOf(double x) const {
    const auto after = std::upper_bound(places_.begin(), places_.end(), x);
    return after == places_.begin() ? 0 : static_cast<std::size_t>(after - places_.begin()) - 1;
  }

  void Widen(std::size_t place, const Eigen::Vector3d& point) {
    radii_[place] = std::max(radii_[place], std::hypot(point.y(), point.z()));
  }

  void AddEdge(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
    const Eigen::Vector3d& a = from.x() < to.x() ? from : to;
    const Eigen::Vector3d& b = from.x() < to.x() ? to : from;
    for (std::size_t place = PlaceOf(a.x()) + 1; place < places_.size() && places_[place] < b.x(); ++place) {
      const double share = (places_[place] - a.x()) / (b.x() - a.x());
      Widen(place, a + share * (b - a));
    }
  }

  double least_m_;
  std::vector<double> places_;
  std::vector<double> radii_;
};

// A point of a surface with its normal.
struct SurfacePoint {
  Eigen::Vector3d place;
  Eigen::Vector3d normal;

  // Square of the distance. Two sides of a thin plate are far from each other.
  double SquareTo(const SurfacePoint& other, double spacing_m) const {
    return (place - other.place).squaredNorm() + spacing_m * spacing_m * (1.0 - normal.dot(other.normal));
  }
};

using PlaceKey = std::array<float, 3>;

PlaceKey KeyOf(const Eigen::Vector3f& vertex) {
  return {vertex.x(), vertex.y(), vertex.z()};
}

// The different places of the vertices of a mesh. Vertices of one place get one normal, so that no crack
// opens.
std::map<PlaceKey, SurfacePoint> SurfacePoints(const Scene& mesh) {
  std::map<PlaceKey, SurfacePoint> points;
  for (const Eigen::Vector3f& vertex : mesh.vertices_m)
    points[KeyOf(vertex)] = {vertex.cast<double>(), Eigen::Vector3d::Zero()};
  for (const Eigen::Vector3i& t : mesh.triangles) {
    const Eigen::Vector3d a = mesh.vertices_m[t(0)].cast<double>();
    const Eigen::Vector3d b = mesh.vertices_m[t(1)].cast<double>();
    const Eigen::Vector3d c = mesh.vertices_m[t(2)].cast<double>();
    const Eigen::Vector3d by_area = (b - a).cross(c - a);
    for (const int vertex : t) points[KeyOf(mesh.vertices_m[vertex])].normal += by_area;
  }
  for (auto& [key, point] : points) {
    const double norm = point.normal.norm();
    point.normal =
        norm > 0.0 ? Eigen::Vector3d(point.normal / norm) : Eigen::Vector3d(Eigen::Vector3d::UnitZ());
  }
  return points;
}

// Points that are spread evenly: each is the one farthest from those before it.
std::vector<SurfacePoint> SpreadPoints(const std::map<PlaceKey, SurfacePoint>& points,
                                       const OutlineForm& form) {
  std::vector<SurfacePoint> all;
  for (const auto& [key, point] : points) all.push_back(point);
  std::vector<SurfacePoint> chosen = {all.front()};
  std::vector<double> square(all.size(), std::numeric_limits<double>::infinity());
  while (static_cast<int>(chosen.size()) < form.count) {
    for (std::size_t i = 0; i < all.size(); ++i)
      square[i] = std::min(square[i], all[i].SquareTo(chosen.back(), form.spacing_m));
    chosen.push_back(all[static_cast<std::size_t>(std::ranges::max_element(square) - square.begin())]);
  }
  return chosen;
}

}  // namespace

std::string OutlineForm::NameOf(int index) const {
  return fmt::format("{}_{:02}_m", revolution ? "radius" : "bump", index);
}

std::vector<OutlineForm> OutlineForms(const Scene& scene, const PolarAxes& axes,
                                      const std::vector<std::string>& names) {
  std::vector<OutlineForm> forms;
  for (const std::string& name : names) forms.push_back(FormOf(scene, axes, name));
  return forms;
}

void DivideForOutline(const OutlineForm& form, Scene& scene) {
  DivideObject(scene, form.name, 0.5 * form.spacing_m);
}

ObjectOutline::ObjectOutline(Scene& scene, const OutlineForm& form) {
  const std::vector<std::size_t> vertices = VerticesOfObject(scene, form.name);
  const Scene mesh = MeshOfVertices(scene, vertices);
  if (form.revolution) {
    AddRadii(form, mesh, vertices);
  } else {
    AddBumps(form, mesh, vertices);
  }
}

void ObjectOutline::AddRadii(const OutlineForm& form, const Scene& mesh,
                             const std::vector<std::size_t>& vertices) {
  const Pose body_from_mesh = form.mesh_from_body.Inverse();
  std::vector<Eigen::Vector3d> points;
  for (const Eigen::Vector3f& vertex : mesh.vertices_m)
    points.emplace_back(body_from_mesh * Eigen::Vector3d(vertex.cast<double>()));
  const OuterRadius outer(mesh, points, form.spacing_m * (form.count - 1));
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d across(0.0, points[i].y(), points[i].z());
    const double outer_m = outer.At(points[i].x());
    if (!(outer_m > 0.0)) continue;  // a tip stays on the axis
    vertices_.push_back(
        {.index = vertices[i],
         .along = form.mesh_from_body.rotation * Eigen::Vector3d(across / outer_m),
         .most_inward_m = (1.0 - kLeastRadius) * outer_m,
         .weights = CurveWeights((points[i].x() - form.start_m) / form.spacing_m, form.count)});
  }
}

void ObjectOutline::AddBumps(const OutlineForm& form, const Scene& mesh,
                             const std::vector<std::size_t>& vertices) {
  constexpr double kOfSpacing = 0.5;  // standard deviation of a bump
  constexpr double kLeastWeight = 1e-4;
  const std::map<PlaceKey, SurfacePoint> points = SurfacePoints(mesh);
  const std::vector<SurfacePoint> centres = SpreadPoints(points, form);
  const double width_m = kOfSpacing * form.spacing_m;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const SurfacePoint& point = points.at(KeyOf(mesh.vertices_m[i]));
    std::vector<double> exponents;
    for (const SurfacePoint& centre : centres)
      exponents.push_back(-0.5 * point.SquareTo(centre, form.spacing_m) / (width_m * width_m));
    const double nearest = *std::ranges::max_element(exponents);
    double sum = 0.0;
    for (double& exponent : exponents) sum += exponent = std::exp(exponent - nearest);
    Vertex vertex{.index = vertices[i],
                  .along = point.normal,
                  .most_inward_m = std::numeric_limits<double>::infinity()};
    for (std::size_t k = 0; k < exponents.size(); ++k) {
      if (exponents[k] > kLeastWeight * sum)
        vertex.weights.emplace_back(static_cast<int>(k), exponents[k] / sum);
    }
    vertices_.push_back(std::move(vertex));
  }
}

void ObjectOutline::Reshape(const std::vector<double>& values_m, Scene& scene) const {
  for (const Vertex& vertex : vertices_) {
    double change_m = 0.0;
    for (const auto& [k, weight] : vertex.weights) change_m += weight * values_m[static_cast<std::size_t>(k)];
    change_m = std::max(change_m, -vertex.most_inward_m);
    scene.vertices_m[vertex.index] += (change_m * vertex.along).cast<float>();
  }
}

}  // namespace sonarcal::calib
