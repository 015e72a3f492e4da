// The one place that casts rays: Embree behind a wall.
//
// A caster is built once for a scene and used from any number of threads.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "core/types/pose.h"
#include "core/types/scene.h"
#include "sim/rays/ray_fan.h"

namespace sonarcal::sim {

// What each ray met, in the order of the rays.
struct FanHits {
  std::vector<float> range_m;          // infinity for a miss
  std::vector<std::int32_t> triangle;  // index into Scene::triangles; -1 for a miss
};

// Those of a fan's row of rays that met something; arrays of `count`.
struct RowHits {
  int row = 0;
  int count = 0;
  const std::int32_t* col = nullptr;  // ascending
  const float* range_m = nullptr;
  const float* half_tangent = nullptr;  // tan(delta / 2) of the incidence angle: 0 (normal) .. 1 (grazing)
  const std::uint16_t* material = nullptr;
};

// Calls `of_run(first, count)` for each run of hits of one material: a row seldom shows more than a few, and
// each is shaded at once.
template <typename OfRun>
void ForEachMaterial(const RowHits& hits, OfRun&& of_run) {
  for (int first = 0; first < hits.count;) {
    int end = first + 1;
    while (end < hits.count && hits.material[end] == hits.material[first]) ++end;
    of_run(first, end - first);
    first = end;
  }
}

// Rays that start anywhere, in world coordinates; arrays of one length. Directions are unit vectors.
struct FreeRays {
  std::array<std::vector<float>, 3> origin_m;
  std::array<std::vector<float>, 3> direction;
  std::vector<float> max_range_m;

  std::size_t size() const { return max_range_m.size(); }
  void Clear();
  void Add(const Eigen::Vector3d& from_m, const Eigen::Vector3d& towards, double up_to_m);
};

class RayCaster {
 public:
  // The scene is kept, once: Embree reads its mesh where it lies. Hand it over by std::move where it is
  // large. Throws DataError for an invalid scene, std::runtime_error where Embree cannot start.
  explicit RayCaster(Scene scene);
  ~RayCaster();
  RayCaster(const RayCaster&) = delete;
  RayCaster& operator=(const RayCaster&) = delete;

  // Casts every ray of the fan from `world_from_sonar` on all cores; nothing beyond max_range_m is met.
  FanHits Cast(const RayFan& fan, const Pose& world_from_sonar, double max_range_m) const;

  // The same, each row handed to `take` as soon as it is known: from all cores at once, in no order. The
  // arrays are gone when `take` returns.
  void CastRows(const RayFan& fan, const Pose& world_from_sonar, double max_range_m,
                const std::function<void(const RowHits&)>& take) const;

  // The same in blocks of columns: rays of a block come row by row, the rows in order, on one thread; blocks
  // from all cores at once. Whoever sums by column gets the same sums on any number of threads.
  void CastColumns(const RayFan& fan, const Pose& world_from_sonar, double max_range_m,
                   const std::function<void(const RowHits&)>& take) const;

  // What each of the rays met first, on the calling thread: for callers that run on all cores themselves.
  FanHits Meet(const FreeRays& rays) const;

  // Whether anything lies on each of the rays, 1 or 0; likewise.
  std::vector<char> Obstructed(const FreeRays& rays) const;

  // Unit normal of a triangle in world coordinates.
  const Eigen::Vector3f& TriangleNormal(int triangle) const { return normals_[triangle]; }
  std::uint16_t TriangleMaterial(int triangle) const { return scene_.triangle_material[triangle]; }
  const std::vector<std::string>& material_names() const { return scene_.material_names; }
  const Scene& scene() const { return scene_; }

  // Rays cast so far. A fit of materials adds nothing to it.
  std::int64_t rays_cast() const;

 private:
  struct Embree;
  struct RowBuffers;
  struct Casting;
  template <typename Met>
  void CastTiles(const Casting& casting, int row, RowBuffers& buffers, Met&& met) const;
  void CastRowsOf(const Casting& casting, int begin, int end,
                  const std::function<void(const RowHits&)>& take) const;

  Scene scene_;
  std::unique_ptr<Embree> embree_;  // goes before the scene it reads
  std::vector<Eigen::Vector3f> normals_;
};

}  // namespace sonarcal::sim
