// Embree and nothing else: what a frame's time is held against.
#pragma once

#include <benchmark/benchmark.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "sim/rays/embree_queries.h"
#include "sim/simulator.h"
#include "tests/benchmarks/benchmark_world.h"

namespace sonarcal::benchmarks {

// Embree's configuration in the simulator (sim/rays/ray_caster.cc).
inline constexpr const char* kSimulatorKernels = "max_isa=avx2";

// In which order the rays of a fan are handed to Embree, sixteen after sixteen.
enum class RayOrder { kRows, kTiles };  // along its rows; tiles of four rows by four columns

// A tree of the scene, and the rays of a fan laid out beforehand as each query takes
// them. Only hits are waited for, nothing is made of them.
class EmbreeAlone {
 public:
  // `scene`: not empty. `kernels`: Embree's configuration; null: the processor's own kernels.
  EmbreeAlone(const Scene& scene, const sim::RayFan& fan, const Pose& pose, double max_range_m,
              const char* kernels = nullptr)
      : origin_(pose.position_m.cast<float>()), max_range_m_(static_cast<float>(max_range_m)) {
    device_ = rtcNewDevice(kernels);
    scene_ = rtcNewScene(device_);
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    std::memcpy(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12,
                                        scene.vertices_m.size()),
                scene.vertices_m.at(0).data(), 12 * scene.vertices_m.size());
    std::memcpy(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12,
                                        scene.triangles.size()),
                scene.triangles.at(0).data(), 12 * scene.triangles.size());
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
    const Eigen::Matrix3f rotation = pose.rotation.toRotationMatrix().cast<float>();
    in_rows_ = InOrder(fan, rotation, 1, fan.cols());
    in_tiles_ = InOrder(fan, rotation, 4, 4);
  }
  ~EmbreeAlone() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  EmbreeAlone(const EmbreeAlone&) = delete;
  EmbreeAlone& operator=(const EmbreeAlone&) = delete;

  // Seconds for all rays, by a query of this many rays at a time: 1, 4, 8 or 16.
  double Seconds(RayOrder order, int width, bool coherent) const {
    const std::vector<Eigen::Vector3f>& directions = order == RayOrder::kRows ? in_rows_ : in_tiles_;
    const double began = Now();
    const std::size_t groups = directions.size() / 16;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, groups, 64), [&](const auto& range) {
      const sim::embree::FlushDenormals flush;
      sim::embree::Query query(coherent);
      for (std::size_t group = range.begin(); group != range.end(); ++group) {
        const Eigen::Vector3f* of = &directions[16 * group];
        if (width == 1) {
          for (int i = 0; i < 16; ++i) {
            RTCRayHit ray = {};
            ray.ray = {.org_x = origin_.x(),
                       .org_y = origin_.y(),
                       .org_z = origin_.z(),
                       .tnear = 0.0F,
                       .dir_x = of[i].x(),
                       .dir_y = of[i].y(),
                       .dir_z = of[i].z(),
                       .time = 0.0F,
                       .tfar = max_range_m_,
                       .mask = ~0U,
                       .id = 0,
                       .flags = 0};
            ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
            query.Intersect1(scene_, &ray);
            benchmark::DoNotOptimize(ray.ray.tfar);
          }
        } else if (width == 4) {
          Packets<RTCRayHit4, 4>(
              of, [&](const int* valid, RTCRayHit4* rays) { query.Intersect4(valid, scene_, rays); });
        } else if (width == 8) {
          Packets<RTCRayHit8, 8>(
              of, [&](const int* valid, RTCRayHit8* rays) { query.Intersect8(valid, scene_, rays); });
        } else {
          Packets<RTCRayHit16, 16>(
              of, [&](const int* valid, RTCRayHit16* rays) { query.Intersect16(valid, scene_, rays); });
        }
      }
    });
    return Now() - began;
  }

 private:
  static std::vector<Eigen::Vector3f> InOrder(const sim::RayFan& fan, const Eigen::Matrix3f& rotation,
                                              int rows, int cols) {
    std::vector<Eigen::Vector3f> directions;
    for (int row = 0; row < fan.rows(); row += rows) {
      for (int col = 0; col < fan.cols(); col += cols) {
        for (int r = row; r < std::min(row + rows, fan.rows()); ++r) {
          for (int c = col; c < std::min(col + cols, fan.cols()); ++c)
            directions.emplace_back(rotation * fan.Direction(r, c));
        }
      }
    }
    while (directions.size() % 16 != 0) directions.push_back(directions.back());
    return directions;
  }

  template <typename Packet, int kWidth, typename Intersect>
  void Packets(const Eigen::Vector3f* of, Intersect&& intersect) const {
    alignas(64) int valid[kWidth];
    std::fill_n(valid, kWidth, -1);
    for (int first = 0; first < 16; first += kWidth) {
      alignas(64) Packet rays;
      for (int i = 0; i < kWidth; ++i) {
        rays.ray.org_x[i] = origin_.x();
        rays.ray.org_y[i] = origin_.y();
        rays.ray.org_z[i] = origin_.z();
        rays.ray.dir_x[i] = of[first + i].x();
        rays.ray.dir_y[i] = of[first + i].y();
        rays.ray.dir_z[i] = of[first + i].z();
        rays.ray.tnear[i] = 0.0F;
        rays.ray.tfar[i] = max_range_m_;
        rays.ray.time[i] = 0.0F;
        rays.ray.mask[i] = ~0U;
        rays.ray.id[i] = 0;
        rays.ray.flags[i] = 0;
        rays.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
        rays.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
      }
      intersect(valid, &rays);
      benchmark::DoNotOptimize(rays.ray.tfar[0]);
    }
  }

  RTCDevice device_ = nullptr;
  RTCScene scene_ = nullptr;
  Eigen::Vector3f origin_;
  float max_range_m_;
  std::vector<Eigen::Vector3f> in_rows_;
  std::vector<Eigen::Vector3f> in_tiles_;
};

// Times of each of Embree's queries, taken in turn with something else's.
class FastestQuery {
 public:
  explicit FastestQuery(RayOrder order) : order_(order) {}

  void Measure(const EmbreeAlone& embree) {
    for (const int width : {1, 4, 8, 16}) {
      for (const bool coherent : {false, true}) {
        seconds_[std::to_string(width) + (coherent ? "c" : "")].push_back(
            embree.Seconds(order_, width, coherent));
      }
    }
  }

  // The one with the least median: its name, and that median.
  std::pair<std::string, double> Best() const {
    std::pair<std::string, double> best{"", std::numeric_limits<double>::infinity()};
    for (const auto& [name, seconds] : seconds_) {
      if (Median(seconds) < best.second) best = {name, Median(seconds)};
    }
    return best;
  }

 private:
  RayOrder order_;
  std::map<std::string, std::vector<double>> seconds_;
};

}  // namespace sonarcal::benchmarks
