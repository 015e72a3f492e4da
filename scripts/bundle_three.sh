#!/usr/bin/env bash
# Makes apps/view/three/three.js: the parts of three.js that the live view uses, in one file. Needs npm and a network.
#
#   scripts/bundle_three.sh [VERSION]     such as: scripts/bundle_three.sh 0.187.0 (default: the newest)
#
# The file is committed, so that a build needs neither. Run this after a change of apps/view/three/names.js.

# shellcheck source=scripts/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

case "${1:-}" in
  -h | --help)
    sed -n '2,6s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"
    exit 0
    ;;
esac
command -v npm >/dev/null || fail "there is no npm: install npm"
work="$(mktemp -d "${TMPDIR:-/tmp}/sonarcal-XXXXXX")"
trap 'rm -rf "$work"' EXIT
cp "$root/apps/view/three/names.js" "$work/"
cd "$work"
echo '{"private": true}' >package.json
quietly "Fetching three.js and esbuild" npm install --no-audit --no-fund "three@${1:-latest}" esbuild@0.28 ||
  fail "npm failed, its last lines are above"
version="$(node -p 'require("./node_modules/three/package.json").version')"
quietly "Bundling three.js $version" npx esbuild names.js --bundle --minify --format=esm --legal-comments=inline \
  --banner:js="// three.js $version and its OrbitControls. Made by scripts/bundle_three.sh." --outfile=three.js ||
  fail "esbuild failed, its last lines are above"
mv three.js "$root/apps/view/three/three.js"
say "three.js $version: apps/view/three/three.js"
