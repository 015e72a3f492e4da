#!/usr/bin/env bash
# How well each method of segmentation finds what people outlined, as Markdown: IoU, precision and recall on
# pictures that its settings were not chosen on. Takes some minutes. docs/studies/segmentation.md shows what it printed.
#
#   scripts/segmentation.sh [FOLDER] [METHODS]
#
#   FOLDER    pictures, masks and boxes as in aris3000_watertank (default: that one, of $SONARCAL_RECORDINGS or
#             recordings/ at the project's root)
#   METHODS   a,b,c (default: all that need no fitted background)

# shellcheck source=scripts/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

case "${1:-}" in
  -h | --help)
    sed -n '2,9s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"
    exit 0
    ;;
  -*) fail "unknown argument '$1', expected a folder" ;;
esac
folder="${1:-${SONARCAL_RECORDINGS:-$root/recordings}/aris3000_watertank}"
[[ -d "$folder/Masks" ]] || fail "$folder has no folder Masks, expected pictures that people outlined"

"$root/scripts/setup.sh" --tests --no-build
# Always, because scripts/setup.sh configures without the tests.
quietly "Configuring" cmake -S "$root" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DSONARCAL_BUILD_TESTS=ON ||
  fail "cmake failed, its last lines are above"
quietly "Building" cmake --build "$build" --target segmentation_study || fail "the build failed"
"$build/tests/metrics/segmentation_study" "$folder" "methods=${2:-}" chosen
