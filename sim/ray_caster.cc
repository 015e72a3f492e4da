#include "sim/ray_caster.h"

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <pmmintrin.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <limits>
#include <stdexcept>

#include "data_io/types/error.h"

namespace sonarcal {
namespace {

constexpr int kPacket = 16;

// Embree is built for flush-to-zero; restores the thread's mode at the end of its scope.
class FlushDenormals {
 public:
  FlushDenormals() : saved_(_mm_getcsr()) {
    _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
    _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
  }
  ~FlushDenormals() { _mm_setcsr(saved_); }
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;

 private:
  unsigned saved_;
};

// Embree 3 takes the coherence flag in a context, Embree 4 in an arguments structure.
void IntersectPacket(const int* valid, RTCScene scene, RTCRayHit16* packet) {
#if RTC_VERSION_MAJOR >= 4
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
  rtcIntersect16(valid, scene, packet, &arguments);
#else
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcIntersect16(valid, scene, &context, packet);
#endif
}

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

RayCaster::RayCaster(const Scene& scene)
    : embree_(std::make_unique<Embree>()),
      materials_(scene.triangle_material),
      material_names_(scene.material_names) {
  scene.Validate("scene");
  embree_->device = rtcNewDevice(nullptr);
  if (embree_->device == nullptr) {
    throw std::runtime_error(fmt::format("the ray tracer did not start (Embree error {})",
                                         static_cast<int>(rtcGetDeviceError(nullptr))));
  }
  embree_->scene = rtcNewScene(embree_->device);
  // Watertight edges: a ray between two triangles must not fall through the tank's floor.
  rtcSetSceneFlags(embree_->scene, RTC_SCENE_FLAG_ROBUST);

  RTCGeometry geometry = rtcNewGeometry(embree_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), scene.vertices_m.size()));
  auto* indices = static_cast<std::uint32_t*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t),
                              scene.triangles.size()));
  if (vertices == nullptr || indices == nullptr) {
    rtcReleaseGeometry(geometry);
    throw std::runtime_error(
        fmt::format("the ray tracer could not hold a scene of {} triangles", scene.triangles.size()));
  }
  std::memcpy(vertices, scene.vertices_m.data(), scene.vertices_m.size() * sizeof(Eigen::Vector3f));
  std::memcpy(indices, scene.triangles.data(), scene.triangles.size() * sizeof(Eigen::Vector3i));
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(embree_->scene, geometry, 0);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(embree_->scene);
  if (const RTCError error = rtcGetDeviceError(embree_->device); error != RTC_ERROR_NONE) {
    throw std::runtime_error(fmt::format("the ray tracer could not build its structure (Embree error {})",
                                         static_cast<int>(error)));
  }

  normals_.reserve(scene.triangles.size());
  for (const Eigen::Vector3i& t : scene.triangles) {
    const Eigen::Vector3f edge1 = scene.vertices_m[t[1]] - scene.vertices_m[t[0]];
    const Eigen::Vector3f edge2 = scene.vertices_m[t[2]] - scene.vertices_m[t[0]];
    normals_.push_back(edge1.cast<double>().cross(edge2.cast<double>()).normalized().cast<float>());
  }
}

RayCaster::~RayCaster() = default;

std::int64_t RayCaster::rays_cast() const {
  return embree_->rays_cast.load();
}

FanHits RayCaster::Cast(const RayFan& fan, const Pose& world_from_sonar, double max_range_m) const {
  FanHits hits;
  hits.range_m.assign(fan.size(), std::numeric_limits<float>::infinity());
  hits.triangle.assign(fan.size(), -1);
  const Eigen::Matrix3f rotation = world_from_sonar.rotation.toRotationMatrix().cast<float>();
  const Eigen::Vector3f origin = world_from_sonar.position_m.cast<float>();

  tbb::parallel_for(tbb::blocked_range<int>(0, fan.rows(), 4), [&](const tbb::blocked_range<int>& rows) {
    const FlushDenormals flush;
    alignas(64) RTCRayHit16 packet;
    alignas(64) int valid[kPacket];
    for (int row = rows.begin(); row != rows.end(); ++row) {
      for (int first = 0; first < fan.cols(); first += kPacket) {
        const int count = std::min(kPacket, fan.cols() - first);
        for (int i = 0; i < kPacket; ++i) {
          valid[i] = i < count ? -1 : 0;
          const Eigen::Vector3f direction = rotation * fan.Direction(row, first + std::min(i, count - 1));
          packet.ray.org_x[i] = origin.x();
          packet.ray.org_y[i] = origin.y();
          packet.ray.org_z[i] = origin.z();
          packet.ray.dir_x[i] = direction.x();
          packet.ray.dir_y[i] = direction.y();
          packet.ray.dir_z[i] = direction.z();
          packet.ray.tnear[i] = 0.0F;
          packet.ray.tfar[i] = static_cast<float>(max_range_m);
          packet.ray.time[i] = 0.0F;
          packet.ray.mask[i] = ~0U;
          packet.ray.id[i] = 0;
          packet.ray.flags[i] = 0;
          packet.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
          packet.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
        }
        IntersectPacket(valid, embree_->scene, &packet);
        const std::size_t offset = static_cast<std::size_t>(row) * fan.cols() + first;
        for (int i = 0; i < count; ++i) {
          if (packet.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
          hits.range_m[offset + i] = packet.ray.tfar[i];
          hits.triangle[offset + i] = static_cast<std::int32_t>(packet.hit.primID[i]);
        }
      }
    }
  });
  embree_->rays_cast += fan.size();
  return hits;
}

}  // namespace sonarcal
