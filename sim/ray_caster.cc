#include "sim/ray_caster.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "data_io/types/error.h"
#include "sim/embree_queries.h"
#include "sim/row_math.h"

namespace sonarcal {
namespace {

constexpr int kPacket = 16;

}  // namespace

// Directions of a row, padded to whole packets.
struct RayCaster::RowBuffers {
  std::array<std::vector<float>, 3> direction;
};

namespace {

// The hits of a row, one packet after the other.
class HitsOfRow {
 public:
  explicit HitsOfRow(int cols)
      : col_(static_cast<std::size_t>(cols + kPacket)),
        range_m_(col_.size()),
        half_tangent_(col_.size()),
        material_(col_.size()) {}

  void Clear() { count_ = 0; }

  void Add(int first, int count, const RTCRayHit16& packet, const std::vector<std::uint16_t>& materials) {
    int hits = 0;
    for (int i = 0; i < count; ++i) hits += packet.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID ? 1 : 0;
    if (hits == 0) return;
    float half_tangent[kPacket];
    row_math::HalfTangents(packet.ray.dir_x, packet.ray.dir_y, packet.ray.dir_z, packet.hit.Ng_x,
                           packet.hit.Ng_y, packet.hit.Ng_z, kPacket, half_tangent);
    if (hits == kPacket) {
      std::iota(&col_[count_], &col_[count_] + kPacket, first);
      std::copy_n(packet.ray.tfar, kPacket, &range_m_[count_]);
      std::copy_n(half_tangent, kPacket, &half_tangent_[count_]);
      for (int i = 0; i < kPacket; ++i) material_[count_ + i] = materials[packet.hit.primID[i]];
      count_ += kPacket;
      return;
    }
    // Written whether hit or not, and written over by the next where not: no branch to be guessed.
    for (int i = 0; i < count; ++i) {
      const bool hit = packet.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID;
      col_[count_] = first + i;
      range_m_[count_] = packet.ray.tfar[i];
      half_tangent_[count_] = half_tangent[i];
      material_[count_] = materials[hit ? packet.hit.primID[i] : 0];
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
  std::atomic<std::int64_t> rays_cast{0};

  ~Embree() {
    if (scene != nullptr) rtcReleaseScene(scene);
    if (device != nullptr) rtcReleaseDevice(device);
  }
};

RayCaster::RayCaster(Scene scene) : scene_(std::move(scene)), embree_(std::make_unique<Embree>()) {
  scene_.Validate("scene");
  embree_->device = rtcNewDevice(nullptr);
  if (embree_->device == nullptr) {
    throw std::runtime_error(fmt::format("the ray tracer did not start (Embree error {})",
                                         static_cast<int>(rtcGetDeviceError(nullptr))));
  }
  embree_->scene = rtcNewScene(embree_->device);
  // Watertight edges: a ray between two triangles must not fall through the tank's floor.
  rtcSetSceneFlags(embree_->scene, RTC_SCENE_FLAG_ROBUST);

  RTCGeometry geometry = rtcNewGeometry(embree_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  // Embree reads vertices 16 bytes at a time, beyond the end of the last one.
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

  normals_.reserve(scene_.triangles.size());
  for (const Eigen::Vector3i& t : scene_.triangles) {
    const Eigen::Vector3f edge1 = scene_.vertices_m[t[1]] - scene_.vertices_m[t[0]];
    const Eigen::Vector3f edge2 = scene_.vertices_m[t[2]] - scene_.vertices_m[t[0]];
    normals_.push_back(edge1.cast<double>().cross(edge2.cast<double>()).normalized().cast<float>());
  }
}

RayCaster::~RayCaster() = default;

std::int64_t RayCaster::rays_cast() const {
  return embree_->rays_cast.load();
}

// Rays of one row, in packets. `met(first, count, packet)` follows each packet.
template <typename Met>
void RayCaster::CastRow(const RayFan& fan, int row, const Eigen::Matrix3f& rotation,
                        const Eigen::Vector3f& origin, float max_range_m, RowBuffers& buffers,
                        Met&& met) const {
  const auto padded = static_cast<std::size_t>(fan.cols() + kPacket);
  for (std::vector<float>& component : buffers.direction) component.resize(padded, 0.0F);
  fan.RowDirections(row, rotation, buffers.direction[0].data(), buffers.direction[1].data(),
                    buffers.direction[2].data());
  embree::Query query(true);
  alignas(64) RTCRayHit16 packet = {};
  alignas(64) int valid[kPacket];
  std::fill_n(packet.ray.org_x, kPacket, origin.x());
  std::fill_n(packet.ray.org_y, kPacket, origin.y());
  std::fill_n(packet.ray.org_z, kPacket, origin.z());
  std::fill_n(packet.ray.mask, kPacket, ~0U);
  for (int first = 0; first < fan.cols(); first += kPacket) {
    const int count = std::min(kPacket, fan.cols() - first);
    for (int i = 0; i < kPacket; ++i) valid[i] = i < count ? -1 : 0;
    std::copy_n(&buffers.direction[0][first], kPacket, packet.ray.dir_x);
    std::copy_n(&buffers.direction[1][first], kPacket, packet.ray.dir_y);
    std::copy_n(&buffers.direction[2][first], kPacket, packet.ray.dir_z);
    std::fill_n(packet.ray.tfar, kPacket, max_range_m);
    std::fill_n(packet.hit.geomID, kPacket, RTC_INVALID_GEOMETRY_ID);
    std::fill_n(packet.hit.instID[0], kPacket, RTC_INVALID_GEOMETRY_ID);
    query.Intersect16(valid, embree_->scene, &packet);
    met(first, count, packet);
  }
}

FanHits RayCaster::Cast(const RayFan& fan, const Pose& world_from_sonar, double max_range_m) const {
  FanHits hits;
  hits.range_m.assign(fan.size(), std::numeric_limits<float>::infinity());
  hits.triangle.assign(fan.size(), -1);
  const Eigen::Matrix3f rotation = world_from_sonar.rotation.toRotationMatrix().cast<float>();
  const Eigen::Vector3f origin = world_from_sonar.position_m.cast<float>();
  tbb::parallel_for(tbb::blocked_range<int>(0, fan.rows(), 4), [&](const tbb::blocked_range<int>& rows) {
    const embree::FlushDenormals flush;
    RowBuffers buffers;
    for (int row = rows.begin(); row != rows.end(); ++row) {
      CastRow(fan, row, rotation, origin, static_cast<float>(max_range_m), buffers,
              [&](int first, int count, const RTCRayHit16& packet) {
                const std::size_t offset = static_cast<std::size_t>(row) * fan.cols() + first;
                for (int i = 0; i < count; ++i) {
                  if (packet.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
                  hits.range_m[offset + i] = packet.ray.tfar[i];
                  hits.triangle[offset + i] = static_cast<std::int32_t>(packet.hit.primID[i]);
                }
              });
    }
  });
  embree_->rays_cast += fan.size();
  return hits;
}

void RayCaster::CastRows(const RayFan& fan, const Pose& world_from_sonar, double max_range_m,
                         const std::function<void(const RowHits&)>& take) const {
  const Eigen::Matrix3f rotation = world_from_sonar.rotation.toRotationMatrix().cast<float>();
  const Eigen::Vector3f origin = world_from_sonar.position_m.cast<float>();
  tbb::parallel_for(tbb::blocked_range<int>(0, fan.rows(), 4), [&](const tbb::blocked_range<int>& rows) {
    const embree::FlushDenormals flush;
    RowBuffers buffers;
    HitsOfRow hits(fan.cols());
    for (int row = rows.begin(); row != rows.end(); ++row) {
      hits.Clear();
      CastRow(fan, row, rotation, origin, static_cast<float>(max_range_m), buffers,
              [&](int first, int count, const RTCRayHit16& packet) {
                hits.Add(first, count, packet, scene_.triangle_material);
              });
      take(hits.Of(row));
    }
  });
  embree_->rays_cast += fan.size();
}

}  // namespace sonarcal
