#include "sim/rays/trace.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/types/error.h"

namespace sonarcal::sim {
namespace {

// Finite-difference normals of a fan's point cloud, in the sonar frame.
class DepthNormals {
 public:
  DepthNormals(const RayFan& fan, const FanHits& hits, const TraceOptions& options)
      : fan_(fan), hits_(hits), options_(options) {}

  // Normal vector, not normalised. Nothing if a difference is missing in either direction.
  std::optional<Eigen::Vector3f> At(int row, int col) const {
    const auto along_row = Difference(row, col, 0, options_.step);
    const auto along_col = Difference(row, col, options_.step, 0);
    if (!along_row || !along_col) return std::nullopt;
    return along_row->cross(*along_col);
  }

 private:
  Eigen::Vector3f Point(int row, int col, float range_m) const { return fan_.Direction(row, col) * range_m; }

  std::optional<Eigen::Vector3f> Difference(int row, int col, int row_step, int col_step) const {
    const float range_m = Range(row, col);
    for (const int sign : {1, -1}) {
      const int other_row = row + sign * row_step;
      const int other_col = col + sign * col_step;
      if (other_row < 0 || other_row >= fan_.rows() || other_col < 0 || other_col >= fan_.cols()) continue;
      const float other_m = Range(other_row, other_col);
      if (!(std::abs(other_m - range_m) <= static_cast<float>(options_.jump_ratio) * range_m)) continue;
      return static_cast<float>(sign) * (Point(other_row, other_col, other_m) - Point(row, col, range_m));
    }
    return std::nullopt;
  }

  float Range(int row, int col) const {
    return hits_.range_m[static_cast<std::size_t>(row) * fan_.cols() + col];
  }

  const RayFan& fan_;
  const FanHits& hits_;
  const TraceOptions& options_;
};

double AngleBetweenRad(const Eigen::Vector3f& direction, const Eigen::Vector3f& normal) {
  const Eigen::Vector3d d = direction.cast<double>();
  const Eigen::Vector3d n = normal.cast<double>();
  // atan2 keeps its precision at normal incidence, where acos loses half the digits.
  return std::atan2(d.cross(n).norm(), std::abs(d.dot(n)));
}

}  // namespace

void TraceOptions::Check() const {
  if (step < 1 || step > 16) throw DataError("normals: step {}, expected 1 .. 16", step);
  if (!(jump_ratio > 0.0)) throw DataError("normals: jump ratio {}, expected a positive one", jump_ratio);
}

EchoList EmptyEchoList(const RayFan& fan, const std::vector<std::string>& material_names) {
  EchoList echoes;
  echoes.cols = fan.cols();
  for (int col = 0; col < fan.cols(); ++col) echoes.beam_of_column.push_back(fan.BeamOfColumn(col));
  echoes.rays_per_beam = fan.rays_per_beam();
  echoes.material_names = material_names;
  return echoes;
}

EchoList Trace(const RayCaster& caster, const RayFan& fan, const Pose& world_from_sonar,
               const PolarAxes& axes, const TraceOptions& options) {
  options.Check();
  const FanHits hits = caster.Cast(fan, world_from_sonar, axes.range_max_m);
  const auto is_echo = [&](std::size_t ray) {
    return hits.triangle[ray] >= 0 && IsEcho(hits.range_m[ray], axes);
  };

  // Counts the echoes of each row, then fills the list in place. The list is in the order of the rays on any
  // number of threads.
  std::vector<std::size_t> row_start(fan.rows() + 1, 0);
  const auto for_rows = [&](auto&& body) {
    tbb::parallel_for(tbb::blocked_range<int>(0, fan.rows(), 4), [&](const tbb::blocked_range<int>& rows) {
      for (int row = rows.begin(); row != rows.end(); ++row) body(row);
    });
  };
  for_rows([&](int row) {
    const std::size_t first = static_cast<std::size_t>(row) * fan.cols();
    for (int col = 0; col < fan.cols(); ++col) row_start[row + 1] += is_echo(first + col) ? 1 : 0;
  });
  for (int row = 0; row < fan.rows(); ++row) row_start[row + 1] += row_start[row];

  EchoList echoes = EmptyEchoList(fan, caster.material_names());
  const std::size_t count = row_start.back();
  echoes.ray.resize(count);
  echoes.material.resize(count);
  echoes.range_m.resize(count);
  echoes.azimuth_rad.resize(count);
  echoes.elevation_rad.resize(count);
  echoes.incidence_rad.resize(count);
  echoes.solid_angle_sr.resize(count);
  if (!fan.weighs_evenly()) echoes.weight.resize(count);

  const Eigen::Matrix3f sonar_from_world =
      world_from_sonar.rotation.conjugate().toRotationMatrix().cast<float>();
  const DepthNormals depth_normals(fan, hits, options);
  for_rows([&](int row) {
    std::size_t echo = row_start[row];
    std::vector<float> weight;
    if (!echoes.weight.empty()) {
      weight.resize(static_cast<std::size_t>(fan.cols()));
      fan.RowWeights(row, weight.data());
    }
    for (int col = 0; col < fan.cols(); ++col) {
      const std::size_t ray = static_cast<std::size_t>(row) * fan.cols() + col;
      if (!is_echo(ray)) continue;
      const int triangle = hits.triangle[ray];
      Eigen::Vector3f normal = sonar_from_world * caster.TriangleNormal(triangle);
      if (options.normals == NormalSource::kDepth) normal = depth_normals.At(row, col).value_or(normal);
      echoes.ray[echo] = static_cast<std::uint32_t>(ray);
      echoes.material[echo] = caster.TriangleMaterial(triangle);
      echoes.range_m[echo] = hits.range_m[ray];
      echoes.azimuth_rad[echo] = static_cast<float>(fan.AzimuthRad(row, col));
      echoes.elevation_rad[echo] = static_cast<float>(fan.ElevationRad(row, col));
      echoes.incidence_rad[echo] = static_cast<float>(AngleBetweenRad(fan.Direction(row, col), normal));
      echoes.solid_angle_sr[echo] = static_cast<float>(fan.SolidAngleSr(row, col));
      if (!weight.empty()) echoes.weight[echo] = weight[col];
      ++echo;
    }
  });
  return echoes;
}

}  // namespace sonarcal::sim
