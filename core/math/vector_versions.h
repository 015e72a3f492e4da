// SONARCAL_VECTOR_VERSIONS compiles a function twice: for any processor, and for processors with AVX2 and
// FMA. The program selects a version at start. Infinities and NaN keep their meaning in both.
#pragma once

// The version resolver runs before a sanitizer is initialised.
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define SONARCAL_VECTOR_VERSIONS __attribute__((target_clones("arch=x86-64-v3", "default")))
#else
#define SONARCAL_VECTOR_VERSIONS
#endif
