#include "sim/rays/ray_caster.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdlib>
#include <limits>
#include <stdexcept>
#include <utility>

#include "core/types/error.h"
#include "sim/rays/embree_queries.h"
#include "sim/rays/row_math/directions.h"

namespace sonarcal::sim {
namespace {

// Size of a tile of neighbouring rows and columns. Each tile is one packet: rays that are close in both
// directions visit fewer boxes of the tree than the same number of rays in a line. A packet has as many rays
// as AVX2 has lanes; Embree would divide a larger one.
constexpr int kTileRows = 2;
constexpr int kTileCols = 4;
constexpr int kPacket = kTileRows * kTileCols;
using Packet = RTCRayHit8;

// Lane of a ray of a tile.
constexpr int LaneOf(int row, int col) {
  return row * kTileCols + col;
}

}  // namespace

// Directions of the rows of a tile, padded to whole tiles, and the packet of a tile.
struct RayCaster::RowBuffers {
  RowBuffers(int cols, const Eigen::Vector3f& origin, float max_range_m) {
    for (auto& of_row : direction) {
      for (std::vector<float>& component : of_row)
        component.resize(static_cast<std::size_t>(cols) + kTileCols, 0.0F);
    }
    std::fill_n(packet.ray.org_x, kPacket, origin.x());
    std::fill_n(packet.ray.org_y, kPacket, origin.y());
    std::fill_n(packet.ray.org_z, kPacket, origin.z());
    std::fill_n(packet.ray.mask, kPacket, ~0U);
    std::fill_n(packet.hit.instID[0], kPacket, RTC_INVALID_GEOMETRY_ID);
    std::fill_n(farthest_m, kPacket, max_range_m);
  }

  std::array<std::array<std::vector<float>, 3>, kTileRows> direction;
  embree::Query query{true};
  alignas(32) Packet packet = {};
  alignas(32) float farthest_m[kPacket] = {};
};

namespace {

bool AnyHit(const Packet& packet) {
  return std::any_of(packet.hit.geomID, packet.hit.geomID + kPacket,
                     [](unsigned id) { return id != RTC_INVALID_GEOMETRY_ID; });
}

bool AllHit(const Packet& packet, int first_lane) {
  const unsigned* ids = packet.hit.geomID + first_lane;
  return std::none_of(ids, ids + kTileCols, [](unsigned id) { return id == RTC_INVALID_GEOMETRY_ID; });
}

// Hits of a row, one tile after the other.
class HitsOfRow {
 public:
  explicit HitsOfRow(int cols)
      : col_(static_cast<std::size_t>(cols + kTileCols)),
        range_m_(col_.size()),
        half_tangent_(col_.size()),
        material_(col_.size()) {}

  void Clear() { count_ = 0; }

  // Adds `count` rays of a tile's row: the first has column `first` and lane `lane`. Misses are written too
  // and overwritten by the next ray, which avoids a branch.
  void Add(int first, int count, int lane, const Packet& packet, const float* half_tangent,
           const std::vector<std::uint16_t>& materials) {
    if (count == kTileCols && AllHit(packet, lane)) {
      for (int i = 0; i < kTileCols; ++i) col_[count_ + i] = first + i;
      std::copy_n(&packet.ray.tfar[lane], kTileCols, &range_m_[count_]);
      std::copy_n(&half_tangent[lane], kTileCols, &half_tangent_[count_]);
      for (int i = 0; i < kTileCols; ++i) material_[count_ + i] = materials[packet.hit.primID[lane + i]];
      count_ += kTileCols;
      return;
    }
    for (int i = 0; i < count; ++i, ++lane) {
      const bool hit = packet.hit.geomID[lane] != RTC_INVALID_GEOMETRY_ID;
      col_[count_] = first + i;
      range_m_[count_] = packet.ray.tfar[lane];
      half_tangent_[count_] = half_tangent[lane];
      material_[count_] = materials[hit ? packet.hit.primID[lane] : 0];
      count_ += hit ? 1 : 0;
    }
  }

