#!/usr/bin/env bash
# How fast: prints a frame beside Embree alone, a fit beside tracing, and how both grow with threads, rays and
# triangles. Ratios are of times measured in turn in one run. Takes some minutes; needs libbenchmark-dev.
#
#   scripts/benchmark.sh [FILTER]     FILTER: which benchmarks, a regular expression (default: all)

# shellcheck source=scripts/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

case "${1:-}" in
  -h | --help)
    sed -n '2,5s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"
    exit 0
    ;;
  -*) fail "unknown argument '$1', expected a regular expression" ;;
esac

"$root/scripts/setup.sh" --no-build
quietly "Configuring" cmake -S "$root" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release \
  -DSONARCAL_BUILD_BENCHMARKS=ON || fail "cmake failed: is libbenchmark-dev installed?"
quietly "Building" cmake --build "$build" --target sonarcal_benchmarks || fail "the build failed"
"$build/tests/benchmarks/sonarcal_benchmarks" --benchmark_counters_tabular=true \
  --benchmark_filter="${1:-.}"
