#!/usr/bin/env bash
# clang-format over every tracked C++ file.
#
#   scripts/format.sh           rewrites them
#   scripts/format.sh --check   changes nothing, names the files that differ, fails if there are any

# shellcheck source=scripts/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

check=no
case "${1:-}" in
  "") ;;
  --check) check=yes ;;
  *) fail "unknown argument '$1', expected --check or nothing" ;;
esac

formatter=""
for name in clang-format-14 clang-format; do
  if command -v "$name" >/dev/null; then
    formatter="$name"
    break
  fi
done
[[ -n "$formatter" ]] || fail "there is no clang-format: install clang-format"

cd "$root"
mapfile -t files < <(git ls-files --cached -- '*.h' '*.cc')
present=()
for file in "${files[@]}"; do
  if [[ -f "$file" ]]; then present+=("$file"); fi
done
if [[ $check == no ]]; then
  "$formatter" -i "${present[@]}"
  exit 0
fi

status=0
messages="$(printf '%s\0' "${present[@]}" |
  xargs -0 -n 32 -P "$(nproc)" "$formatter" --dry-run --Werror --ferror-limit=1 2>&1)" || status=$?
if [[ $status != 0 ]]; then
  # One message a line that differs: "path:line:column: error: ...".
  differing="$(sed -n 's/^\([^ :]*\):[0-9]*:[0-9]*: .*/\1/p' <<<"$messages" | sort -u | tr '\n' ' ')"
  [[ -n "$differing" ]] || fail "$formatter failed: $messages"
  fail "scripts/format.sh would change: $differing"
fi