  RowHits Of(int row) const {
    return {row, count_, col_.data(), range_m_.data(), half_tangent_.data(), material_.data()};
  }

 private:
  int count_ = 0;
  std::vector<std::int32_t> col_;
  std::vector<float> range_m_;
  std::vector<float> half_tangent_;
  std::vector<std::uint16_t> material_;
};

}  // namespace

struct RayCaster::Embree {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  std::shared_ptr<std::atomic<std::int64_t>> rays_cast = std::make_shared<std::atomic<std::int64_t>>(0);

  Embree() = default;
  Embree(const Embree&) = delete;
  Embree& operator=(const Embree&) = delete;
  ~Embree() {
    if (scene != nullptr) rtcReleaseScene(scene);
    if (device != nullptr) rtcReleaseDevice(device);
  }
};

RayCaster::RayCaster(Scene scene) : scene_(std::move(scene)), embree_(std::make_unique<Embree>()) {
  scene_.Validate("scene");
  // The first parallel loop of a thread sets the floating-point mode of its later loops. Embree flushes
  // denormal numbers to zero while it builds its tree. Without a loop before it, results would depend on
  // what ran earlier in the process.
  tbb::parallel_for(0, 1, [](int) {});
  // AVX2 kernels on every processor that has AVX2, also with AVX-512, so that rays hit the same edges. The
  // environment variable selects other kernels for tests.
  const char* kernels = std::getenv("SONARCAL_EMBREE");
  embree_->device = rtcNewDevice(kernels != nullptr ? kernels : "max_isa=avx2");
  if (embree_->device == nullptr) {
    const auto error = static_cast<int>(rtcGetDeviceError(nullptr));
    if (kernels != nullptr) {
      throw DataError(
          "SONARCAL_EMBREE is '{}', expected kernels that this processor supports (Embree error {})", kernels,
          error);
    }
    throw std::runtime_error(fmt::format("the ray tracer did not start (Embree error {})", error));
  }
  embree_->scene = rtcNewScene(embree_->device);
  // Watertight edges: a ray must not pass between two triangles of a closed surface.
  rtcSetSceneFlags(embree_->scene, RTC_SCENE_FLAG_ROBUST);

  RTCGeometry geometry = rtcNewGeometry(embree_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  // Embree reads vertices 16 bytes at a time, so it reads beyond the end of the last one.
  scene_.vertices_m.reserve(scene_.vertices_m.size() + 1);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, scene_.vertices_m.data(),
                             0, sizeof(Eigen::Vector3f), scene_.vertices_m.size());
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, scene_.triangles.data(), 0,
                             sizeof(Eigen::Vector3i), scene_.triangles.size());
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(embree_->scene, geometry, 0);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(embree_->scene);
  if (const RTCError error = rtcGetDeviceError(embree_->device); error != RTC_ERROR_NONE) {
    throw std::runtime_error(fmt::format("the ray tracer could not build its structure (Embree error {})",
                                         static_cast<int>(error)));
  }

  planes_.reserve(scene_.triangles.size());
  for (const Eigen::Vector3i& t : scene_.triangles) {
    const Eigen::Vector3d at = scene_.vertices_m[t[0]].cast<double>();
    const Eigen::Vector3d edge1 = scene_.vertices_m[t[1]].cast<double>() - at;
    const Eigen::Vector3d edge2 = scene_.vertices_m[t[2]].cast<double>() - at;
    const Eigen::Vector3d normal = edge1.cross(edge2).normalized();
    planes_.push_back({normal.x(), normal.y(), normal.z(), normal.dot(at)});
  }
}

RayCaster::RayCaster(Scene scene, const RayCaster& counted_with) : RayCaster(std::move(scene)) {
  embree_->rays_cast = counted_with.embree_->rays_cast;
}

RayCaster::~RayCaster() = default;

