#!/usr/bin/env bash
# Installs missing packages, builds, and runs the tests.
#
#   scripts/test.sh [--quick] [ARGUMENTS OF CTEST]     such as: scripts/test.sh -R Gsab, or -LE slow
#     --quick   only core, data_io and metrics with their tests: an answer within five minutes on two cores,
#               from an empty build folder

# shellcheck source=scripts/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

scope=--tests
duration="20 to 40 minutes on two cores"
selection=()
case "${1:-}" in
  --quick)
    scope=--quick-tests
    duration="about a minute on two cores"
    selection=(-L quick)
    shift
    ;;
  -h | --help)
    sed -n '2,7s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"
    exit 0
    ;;
esac
selection+=("$@")

say "Step 1 of 2: packages and build"
"$root/scripts/setup.sh" "$scope"
count="$(ctest --test-dir "$build" -N "${selection[@]}" | sed -n 's/^Total Tests: //p')"
say "Step 2 of 2: $count tests (all: $duration)"
if [[ -z "${SONARCAL_RECORDINGS:-}" && ! -d "$root/recordings" ]]; then
  say "No recordings (SONARCAL_RECORDINGS): tests that need them are skipped."
fi
ctest --test-dir "$build" --parallel "$(nproc)" --output-on-failure --no-tests=error "${selection[@]}"
