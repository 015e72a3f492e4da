#!/usr/bin/env bash
# Looks for inputs that break a parser, with clang and libFuzzer, under AddressSanitizer and UBSan.
#
#   scripts/fuzz.sh [--plain] [SECONDS] [TARGET ...]   SECONDS a target, 60 if not given; all targets
#   scripts/fuzz.sh [--plain] --runs N [TARGET ...]    until each target has run N inputs, those of earlier calls included
#   scripts/fuzz.sh --table [TARGET ...]               only prints the table
#
#   --plain   without sanitizers, more than twice as many inputs in the same time: only crashes, failed assertions of the
#             standard library, wrong exceptions, hangs and too much memory are found. Then runs all kept inputs with sanitizers.
#
# Ends with a table on standard output: how many inputs each target has run, and how much of the parser they reach.
# Inputs it makes up stay in build-fuzz/found/TARGET, to go on from; one that breaks something is kept in
# build-fuzz/broken/TARGET-*, and its path is printed.

# shellcheck source=scripts/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

seconds=60
runs=
preset=fuzz
builds=(fuzz)
if [[ "${1:-}" == --plain ]]; then
  preset=fuzz-plain
  builds+=(fuzz-plain)
  shift
fi
case "${1:-}" in
  -h | --help)
    sed -n '2,13s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"
    exit 0
    ;;
  --table)
    seconds=0
    shift
    ;;
  --runs)
    runs="${2:-}"
    [[ "$runs" =~ ^[1-9][0-9]*$ ]] || fail "--runs '$runs', expected a number of inputs"
    shift 2
    ;;
  [0-9]*)
    seconds=$1
    shift
    ;;
esac
command -v clang++ >/dev/null || fail "there is no clang++: install clang (Debian's, with its compiler-rt)"
for build in "${builds[@]}"; do
  (cd "$root" && quietly "Configuring build-$build/" cmake --preset "$build") || fail "cmake cannot configure build-$build/"
  say "Building the targets in build-$build/ ..."
  cmake --build "$root/build-$build" --target fuzzers >&2 || fail "the build failed, its errors are above"
done

targets=("$@")
if ((${#targets[@]} == 0)); then
  for folder in "$root"/tests/fuzz/corpus/*/; do targets+=("$(basename "$folder")"); done
fi
mkdir -p "$root/build-fuzz/broken" "$root/build-fuzz/runs" "$root/build-$preset/runs"

# A report shows only two calls of the stack that allocated or freed memory. Inputs run about a fifth faster with that.
export ASAN_OPTIONS="${ASAN_OPTIONS:-malloc_context_size=2}"

# libfuzzer BUILD TARGET OPTION ...: goes on from all inputs of the target that are known. Without weights by the
# rarity of what an input reaches (entropic), a third more inputs run in the same time.
libfuzzer() {
  local build=$1 target=$2
  shift 2
  "$root/build-$build/tests/fuzz/fuzz_$target" "$root/build-fuzz/found/$target" "$root/tests/fuzz/corpus/$target" \
    -timeout=10 -rss_limit_mb=2048 -malloc_limit_mb=1024 -max_len=65536 -entropic=0 \
    -artifact_prefix="$root/build-fuzz/broken/$target-" "$@"
}

# runs_of TARGET BUILD ...: inputs that all calls together have run, in these builds
runs_of() {
  local target=$1 build
  shift
  for build in "$@"; do cat "$root/build-$build/runs/$target" 2>/dev/null || true; done |
    awk '{sum += $1} END {print sum + 0}'
}

# counted TARGET LIMIT: fuzzes up to a limit of libFuzzer, and adds the number of inputs to that of earlier calls
counted() {
  local target=$1 log="$root/build-$preset/runs/$1.log" status=0
  libfuzzer "$preset" "$target" "$2" -print_final_stats=1 2>&1 | tee "$log" >&2 || status=1
  awk '/^stat::number_of_executed_units/ {print $2}' "$log" >>"$root/build-$preset/runs/$target"
  return "$status"
}

# fuzz TARGET: for the given time or number of runs. Runs are done in parts: if the script is stopped, the count loses
# only the last part.
fuzz() {
  local target=$1 part=200000 left
  if [[ -z "$runs" ]]; then
    say "$target, $seconds s"
    counted "$target" -max_total_time="$seconds"
    return
  fi
  while left=$((runs - $(runs_of "$target" fuzz fuzz-plain))) && ((left > 0)); do
    say "$target, $left inputs"
    counted "$target" -runs=$((left < part ? left : part)) || return
  done
}

# rerun TARGET: runs all kept inputs once, with sanitizers
rerun() {
  say "$1, all kept inputs with sanitizers"
  libfuzzer fuzz "$1" -runs=0 >&2
}

# edges_of TARGET: edges reached and all edges of the functions of this project that the inputs enter
edges_of() {
  libfuzzer fuzz "$1" -runs=0 -print_coverage=1 2>&1 | awk -v root="$root/" '
    $1 == "COVERED_FUNC:" && index($0, root) {
      split($0, edges, "edges: ")
      split(edges[2], of, "[ /]")
      reached += of[1]
      all += of[2]
    }
    END {print reached + 0, all + 0}'
}

bad=()
for target in "${targets[@]}"; do
  [[ -x "$root/build-fuzz/tests/fuzz/fuzz_$target" ]] ||
    fail "there is no target '$target', expected a folder of tests/fuzz/corpus"
  mkdir -p "$root/build-fuzz/found/$target"
  if [[ -n "$runs" || "$seconds" != 0 ]]; then
    if ! fuzz "$target" || { [[ $preset != fuzz ]] && ! rerun "$target"; }; then bad+=("$target"); fi
  fi
done
((${#bad[@]} == 0)) || fail "broken: ${bad[*]} (inputs in build-fuzz/broken)"
if [[ "$seconds" != 0 ]]; then say "${#targets[@]} targets: nothing broke."; fi
echo "| parser | inputs run | with sanitizers | inputs kept | edges reached of the functions entered |"
echo "|---|---|---|---|---|"
for target in "${targets[@]}"; do
  read -r reached all <<<"$(edges_of "$target")"
  kept="$(find "$root/build-fuzz/found/$target" "$root/tests/fuzz/corpus/$target" -type f | wc -l)"
  echo "| $target | $(runs_of "$target" fuzz fuzz-plain) | $(runs_of "$target" fuzz) | $kept | $reached of $all |"
done