// Replaces the ranges of a packet's hits by those to the planes of the triangles. Embree divides by an
// estimate of the reciprocal, whose last bits differ between makers of processors.
void RayCaster::MeasureRanges(RTCRayHit8& packet, const float* farthest_m) const {
  std::uint32_t triangle[kPacket];
  for (int lane = 0; lane < kPacket; ++lane)
    triangle[lane] = packet.hit.geomID[lane] != RTC_INVALID_GEOMETRY_ID ? packet.hit.primID[lane] : 0;
  const RTCRay8& ray = packet.ray;
  row_math::PlaneRanges(planes_.data(), triangle,
                        {.origin_m = {ray.org_x, ray.org_y, ray.org_z},
                         .direction = {ray.dir_x, ray.dir_y, ray.dir_z},
                         .farthest_m = farthest_m},
                        kPacket, packet.ray.tfar);
}

std::int64_t RayCaster::rays_cast() const {
  return embree_->rays_cast->load();
}

// Data shared by the rays of some columns of a fan.
struct RayCaster::Casting {
  Casting(const RayFan& of, const Pose& world_from_sonar, double range_m)
      : fan(of),
        rotation(world_from_sonar.rotation.toRotationMatrix().cast<float>()),
        origin(world_from_sonar.position_m.cast<float>()),
        max_range_m(static_cast<float>(range_m)),
        cols(of.cols()) {}

  const RayFan& fan;
  Eigen::Matrix3f rotation;
  Eigen::Vector3f origin;
  float max_range_m;
  int first_col = 0;
  int cols;
};

// Casts the rays of one row of tiles, which begins at the fan's row `row`. Calls `met(first, count, packet)`
// after each tile of which any ray hits: its rows hold `count` rays from column `first` on. Rays beyond the
// fan's last row count as misses.
template <typename Met>
void RayCaster::CastTiles(const Casting& casting, int row, RowBuffers& buffers, Met&& met) const {
  const int rows = std::min(kTileRows, casting.fan.rows() - row);
  for (int r = 0; r < rows; ++r) {
    auto& direction = buffers.direction[r];
    casting.fan.RowDirections(row + r, casting.first_col, casting.cols, casting.rotation, direction[0].data(),
                              direction[1].data(), direction[2].data());
  }
  Packet& packet = buffers.packet;
  alignas(32) int valid[kPacket];
  const auto set_valid = [&](int cols) {
    for (int lane = 0; lane < kPacket; ++lane)
      valid[lane] = lane / kTileCols < rows && lane % kTileCols < cols ? -1 : 0;
  };
  set_valid(kTileCols);
  for (int at = 0; at < casting.cols; at += kTileCols) {
    const int count = std::min(kTileCols, casting.cols - at);
    if (count < kTileCols) set_valid(count);
    for (int r = 0; r < kTileRows; ++r) {
      const auto& direction = buffers.direction[r];
      const int lane = LaneOf(r, 0);
      std::copy_n(&direction[0][at], kTileCols, packet.ray.dir_x + lane);
      std::copy_n(&direction[1][at], kTileCols, packet.ray.dir_y + lane);
      std::copy_n(&direction[2][at], kTileCols, packet.ray.dir_z + lane);
    }
    std::fill_n(packet.ray.tfar, kPacket, casting.max_range_m);
    std::fill_n(packet.hit.geomID, kPacket, RTC_INVALID_GEOMETRY_ID);
    buffers.query.Intersect8(valid, embree_->scene, &packet);
    if (!AnyHit(packet)) continue;
    MeasureRanges(packet, buffers.farthest_m);
    met(casting.first_col + at, count, packet);
  }
}

// Calls `of_rows(first, last)` on all cores, for parts of the fan that begin with a tile's first row.
template <typename OfRows>
void ForRows(const RayFan& fan, OfRows&& of_rows) {
  const int tiles = (fan.rows() + kTileRows - 1) / kTileRows;
  tbb::parallel_for(tbb::blocked_range<int>(0, tiles), [&](const tbb::blocked_range<int>& range) {
    const embree::FlushDenormals flush;
    of_rows(kTileRows * range.begin(), std::min(kTileRows * range.end(), fan.rows()));
  });
}

