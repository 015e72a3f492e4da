#!/usr/bin/env bash
# Whether a fit's sigmas are true: fits synthetic data sets, and prints how often their intervals cover the
# truth, as Markdown. Takes some minutes. docs/studies/coverage.md shows what it printed.
#
#   scripts/coverage.sh [SETS]     SETS: data sets of each kind (default: 200)

# shellcheck source=scripts/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

case "${1:-}" in
  -h | --help)
    sed -n '2,5s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"
    exit 0
    ;;
  *[!0-9]*) fail "unknown argument '$1', expected a number of data sets" ;;
esac
sets="${1:-200}"

"$root/scripts/setup.sh" --tests --no-build
# Always, because scripts/setup.sh configures without the tests.
quietly "Configuring" cmake -S "$root" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DSONARCAL_BUILD_TESTS=ON ||
  fail "cmake failed, its last lines are above"
quietly "Building" cmake --build "$build" --target coverage_study || fail "the build failed"
for speckle in independent grained; do
  printf '### %s pixels\n\n' "$speckle"
  "$build/tests/calib/coverage_study" "speckle=$speckle" "sets=$sets"
  printf '\n'
done
printf '### From the start that README has\n\n'
"$build/tests/calib/coverage_study" from=readme curves=tank speckle=grained views=1 "sets=$sets"
