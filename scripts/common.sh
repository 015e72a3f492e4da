# Sourced by the other scripts: where the project is, and how to say what is wrong in one sentence.
# shellcheck shell=bash

set -euo pipefail

root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
# shellcheck disable=SC2034  # used by the scripts that source this
build="$root/build"

say() { printf '%s\n' "$*" >&2; }

fail() {
  say "${0##*/}: $*"
  exit 1
}

# quietly WHAT COMMAND...: runs the command, keeps its output in a log, and shows the end of it only where the
# command fails. Returns its status.
quietly() {
  local what="$1" log
  shift
  log="$(mktemp "${TMPDIR:-/tmp}/sonarcal-XXXXXX.log")" ||
    fail "cannot make a temporary file: is the disk full?"
  say "$what ..."
  if "$@" >"$log" 2>&1; then
    rm -f "$log"
    return 0
  fi
  tail -n 25 "$log" >&2
  last_log="$log"
  return 1
}
# shellcheck disable=SC2034
last_log=""