FanHits RayCaster::Cast(const RayFan& fan, const Pose& world_from_sonar, double max_range_m) const {
  FanHits hits;
  hits.range_m.assign(fan.size(), std::numeric_limits<float>::infinity());
  hits.triangle.assign(fan.size(), -1);
  const Casting casting(fan, world_from_sonar, max_range_m);
  ForRows(fan, [&](int begin, int end) {
    RowBuffers buffers(fan.cols(), casting.origin, casting.max_range_m);
    for (int row = begin; row < end; row += kTileRows) {
      CastTiles(casting, row, buffers, [&](int first, int count, const Packet& packet) {
        for (int r = 0; r < std::min(kTileRows, end - row); ++r) {
          const std::size_t offset = static_cast<std::size_t>(row + r) * fan.cols() + first;
          for (int i = 0; i < count; ++i) {
            const int lane = LaneOf(r, i);
            if (packet.hit.geomID[lane] == RTC_INVALID_GEOMETRY_ID) continue;
            hits.range_m[offset + i] = packet.ray.tfar[lane];
            hits.triangle[offset + i] = static_cast<std::int32_t>(packet.hit.primID[lane]);
          }
        }
      });
    }
  });
  *embree_->rays_cast += fan.size();
  return hits;
}

// Passes the hits of rows begin .. end - 1 to `take`, row by row.
void RayCaster::CastRowsOf(const Casting& casting, int begin, int end,
                           const std::function<void(const RowHits&)>& take) const {
  RowBuffers buffers(casting.cols, casting.origin, casting.max_range_m);
  std::vector<HitsOfRow> hits(kTileRows, HitsOfRow(casting.cols));
  for (int row = begin; row < end; row += kTileRows) {
    for (HitsOfRow& of_row : hits) of_row.Clear();
    CastTiles(casting, row, buffers, [&](int first, int count, const Packet& packet) {
      float half_tangent[kPacket];
      row_math::HalfTangents(packet.ray.dir_x, packet.ray.dir_y, packet.ray.dir_z, packet.hit.Ng_x,
                             packet.hit.Ng_y, packet.hit.Ng_z, kPacket, half_tangent);
      for (int r = 0; r < kTileRows; ++r)
        hits[r].Add(first, count, LaneOf(r, 0), packet, half_tangent, scene_.triangle_material);
    });
    for (int r = 0; r < std::min(kTileRows, end - row); ++r) take(hits[r].Of(row + r));
  }
}

void RayCaster::CastRows(const RayFan& fan, const Pose& world_from_sonar, double max_range_m,
                         const std::function<void(const RowHits&)>& take) const {
  const Casting casting(fan, world_from_sonar, max_range_m);
  ForRows(fan, [&](int begin, int end) { CastRowsOf(casting, begin, end, take); });
  *embree_->rays_cast += fan.size();
}

void RayCaster::CastColumns(const RayFan& fan, const Pose& world_from_sonar, double max_range_m,
                            const std::function<void(const ColumnBlock&)>& of_block) const {
  static_assert(kBlockCols % kTileCols == 0);
  const int blocks = CountBlocks(fan);
  const int tiles = (fan.cols() + kTileCols - 1) / kTileCols;
  const auto first_col = [&](int block) { return std::min(tiles * block / blocks * kTileCols, fan.cols()); };
  tbb::parallel_for(0, blocks, [&](int block) {
    const embree::FlushDenormals flush;
    Casting casting(fan, world_from_sonar, max_range_m);
    casting.first_col = first_col(block);
    casting.cols = first_col(block + 1) - casting.first_col;
    of_block({block, casting.first_col, casting.cols, [&](const std::function<void(const RowHits&)>& take) {
                CastRowsOf(casting, 0, fan.rows(), take);
              }});
  });
  *embree_->rays_cast += fan.size();
}

void FreeRays::Clear() {
  for (auto& component : origin_m) component.clear();
  for (auto& component : direction) component.clear();
  max_range_m.clear();
}

