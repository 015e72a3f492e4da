// Memory of images kept from frame to frame. Images of one size are made and freed for every frame. Memory
// that goes back to the system each time, to be cleared when it comes again, took a fifth of the processor
// time of simulating a long recording.
//
// All threads share one pool. With a pool each, memory that one thread frees does not serve the other:
// `calibrate` of large frames held 2.8 GB with two pools and 2.2 GB with one, and took no less time (measured
// before ReturnLargeBlocks existed).
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

// Returns large blocks to the system as soon as they are freed. For commands that allocate large blocks of
// many sizes: the gaps between them can seldom be used again (docs/benchmarks.md has figures).
inline void ReturnLargeBlocks() {
#ifdef __GLIBC__
  constexpr int kMiB = 1 << 20;
  mallopt(M_MMAP_THRESHOLD, 16 * kMiB);
#endif
}

}  // namespace sonarcal::workflow
