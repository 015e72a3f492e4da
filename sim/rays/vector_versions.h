// A function marked so is compiled twice, for any processor and for those with AVX2 and FMA; which of them
// runs is chosen when the program starts.
#pragma once

// A resolver of versions runs before a sanitizer is ready.
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && !defined(__SANITIZE_ADDRESS__)
#define SONARCAL_VECTOR_VERSIONS __attribute__((target_clones("arch=x86-64-v3", "default")))
#else
#define SONARCAL_VECTOR_VERSIONS
#endif
