#!/usr/bin/env bash
# Runs the notebooks from top to bottom and writes them as HTML.
#
#   scripts/notebooks.sh [--strip] [NAME...]     such as: scripts/notebooks.sh first_image
#     --strip  instead, takes the outputs out of the notebooks, as they are to be committed
#
# Written: build/notebooks/NAME.html, one file each that opens offline.

# shellcheck source=scripts/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

strip=no
names=()
for argument in "$@"; do
  case "$argument" in
    --strip) strip=yes ;;
    -h | --help)
      sed -n '2,7s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"
      exit 0
      ;;
    -*) fail "unknown argument '$argument', expected --strip or names of notebooks" ;;
    *) names+=("${argument%.ipynb}") ;;
  esac
done
if [[ ${#names[@]} == 0 ]]; then
  for file in "$root"/notebooks/*.ipynb; do names+=("$(basename "$file" .ipynb)"); done
fi
for name in "${names[@]}"; do
  [[ -f "$root/notebooks/$name.ipynb" ]] || fail "there is no notebook '$name' in notebooks/"
done

# Debian's nbconvert belongs to Debian's Python.
python=/usr/bin/python3
[[ -x "$python" ]] || python=python3
"$python" -c "import nbconvert, ipykernel" 2>/dev/null ||
  fail "nbconvert is missing: run scripts/setup.sh --tests, or install jupyter-nbconvert and python3-ipykernel"

if [[ $strip == yes ]]; then
  for name in "${names[@]}"; do
    "$python" -m nbconvert --log-level WARN --clear-output --inplace "$root/notebooks/$name.ipynb"
  done
  exit 0
fi

[[ -f "$build/python/sonarcal/__init__.py" ]] || fail "the Python module is not built: run scripts/setup.sh"
for name in "${names[@]}"; do
  PYTHONPATH="$build/python${PYTHONPATH:+:$PYTHONPATH}" quietly "Running notebooks/$name.ipynb" \
    "$python" -m nbconvert --execute --to html --embed-images --output-dir "$build/notebooks" \
    --ExecutePreprocessor.timeout=600 --ExecutePreprocessor.kernel_name=python3 "$root/notebooks/$name.ipynb" ||
    fail "notebooks/$name.ipynb failed, its last lines are above"
  say "$build/notebooks/$name.html"
done
