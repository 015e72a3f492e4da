// Memory of images kept from frame to frame. Images of one size are made and freed for every frame. Memory
// that goes back to the system each time, to be cleared when it comes again, took a fifth of the processor
// time of simulating a long recording.
//
// All threads share one pool. With a pool each, memory that one thread frees does not serve the other:
// `calibrate` of large frames held 2.8 GB with two pools and 2.2 GB with one, and took no less time.
#pragma once

#include <cstdlib>  // defines __GLIBC__

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace sonarcal::workflow {

// For programs, not for a library: it changes how the whole process allocates. Does nothing without glibc.
inline void KeepFreedMemory() {
#ifdef __GLIBC__
  constexpr int kMiB = 1 << 20;
  mallopt(M_MMAP_THRESHOLD, 256 * kMiB);
  mallopt(M_TRIM_THRESHOLD, 512 * kMiB);
  mallopt(M_ARENA_MAX, 1);
#endif
}

// Gives large blocks back at once. For commands whose large blocks have all sizes, so that the gaps between
// kept ones are of little use: a calibration with 1.2 GB in use held 2.5 GB, and holds 1.4 GB this way in the
// same processor time.
inline void ReturnLargeBlocks() {
#ifdef __GLIBC__
  constexpr int kMiB = 1 << 20;
  mallopt(M_MMAP_THRESHOLD, 16 * kMiB);
#endif
}

}  // namespace sonarcal::workflow
