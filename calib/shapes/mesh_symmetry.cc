#include "calib/shapes/mesh_symmetry.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/types/error.h"
#include "core/types/units.h"

namespace sonarcal::calib {
namespace {

constexpr int kSamples = 400;
constexpr double kShareWithin = 0.98;  // of the samples
// Turns that no polygon of a few corners has as a symmetry.
constexpr std::array kTurnsDeg = {37.0, 97.0, 151.0};
// Moments of area along two axes that differ by less are those of a body of revolution, or of one near it.
constexpr double kSameMoment = 0.05;

struct Triangle {
  std::array<Eigen::Vector3d, 3> corner;
  Eigen::Vector3d middle;
  double radius_m;
  double area_m2;
};

std::vector<Triangle> TrianglesOf(const Scene& mesh) {
  std::vector<Triangle> triangles;
  for (const Eigen::Vector3i& indices : mesh.triangles) {
    Triangle t;
    for (int i = 0; i < 3; ++i) t.corner[i] = mesh.vertices_m[indices(i)].cast<double>();
    t.middle = (t.corner[0] + t.corner[1] + t.corner[2]) / 3.0;
    t.radius_m = 0.0;
    for (const Eigen::Vector3d& corner : t.corner)
      t.radius_m = std::max(t.radius_m, (corner - t.middle).norm());
    t.area_m2 = 0.5 * (t.corner[1] - t.corner[0]).cross(t.corner[2] - t.corner[0]).norm();
    if (t.area_m2 > 0.0) triangles.push_back(t);
  }
  return triangles;
}

double DistanceToSegment(const Eigen::Vector3d& point, const Eigen::Vector3d& from,
                         const Eigen::Vector3d& to) {
  const Eigen::Vector3d along = to - from;
  const double length2 = along.squaredNorm();
  const double t = length2 > 0.0 ? std::clamp((point - from).dot(along) / length2, 0.0, 1.0) : 0.0;
  return (point - from - t * along).norm();
}

double DistanceToTriangle(const Eigen::Vector3d& point, const Triangle& t) {
  const Eigen::Vector3d normal = (t.corner[1] - t.corner[0]).cross(t.corner[2] - t.corner[0]).normalized();
  bool above = true;  // the point lies above the inside of the triangle
  for (int i = 0; i < 3 && above; ++i) {
    const Eigen::Vector3d side = t.corner[(i + 1) % 3] - t.corner[i];
    above = side.cross(point - t.corner[i]).dot(normal) >= 0.0;
  }
  if (above) return std::abs((point - t.corner[0]).dot(normal));
  double nearest = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i)
    nearest = std::min(nearest, DistanceToSegment(point, t.corner[i], t.corner[(i + 1) % 3]));
  return nearest;
}

class Surface {
 public:
  explicit Surface(const Scene& mesh) : triangles_(TrianglesOf(mesh)) {
    if (triangles_.empty())
      throw DataError("pose search: the mesh of the target has no triangle with an area");
    double area = 0.0;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const Triangle& t : triangles_) {
      area += t.area_m2;
      sum += t.area_m2 * t.middle;
    }
    centroid_ = sum / area;
    for (const Triangle& t : triangles_) {
      Eigen::Matrix3d of = 9.0 * (t.middle - centroid_) * (t.middle - centroid_).transpose();
      for (const Eigen::Vector3d& corner : t.corner)
        of += (corner - centroid_) * (corner - centroid_).transpose();
      moments_ += t.area_m2 / 12.0 * of / area;
    }
    Sample(area);
  }

  const Eigen::Vector3d& centroid() const { return centroid_; }
  const Eigen::Matrix3d& moments() const { return moments_; }

  // True if the transform about the centroid maps the surface to itself.
  bool IsKeptBy(const Eigen::Matrix3d& transform, double tolerance_m) const {
    int within = 0;
    for (const Eigen::Vector3d& sample : samples_) {
      if (IsNear(centroid_ + transform * (sample - centroid_), tolerance_m)) ++within;
    }
    return within >= kShareWithin * kSamples;
  }

