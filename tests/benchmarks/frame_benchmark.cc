// A whole frame of the paper's model beside Embree alone, tracing exactly the same rays with whichever of its
// queries is fastest, in the same run and in turn: 1500 x 1200 rays, errors of range and azimuth sampled,
// polar and fan image.
#include <benchmark/benchmark.h>
#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <functional>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "data_io/fan_image.h"
#include "sim/embree_queries.h"
#include "sim/paper_fan.h"
#include "sim/scenes.h"
#include "sim/simulator.h"
#include "sim/sonar_presets.h"

namespace sonarcal {
namespace {

double Now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// Embree and nothing else: a tree of the scene, and the rays of a fan laid out beforehand as each query takes
// them. Only hits are waited for, nothing is made of them.
class EmbreeAlone {
 public:
  EmbreeAlone(const Scene& scene, const RayFan& fan, const Pose& pose, double max_range_m)
      : origin_(pose.position_m.cast<float>()), max_range_m_(static_cast<float>(max_range_m)) {
    device_ = rtcNewDevice(nullptr);
    scene_ = rtcNewScene(device_);
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    std::memcpy(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12,
                                        scene.vertices_m.size()),
                scene.vertices_m.data(), 12 * scene.vertices_m.size());
    std::memcpy(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12,
                                        scene.triangles.size()),
                scene.triangles.data(), 12 * scene.triangles.size());
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
    const Eigen::Matrix3f rotation = pose.rotation.toRotationMatrix().cast<float>();
    for (int row = 0; row < fan.rows(); ++row) {
      for (int col = 0; col < fan.cols(); ++col) directions_.push_back(rotation * fan.Direction(row, col));
    }
    while (directions_.size() % 16 != 0) directions_.push_back(directions_.back());
  }
  ~EmbreeAlone() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  EmbreeAlone(const EmbreeAlone&) = delete;
  EmbreeAlone& operator=(const EmbreeAlone&) = delete;

