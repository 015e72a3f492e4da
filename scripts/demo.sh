#!/usr/bin/env bash
# The whole way once: installs what is missing, builds, runs `sonarcal reproduce`, names the report it wrote.
#
#   scripts/demo.sh [DIR]     DIR: where the report goes (default: sonarcal-report)

# shellcheck source=scripts/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

case "${1:-}" in
  -h | --help)
    sed -n '2,4s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"
    exit 0
    ;;
  -*) fail "unknown argument '$1', expected a folder for the report" ;;
esac
[[ $# -le 1 ]] || fail "$# arguments, expected at most one: a folder for the report"
out="${1:-sonarcal-report}"

"$root/scripts/setup.sh"

# Real recordings that lie at the project's root are found from any working directory.
if [[ -z "${SONARCAL_RECORDINGS:-}" && -d "$root/recordings" ]]; then
  export SONARCAL_RECORDINGS="$root/recordings"
fi
"$build/apps/sonarcal" reproduce --out "$out"
say "The report: $(cd "$out" && pwd)/report.html"