void FreeRays::Reserve(std::size_t count) {
  for (auto& component : origin_m) component.reserve(count);
  for (auto& component : direction) component.reserve(count);
  max_range_m.reserve(count);
}

void FreeRays::Add(const Eigen::Vector3d& from_m, const Eigen::Vector3d& towards, double up_to_m) {
  for (int i = 0; i < 3; ++i) {
    origin_m[i].push_back(static_cast<float>(from_m[i]));
    direction[i].push_back(static_cast<float>(towards[i]));
  }
  max_range_m.push_back(static_cast<float>(up_to_m));
}

namespace {

// Fills `ray` (an RTCRay8) with the rays from `first` on. Sets `valid` to -1 for each lane that holds a ray.
template <typename Rays>
void Load(const FreeRays& rays, std::size_t first, Rays& ray, int* valid) {
  const std::size_t count = std::min<std::size_t>(kPacket, rays.size() - first);
  std::fill_n(valid, kPacket, 0);
  std::fill_n(valid, count, -1);
  const auto copy = [&](const std::vector<float>& from, float* to) {
    std::copy_n(from.data() + first, count, to);
  };
  copy(rays.origin_m[0], ray.org_x);
  copy(rays.origin_m[1], ray.org_y);
  copy(rays.origin_m[2], ray.org_z);
  copy(rays.direction[0], ray.dir_x);
  copy(rays.direction[1], ray.dir_y);
  copy(rays.direction[2], ray.dir_z);
  copy(rays.max_range_m, ray.tfar);
  std::fill_n(ray.tnear, kPacket, 0.0F);
  std::fill_n(ray.time, kPacket, 0.0F);
  std::fill_n(ray.mask, kPacket, ~0U);
  std::fill_n(ray.flags, kPacket, 0U);
}

}  // namespace

FanHits RayCaster::FirstIntersections(const FreeRays& rays) const {
  FanHits hits;
  hits.range_m.assign(rays.size(), std::numeric_limits<float>::infinity());
  hits.triangle.assign(rays.size(), -1);
  const embree::FlushDenormals flush;
  embree::Query query(true);
  alignas(32) Packet packet = {};
  alignas(32) float farthest_m[kPacket];
  alignas(32) int valid[kPacket];
  for (std::size_t first = 0; first < rays.size(); first += kPacket) {
    Load(rays, first, packet.ray, valid);
    std::fill_n(packet.hit.geomID, kPacket, RTC_INVALID_GEOMETRY_ID);
    std::fill_n(packet.hit.instID[0], kPacket, RTC_INVALID_GEOMETRY_ID);
    std::copy_n(packet.ray.tfar, kPacket, farthest_m);
    query.Intersect8(valid, embree_->scene, &packet);
    MeasureRanges(packet, farthest_m);
    for (std::size_t i = 0; i < std::min<std::size_t>(kPacket, rays.size() - first); ++i) {
      if (packet.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
      hits.range_m[first + i] = packet.ray.tfar[i];
      hits.triangle[first + i] = static_cast<std::int32_t>(packet.hit.primID[i]);
    }
  }
  *embree_->rays_cast += static_cast<std::int64_t>(rays.size());
  return hits;
}

std::vector<char> RayCaster::IsOccluded(const FreeRays& rays) const {
  std::vector<char> occluded(rays.size(), 0);
  const embree::FlushDenormals flush;
  embree::Query query(true);
  alignas(32) RTCRay8 packet = {};
  alignas(32) int valid[kPacket];
  for (std::size_t first = 0; first < rays.size(); first += kPacket) {
    Load(rays, first, packet, valid);
    query.Occluded8(valid, embree_->scene, &packet);
    for (std::size_t i = 0; i < std::min<std::size_t>(kPacket, rays.size() - first); ++i) {
      // Embree marks an occluded ray this way.
      occluded[first + i] = packet.tfar[i] == -std::numeric_limits<float>::infinity() ? 1 : 0;
    }
  }
  *embree_->rays_cast += static_cast<std::int64_t>(rays.size());
  return occluded;
}

}  // namespace sonarcal::sim
