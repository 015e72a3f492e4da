#!/usr/bin/env bash
# How fast: prints a frame beside Embree alone, what 10^7 triangles take beyond their mesh, a fit beside tracing,
# how frames grow with threads, rays and triangles, how the time to read a file grows with its entries, and the same
# frame in plain NumPy. Ratios are of times measured in turn in one run and stand beside their limits. Takes some
# minutes; needs libbenchmark-dev and python3-numpy.
#
#   scripts/benchmark.sh [FILTER]     FILTER: which benchmarks, a regular expression (default: all; NumPyFrame is one)

# shellcheck source=scripts/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

case "${1:-}" in
  -h | --help)
    sed -n '2,7s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"
    exit 0
    ;;
  -*) fail "unknown argument '$1', expected a regular expression" ;;
esac

"$root/scripts/setup.sh" --no-build
options=(-DCMAKE_BUILD_TYPE=Release -DSONARCAL_BUILD_BENCHMARKS=ON)
# A new build is without tests, because the packages that they need may be missing.
if [[ ! -f "$build/CMakeCache.txt" ]]; then options+=(-DSONARCAL_BUILD_TESTS=OFF); fi
quietly "Configuring" cmake -S "$root" -B "$build" -G Ninja "${options[@]}" ||
  fail "cmake failed: is libbenchmark-dev installed?"
quietly "Building" cmake --build "$build" --target sonarcal_benchmarks sonarcal_frame_hits || fail "the build failed"
if ! "$build/tests/benchmarks/sonarcal_benchmarks" --benchmark_list_tests=true --benchmark_filter="${1:-.}" |
  grep -q "^Failed to match"; then
  "$build/tests/benchmarks/sonarcal_benchmarks" --benchmark_counters_tabular=true --benchmark_filter="${1:-.}"
fi

grep -qE "${1:-.}" <<<NumPyFrame || exit 0
# Not any python3: Debian's has NumPy from its package.
/usr/bin/python3 -c "import numpy" 2>/dev/null || fail "no NumPy for /usr/bin/python3: is python3-numpy installed?"
hits="$(mktemp -d "${TMPDIR:-/tmp}/sonarcal-hits-XXXXXX")"
trap 'rm -rf "$hits"' EXIT
say "Writing the hits of a frame ..."
"$build/tests/benchmarks/sonarcal_frame_hits" "$hits"
/usr/bin/python3 "$root/tests/benchmarks/numpy_frame.py" "$hits"
