#!/usr/bin/env bash
# Builds sonarcal without its optional parts into build-minimal/, and checks that the libraries of those parts
# are not linked and that the program says what it was built without.
#
#   scripts/minimal.sh

# shellcheck source=scripts/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

minimal="$root/build-minimal"
options=()
if command -v ccache >/dev/null; then options+=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache); fi
(cd "$root" && quietly "Configuring build-minimal/" cmake --preset minimal "${options[@]}") ||
  fail "cmake cannot configure build-minimal/"
say "Building without the optional parts ..."
cmake --build "$minimal" >&2 || fail "the build failed, its errors are above"

work="$(mktemp -d "${TMPDIR:-/tmp}/sonarcal-XXXXXX")"
trap 'rm -rf "$work"' EXIT

# links_none_of PATTERN PROGRAM
links_none_of() {
  local linked
  linked="$(readelf --dynamic "$2" | grep NEEDED | grep -E "$1" || true)"
  [[ -z "$linked" ]] || fail "${2##*/} links $linked"
}

# expect_refusal SENTENCE ARGUMENTS...
expect_refusal() {
  local sentence="$1" output
  shift
  if output="$("$minimal/apps/sonarcal" "$@" 2>&1)"; then fail "sonarcal $1 succeeded, expected '$sentence'"; fi
  [[ "$output" == *"$sentence"* ]] || fail "sonarcal $1 says '$output', expected '$sentence'"
}

links_none_of 'sqlite|httplib|opencv_(aruco|calib3d)' "$minimal/apps/sonarcal"
printf 'SQLite format 3\0' >"$work/empty.db3"
expect_refusal 'built without it (SONARCAL_WITH_ROS)' inspect "$work/empty.db3"
"$minimal/apps/sonarcal" scenes --only tank --quiet --out "$work/tank"
expect_refusal 'built without the live view' view --scene "$work/tank/tank.gltf" --sonar p900-45 --port 0
say "The build without the optional parts is right."
