#!/usr/bin/env bash
# Looks for inputs that break a parser, with clang and libFuzzer, under AddressSanitizer and UBSan.
#
#   scripts/fuzz.sh [SECONDS] [TARGET ...]     SECONDS a target, 60 if not given; all targets
#
# Inputs it makes up stay in build-fuzz/found/<target>, to go on from; one that breaks something is kept in
# build-fuzz/broken/<target>-*, and its path is printed.

# shellcheck source=scripts/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

seconds=60
case "${1:-}" in
  -h | --help)
    sed -n '2,7s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"
    exit 0
    ;;
  [0-9]*)
    seconds=$1
    shift
    ;;
esac
command -v clang++ >/dev/null || fail "there is no clang++: install clang (Debian's, with its compiler-rt)"
(cd "$root" && quietly "Configuring build-fuzz/" cmake --preset fuzz) || fail "cmake cannot configure build-fuzz/"
say "Building the targets ..."
cmake --build "$root/build-fuzz" --target fuzzers >&2 || fail "the build failed, its errors are above"

targets=("$@")
if ((${#targets[@]} == 0)); then
  for folder in "$root"/tests/fuzz/corpus/*/; do targets+=("$(basename "$folder")"); done
fi
mkdir -p "$root/build-fuzz/broken"
bad=()
for target in "${targets[@]}"; do
  program="$root/build-fuzz/tests/fuzz/fuzz_$target"
  [[ -x "$program" ]] || fail "there is no target '$target', expected a folder of tests/fuzz/corpus"
  mkdir -p "$root/build-fuzz/found/$target"
  say "$target, $seconds s"
  "$program" "$root/build-fuzz/found/$target" "$root/tests/fuzz/corpus/$target" -max_total_time="$seconds" \
    -timeout=10 -rss_limit_mb=2048 -malloc_limit_mb=1024 -max_len=65536 -print_final_stats=1 \
    -artifact_prefix="$root/build-fuzz/broken/$target-" >&2 || bad+=("$target")
done
((${#bad[@]} == 0)) || fail "broken: ${bad[*]} (inputs in build-fuzz/broken)"
say "${#targets[@]} targets, $seconds s each: nothing broke."