  // Seconds for all rays, by a query of this many rays at a time: 1, 4, 8 or 16.
  double Seconds(int width, bool coherent) const {
    const double began = Now();
    const std::size_t groups = directions_.size() / 16;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, groups, 64), [&](const auto& range) {
      const embree::FlushDenormals flush;
      embree::Query query(coherent);
      for (std::size_t group = range.begin(); group != range.end(); ++group) {
        const Eigen::Vector3f* of = &directions_[16 * group];
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
  std::vector<Eigen::Vector3f> directions_;
};

double Median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

// The paper's tank, its mock-ups of this many triangles each.
Scene Tank(int triangles) {
  PaperTankOptions options = PaperTankOfPaper(PaperSize::kTable5);
  options.mockup = RefinedTo(options.mockup, triangles);
  return MakePaperTank(options);
}

ParameterSet Parameters() {
  ParameterSet parameters;
  parameters.display = {.db_min = 150.0, .db_max = 153.0};
  parameters.materials["default"];
  parameters.jitter = {.sigma_range_m = 0.0127, .sigma_azimuth_deg = 0.5};
  return parameters;
}

SimulationOptions Options(const SonarPreset& preset, const RayFanOptions& fan) {
  SimulationOptions options;
  options.fan = fan;
  options.water = preset.water;
  options.noise = true;
  return options;
}

constexpr RayFanOptions kPaperRays = {.sampling = Sampling::kFrustum, .cols = 1500, .rows = 1200};

void FrameBesideEmbree(benchmark::State& state, const Scene& scene, const Pose& pose, RayFanOptions rays) {
  constexpr int kRounds = 15;
  const SonarPreset& preset = FindSonarPreset("p900-45");
  const Simulator simulator(scene, preset.sonar, Options(preset, rays));
  const ParameterSet parameters = Parameters();
  const FanMap map(preset.sonar.axes, FanAxesFor(preset.sonar.axes, {}));
  const EmbreeAlone embree(scene, simulator.fan(), pose, preset.sonar.axes.range_max_m);
  for (auto unused : state) {
    std::map<std::string, std::vector<double>> alone;
    std::vector<double> frame;
    for (int round = 0; round < kRounds; ++round) {
      for (const int width : {1, 4, 8, 16}) {
        for (const bool coherent : {false, true}) {
          alone[std::to_string(width) + (coherent ? "c" : "")].push_back(embree.Seconds(width, coherent));
        }
      }
      const double began = Now();
      const PolarImage image = simulator.Render(pose, parameters, round);
      const FanImage fan = map.Apply(image);
      benchmark::DoNotOptimize(fan.value.values().data());
      frame.push_back(Now() - began);
    }
    double fastest = std::numeric_limits<double>::infinity();
    for (const auto& [name, seconds] : alone) {
      if (Median(seconds) < fastest) {
        fastest = Median(seconds);
        state.SetLabel("Embree query of " + name + " rays");
      }
    }
    state.counters["triangles"] = static_cast<double>(scene.triangles.size());
    state.counters["frame_ms"] = 1e3 * Median(frame);
    state.counters["embree_ms"] = 1e3 * fastest;
    state.counters["frame_over_embree"] = Median(frame) / fastest;
    state.counters["Mrays_per_s"] = 1e-6 * simulator.fan().size() / Median(frame);
  }
}

void TankFrame(benchmark::State& state) {
  FrameBesideEmbree(state, Tank(300'000), PaperTankPoses(3).front(), kPaperRays);
}
BENCHMARK(TankFrame)->Iterations(1)->Unit(benchmark::kMillisecond);

// One thread against two, and rays and triangles by factors.
double FrameSeconds(const Simulator& simulator, const Pose& pose) {
  constexpr int kRounds = 9;
  const ParameterSet parameters = Parameters();
  std::vector<double> seconds;
  for (int round = 0; round < kRounds; ++round) {
    const double began = Now();
    const PolarImage image = simulator.Render(pose, parameters, round);
    benchmark::DoNotOptimize(image.value.values().data());
    seconds.push_back(Now() - began);
  }
  return Median(seconds);
}

void TwoThreads(benchmark::State& state) {
  const SonarPreset& preset = FindSonarPreset("p900-45");
  const Simulator simulator(Tank(300'000), preset.sonar, Options(preset, kPaperRays));
  const Pose pose = PaperTankPoses(3).front();
  for (auto unused : state) {
    const auto with = [&](int threads) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                      static_cast<std::size_t>(threads));
      return FrameSeconds(simulator, pose);
    };
    const double one = with(1);
    const double two = with(2);
    state.counters["one_ms"] = 1e3 * one;
    state.counters["two_ms"] = 1e3 * two;
    state.counters["speed_up"] = one / two;
  }
}
BENCHMARK(TwoThreads)->Iterations(1)->Unit(benchmark::kMillisecond);

// The rays that `beams` get by default beside the paper's, in turn.
void DefaultSampling(benchmark::State& state) {
  const SonarPreset& preset = FindSonarPreset("p900-45");
  const Simulator papers(Tank(300'000), preset.sonar, Options(preset, kPaperRays));
  const Simulator by_default(Tank(300'000), preset.sonar, Options(preset, PaperFanOptions(preset.sonar)));
  const Pose pose = PaperTankPoses(3).front();
  for (auto unused : state) {
    std::vector<double> ratio;
    std::vector<double> seconds;
    for (int round = 0; round < 5; ++round) {
      seconds.push_back(FrameSeconds(by_default, pose));
      ratio.push_back(seconds.back() / FrameSeconds(papers, pose));
    }
    state.counters["rays"] = by_default.fan().size();
    state.counters["frame_ms"] = 1e3 * Median(seconds);
    state.counters["frame_over_1500x1200"] = Median(ratio);
  }
}
BENCHMARK(DefaultSampling)->Iterations(1)->Unit(benchmark::kMillisecond);

void Rays(benchmark::State& state) {
  const SonarPreset& preset = FindSonarPreset("p900-45");
  RayFanOptions rays = kPaperRays;
  rays.cols = static_cast<int>(state.range(0));
  rays.rows = static_cast<int>(state.range(0)) * 4 / 5;
  const Simulator simulator(Tank(300'000), preset.sonar, Options(preset, rays));
  for (auto unused : state) {
    const double seconds = FrameSeconds(simulator, PaperTankPoses(3).front());
    state.counters["frame_ms"] = 1e3 * seconds;
    state.counters["ns_per_ray"] = 1e9 * seconds / simulator.fan().size();
  }
}
BENCHMARK(Rays)->Arg(375)->Arg(750)->Arg(1500)->Arg(3000)->Iterations(1)->Unit(benchmark::kMillisecond);

void Triangles(benchmark::State& state) {
  const SonarPreset& preset = FindSonarPreset("p900-45");
  const Scene scene = Tank(static_cast<int>(state.range(0)) / 2);
  const Simulator simulator(scene, preset.sonar, Options(preset, kPaperRays));
  for (auto unused : state) {
    state.counters["frame_ms"] = 1e3 * FrameSeconds(simulator, PaperTankPoses(3).front());
    state.counters["triangles"] = static_cast<double>(scene.triangles.size());
  }
}
BENCHMARK(Triangles)
    ->RangeMultiplier(10)
    ->Range(10'000, 10'000'000)
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace sonarcal
