// Queries of Embree 3 or 4, whichever is installed. Only this file handles their difference: version 3 takes
// the coherence flag in a context, version 4 in an arguments structure. Include this file in sources only, so
// that no other header depends on Embree.
#pragma once

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#if defined(__x86_64__)
#include <pmmintrin.h>
#elif defined(__aarch64__)
#include <cstdint>
#endif

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

// Sets flush-to-zero, as Embree recommends. Restores the thread's mode at the end of the scope. Has an effect
// on x86-64 and on 64-bit ARM.
class FlushDenormals {
 public:
#if defined(__x86_64__)
  FlushDenormals() : saved_(_mm_getcsr()) {
    _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
    _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
  }
  ~FlushDenormals() {
    _mm_setcsr(saved_);
  }
#elif defined(__aarch64__)
  FlushDenormals() {
    constexpr std::uint64_t kFlushToZero = 1U << 24;  // the bit FZ: operands and results
    __asm__ volatile("mrs %0, fpcr" : "=r"(saved_));
    __asm__ volatile("msr fpcr, %0" : : "r"(saved_ | kFlushToZero) : "memory");
  }
  ~FlushDenormals() {
    __asm__ volatile("msr fpcr, %0" : : "r"(saved_) : "memory");
  }
#else
  FlushDenormals() {}
#endif
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;

#if defined(__x86_64__)
 private:
  unsigned saved_;
#elif defined(__aarch64__)
 private:
  std::uint64_t saved_;
#endif
};

}  // namespace sonarcal::sim::embree
