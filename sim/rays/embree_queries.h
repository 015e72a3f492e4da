// Queries of Embree 3 or 4, whichever is installed. Only this file handles their difference: version 3 takes
// the coherence flag in a context, version 4 in an arguments structure. Include this file in sources only, so
// that no other header depends on Embree.
#pragma once

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <pmmintrin.h>

namespace sonarcal::sim::embree {

#if RTC_VERSION_MAJOR >= 4
class Query {
 public:
  explicit Query(bool coherent) {
    rtcInitIntersectArguments(&arguments_);
    arguments_.flags = coherent ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT;
  }
  void Intersect1(RTCScene scene, RTCRayHit* ray) { rtcIntersect1(scene, ray, &arguments_); }
  void Intersect4(const int* valid, RTCScene scene, RTCRayHit4* rays) {
    rtcIntersect4(valid, scene, rays, &arguments_);
  }
  void Intersect8(const int* valid, RTCScene scene, RTCRayHit8* rays) {
    rtcIntersect8(valid, scene, rays, &arguments_);
  }
  void Intersect16(const int* valid, RTCScene scene, RTCRayHit16* rays) {
    rtcIntersect16(valid, scene, rays, &arguments_);
  }
  void Occluded8(const int* valid, RTCScene scene, RTCRay8* rays) {
    RTCOccludedArguments arguments;
    rtcInitOccludedArguments(&arguments);
    arguments.flags = arguments_.flags;
    rtcOccluded8(valid, scene, rays, &arguments);
  }

 private:
  RTCIntersectArguments arguments_;
};
#else
class Query {
 public:
  explicit Query(bool coherent) {
    rtcInitIntersectContext(&context_);
    context_.flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  }
  void Intersect1(RTCScene scene, RTCRayHit* ray) { rtcIntersect1(scene, &context_, ray); }
  void Intersect4(const int* valid, RTCScene scene, RTCRayHit4* rays) {
    rtcIntersect4(valid, scene, &context_, rays);
  }
  void Intersect8(const int* valid, RTCScene scene, RTCRayHit8* rays) {
    rtcIntersect8(valid, scene, &context_, rays);
  }
  void Intersect16(const int* valid, RTCScene scene, RTCRayHit16* rays) {
    rtcIntersect16(valid, scene, &context_, rays);
  }
  void Occluded8(const int* valid, RTCScene scene, RTCRay8* rays) {
    rtcOccluded8(valid, scene, &context_, rays);
  }

 private:
  RTCIntersectContext context_;
};
#endif

// Sets flush-to-zero, as Embree recommends. Restores the thread's mode at the end of the scope.
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

}  // namespace sonarcal::sim::embree
