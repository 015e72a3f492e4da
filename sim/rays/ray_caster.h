// Casts rays. The only interface to Embree.
//
// A caster is built once per scene. Any number of threads may use it.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <functional>
#include <memory>
#include <vector>

#include "core/types/pose.h"
#include "core/types/scene.h"
#include "sim/rays/ray_fan.h"
#include "sim/rays/row_math/directions.h"

struct RTCRayHit8;

namespace sonarcal::sim {

// First intersection of each ray, in the order of the rays.
struct FanHits {
  std::vector<float> range_m;          // infinity for a miss
  std::vector<std::int32_t> triangle;  // index into Scene::triangles; -1 for a miss
};

// Hits of one row of a fan; arrays of `count` elements.
struct RowHits {
  int row = 0;
  int count = 0;
  const std::int32_t* col = nullptr;  // ascending
  const float* range_m = nullptr;
  const float* half_tangent = nullptr;  // tan(delta / 2) of the incidence angle: 0 (normal) .. 1 (grazing)
  const std::uint16_t* material = nullptr;
};

// Calls `of_run(first, count)` for each run of hits on one material, so that a run is shaded in one step. A
// row seldom has more than a few runs.
template <typename OfRun>
void ForEachMaterial(const RowHits& hits, OfRun&& of_run) {
  for (int first = 0; first < hits.count;) {
    // Most runs reach the end of the row. One comparison of neighbouring elements shows this.
    const std::uint16_t* material = hits.material + first;
    int end = hits.count;
    if (std::memcmp(material, material + 1, (end - first - 1) * sizeof *material) != 0) {
      end = first + 1;
      while (end < hits.count && hits.material[end] == *material) ++end;
    }
    of_run(first, end - first);
    first = end;
  }
}

// Rays with any origin, in world coordinates; arrays of one length. Directions are unit vectors.
struct FreeRays {
  std::array<std::vector<float>, 3> origin_m;
  std::array<std::vector<float>, 3> direction;
  std::vector<float> max_range_m;

  std::size_t size() const { return max_range_m.size(); }
  void Clear();
  void Reserve(std::size_t count);
  void Add(const Eigen::Vector3d& from_m, const Eigen::Vector3d& towards, double up_to_m);
};

class RayCaster {
 public:
  // Keeps the scene; Embree reads the mesh in place. Pass a large scene with std::move. Throws DataError for
  // an invalid scene, std::runtime_error if Embree cannot start.
  explicit RayCaster(Scene scene);
  // Another scene, whose rays count as those of `counted_with`.
  RayCaster(Scene scene, const RayCaster& counted_with);
  ~RayCaster();
  RayCaster(const RayCaster&) = delete;
  RayCaster& operator=(const RayCaster&) = delete;

  // Casts every ray of the fan from `world_from_sonar` on all cores. Surfaces beyond max_range_m are misses.
  FanHits Cast(const RayFan& fan, const Pose& world_from_sonar, double max_range_m) const;

  // Casts the fan and passes the hits of each row to `take`. `take` is called from all cores, in any order.
  // The arrays are valid only during the call.
  void CastRows(const RayFan& fan, const Pose& world_from_sonar, double max_range_m,
                const std::function<void(const RowHits&)>& take) const;

  // Calls `of_block` for each block of columns of the fan; blocks run on all cores. block.cast(take) casts
  // the rays of the block and passes the hits of its rows to `take`, in order and on the calling thread. Sums
  // per column therefore do not depend on the number of threads. Blocks are equally wide up to a tile.
  static constexpr int kBlockCols = 64;
  static int CountBlocks(const RayFan& fan) { return (fan.cols() + kBlockCols - 1) / kBlockCols; }
  struct ColumnBlock {
    int index = 0;  // 0 .. CountBlocks - 1
    int first_col = 0;
    int cols = 0;  // at most kBlockCols
    std::function<void(const std::function<void(const RowHits&)>& take)> cast;
  };
  void CastColumns(const RayFan& fan, const Pose& world_from_sonar, double max_range_m,
                   const std::function<void(const ColumnBlock&)>& of_block) const;

  // First intersection of each ray. Single-threaded, for callers that run on all cores themselves.
  FanHits FirstIntersections(const FreeRays& rays) const;

  // 1 for each ray that hits anything, otherwise 0. Single-threaded.
  std::vector<char> IsOccluded(const FreeRays& rays) const;

  // Unit normal of a triangle in world coordinates.
  Eigen::Vector3f TriangleNormal(int triangle) const {
    const row_math::Plane& plane = planes_[triangle];
    return Eigen::Vector3d(plane[0], plane[1], plane[2]).cast<float>();
  }
  std::uint16_t TriangleMaterial(int triangle) const { return scene_.triangle_material[triangle]; }
  const std::vector<std::string>& material_names() const { return scene_.material_names; }
  const Scene& scene() const { return scene_; }

  // Number of rays cast so far. A fit of materials does not increase it.
  std::int64_t rays_cast() const;

 private:
  struct Embree;
  struct RowBuffers;
  struct Casting;
  void MeasureRanges(RTCRayHit8& packet, const float* farthest_m) const;
  template <typename Met>
  void CastTiles(const Casting& casting, int row, RowBuffers& buffers, Met&& met) const;
  void CastRowsOf(const Casting& casting, int begin, int end,
                  const std::function<void(const RowHits&)>& take) const;

  Scene scene_;
  std::unique_ptr<Embree> embree_;       // declared after the scene it reads, so destroyed first
  std::vector<row_math::Plane> planes_;  // of the triangles
};

}  // namespace sonarcal::sim