 private:
  // Points at even steps of area, spread within their triangles by golden sections.
  void Sample(double area) {
    double passed = 0.0;
    std::size_t at = 0;
    for (int i = 0; i < kSamples; ++i) {
      const double wanted = (i + 0.5) / kSamples * area;
      while (at + 1 < triangles_.size() && passed + triangles_[at].area_m2 < wanted)
        passed += triangles_[at++].area_m2;
      double u = std::fmod(i * 0.7548776662466927, 1.0);
      double v = std::fmod(i * 0.5698402909980532, 1.0);
      if (u + v > 1.0) {
        u = 1.0 - u;
        v = 1.0 - v;
      }
      const auto& corner = triangles_[at].corner;
      samples_.emplace_back(corner[0] + u * (corner[1] - corner[0]) + v * (corner[2] - corner[0]));
    }
  }

  bool IsNear(const Eigen::Vector3d& point, double tolerance_m) const {
    return std::any_of(triangles_.begin(), triangles_.end(), [&](const Triangle& t) {
      return (point - t.middle).norm() <= t.radius_m + tolerance_m &&
             DistanceToTriangle(point, t) <= tolerance_m;
    });
  }

  std::vector<Triangle> triangles_;
  Eigen::Vector3d centroid_;
  Eigen::Matrix3d moments_ = Eigen::Matrix3d::Zero();
  std::vector<Eigen::Vector3d> samples_;
};

bool IsSameMoment(double a, double b) {
  return std::abs(a - b) <= kSameMoment * std::max(a, b);
}

// Axes as columns, +x first. Each column points to the positive side of the mesh axis that it is nearest to.
Eigen::Matrix3d Axes(Eigen::Vector3d x, Eigen::Vector3d y) {
  const auto positive = [](Eigen::Vector3d& axis) {
    Eigen::Index largest = 0;
    axis.cwiseAbs().maxCoeff(&largest);
    if (axis(largest) < 0.0) axis = -axis;
  };
  positive(x);
  positive(y);
  Eigen::Matrix3d axes;
  axes << x, y, x.cross(y);
  return axes;
}

// Axes of a body of revolution. Any axis across it will do: one near an axis of the mesh is easiest to read.
Eigen::Matrix3d AxesAbout(const Eigen::Vector3d& x) {
  const Eigen::Vector3d across = std::abs(x.y()) < 0.9 ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitZ();
  return Axes(x, (across - across.dot(x) * x).normalized());
}

}  // namespace

MeshSymmetry FindSymmetry(const Scene& mesh, double tolerance_m) {
  mesh.Validate("pose search: the mesh of the target");
  const Surface surface(mesh);
  // Ascending moments: the last is along the longest direction.
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(surface.moments());
  const Eigen::Vector3d& moments = solver.eigenvalues();
  const Eigen::Matrix3d& vectors = solver.eigenvectors();
  MeshSymmetry found;
  for (const Eigen::Vector3f& vertex : mesh.vertices_m)
    found.radius_m = std::max(found.radius_m, (vertex.cast<double>() - surface.centroid()).norm());
  if (tolerance_m <= 0.0) tolerance_m = 0.02 * found.radius_m;

  const auto turned = [&](const Eigen::Vector3d& axis, double angle_rad) {
    return surface.IsKeptBy(Eigen::AngleAxisd(angle_rad, axis).toRotationMatrix(), tolerance_m);
  };
  const auto is_revolution = [&](const Eigen::Vector3d& axis) {
    return std::all_of(kTurnsDeg.begin(), kTurnsDeg.end(),
                       [&](double deg) { return turned(axis, RadFromDeg(deg)); });
  };
  Eigen::Matrix3d axes = Axes(vectors.col(2), vectors.col(1));
  for (int i = 2; i >= 0 && found.revolution == Revolution::kNone; --i) {
    if (!IsSameMoment(moments((i + 1) % 3), moments((i + 2) % 3))) continue;
    if (!is_revolution(vectors.col(i))) continue;
    found.revolution = Revolution::kAxis;
    axes = AxesAbout(vectors.col(i));
    if (is_revolution(axes.col(1))) found.revolution = Revolution::kSphere;
  }
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d axis = axes.col(i);
    found.half_turn[i] = turned(axis, kPi);
    found.reflection[i] =
        surface.IsKeptBy(Eigen::Matrix3d::Identity() - 2.0 * axis * axis.transpose(), tolerance_m);
  }
  found.mesh_from_body = {Eigen::Quaterniond(axes), surface.centroid()};
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3f& vertex : mesh.vertices_m)
    box.extend(Eigen::Vector3d(axes.transpose() * vertex.cast<double>()));
  found.extent_m = box.sizes().maxCoeff();
  return found;
}

}  // namespace sonarcal::calib
