#!/usr/bin/env bash
# Brings a public recording of a real sonar into recordings/ (or $SONARCAL_RECORDINGS) and checks it.
#
#   scripts/fetch_recording.sh NAME [--accept-licence]     names: sonarcal recordings
#
# Says whose it is and under which licence, and asks before anything is downloaded. The commit it fetches is
# the checksum of all of it. Needs git.

# shellcheck source=scripts/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

accepted=no
name=
for argument in "$@"; do
  case "$argument" in
    -h | --help)
      sed -n '2,8s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"
      exit 0
      ;;
    --accept-licence) accepted=yes ;;
    -*) fail "unknown argument '$argument', expected a name or --accept-licence" ;;
    *) name="$argument" ;;
  esac
done
[[ -n "$name" ]] || fail "which recording? 'sonarcal recordings' lists them"
sonarcal="$build/apps/sonarcal"
[[ -x "$sonarcal" ]] || fail "$sonarcal is not there: run scripts/setup.sh first"
command -v git >/dev/null || fail "there is no git: install git"

# entry FIELD: of the recording; its paths one a line, "from<tab>to".
entry() {
  "$sonarcal" recordings --json | python3 -c '
import json, sys
name, field = sys.argv[1:]
entries = [e for e in json.load(sys.stdin)["recordings"] if e["name"] == name]
if not entries: sys.exit(1)
value = entries[0][field]
print("\n".join(p["from"] + "\t" + p["to"] for p in value) if field == "paths" else value)' "$name" "$1"
}

source_url="$(entry source)" || fail "no recording is called '$name': 'sonarcal recordings' lists them"
commit="$(entry commit)"
[[ -n "$commit" ]] || fail "$name is not kept in a way that can be fetched: get it from $source_url by hand"
recordings="${SONARCAL_RECORDINGS:-$root/recordings}"
target="$recordings/$name"
[[ ! -e "$target" ]] || fail "$target is there already"

say "$name: $(entry sensor)"
say "  shows    $(entry shows)"
say "  licence  $(entry licence)"
say "  source   $source_url at $commit"
if [[ $accepted == no ]]; then
  [[ -t 0 ]] || fail "nothing was downloaded: give --accept-licence where nobody can be asked"
  read -r -p "Download it under this licence? [y/N] " answer
  [[ "$answer" == [yY]* ]] || fail "nothing was downloaded"
fi

mkdir -p "$recordings"
work="$(mktemp -d "$recordings/.fetching-XXXXXX")" || fail "cannot write into $recordings"
trap 'rm -rf "$work"' EXIT
# SONARCAL_REPOSITORY: a copy of the repository to fetch from instead; the commit says whether it is the same.
from="${SONARCAL_REPOSITORY:-$source_url}"
git -C "$work" init --quiet repository
repository="$work/repository"
quietly "Fetching from $from" git -C "$repository" fetch --depth 1 "$from" "$commit" ||
  fail "$from cannot be fetched, git's last lines are above"
mkdir "$work/$name"
while IFS=$'\t' read -r path to; do
  git -C "$repository" checkout --quiet "$commit" -- "$path" || fail "$commit has no $path"
  mv "$repository/$path" "$work/$name/$to"
done < <(entry paths)
(cd "$work/$name" && echo "$(entry witness_sha256)  $(entry witness)" | sha256sum --check --quiet >&2) ||
  fail "what came is not what the catalogue names; nothing was kept"
mv "$work/$name" "$target"
say "$target is there, and its checksum is right."
