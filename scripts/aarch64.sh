#!/usr/bin/env bash
# Cross-compiles for 64-bit ARM (aarch64) on Debian 12 into build-aarch64/, warnings as errors, and runs the tests of
# core and of most of sim in the emulator. Needs g++-aarch64-linux-gnu, mmdebstrap and qemu-user, and root or user
# namespaces for mmdebstrap.
#
#   scripts/aarch64.sh [--sysroot DIR] [--build-only] [TARGET...]
#     --sysroot DIR  the folder with the headers and libraries for ARM (default: ~/.cache/sonarcal/aarch64). It is
#                    made from Debian's packages if it is absent, and kept.
#     --build-only   run no tests
#     TARGET...      what to build (default: everything except the Python module). Other tests are not run then.
#
# SONARCAL_MIRROR names another package server.

# shellcheck source=scripts/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

sysroot="${XDG_CACHE_HOME:-${HOME:-/root}/.cache}/sonarcal/aarch64"
run_tests=1
targets=()
while (($# > 0)); do
  case "$1" in
    --sysroot)
      [[ -n "${2:-}" ]] || fail "--sysroot needs a folder"
      sysroot="$2"
      shift 2
      ;;
    --build-only)
      run_tests=""
      shift
      ;;
    -h | --help)
      sed -n '2,13s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"
      exit 0
      ;;
    -*) fail "unknown argument '$1', expected --sysroot, --build-only or a target" ;;
    *)
      targets+=("$1")
      shift
      ;;
  esac
done

for program in aarch64-linux-gnu-g++ mmdebstrap qemu-aarch64; do
  command -v "$program" >/dev/null || fail "there is no $program: install g++-aarch64-linux-gnu, mmdebstrap, qemu-user"
done

# The packages are unpacked, not installed: this system stays as it is, and the packages' own scripts do not run.
# Absolute links become relative to the folder. BLAS and LAPACK get the links that those scripts would make.
make_sysroot() {
  [[ ! -e "$sysroot" ]] || return 0
  local packages unfinished="$sysroot.unfinished" libraries link name suffix mirror=()
  if [[ -n "${SONARCAL_MIRROR:-}" ]]; then mirror=("$SONARCAL_MIRROR"); fi
  packages="$(awk '$1 == "build" && $2 ~ /-dev$|^lib/ { print $2 }' "$root/scripts/packages.txt" | paste -sd,)"
  packages+=",libstdc++-12-dev,libgtest-dev,libgmock-dev,libblas-dev,liblapack-dev"
  rm -rf "$unfinished"
  mkdir -p "$(dirname "$unfinished")"
  quietly "Unpacking Debian's packages for ARM into $sysroot" mmdebstrap --architectures=arm64 --variant=extract \
    --hook-dir=/usr/share/mmdebstrap/hooks/merged-usr --include="$packages" bookworm "$unfinished" "${mirror[@]}" ||
    fail "mmdebstrap failed, its last lines are above"
  find "$unfinished/usr" -type l -lname '/*' -print0 | while IFS= read -r -d '' link; do
    ln -sfnr "$unfinished$(readlink "$link")" "$link"
  done
  libraries="$unfinished/usr/lib/aarch64-linux-gnu"
  for name in blas lapack; do
    for suffix in so so.3 a; do ln -sf "$name/lib$name.$suffix" "$libraries/lib$name.$suffix"; done
  done
  mv "$unfinished" "$sysroot"
}

make_sysroot
sysroot="$(realpath "$sysroot")"
options=()
if command -v ccache >/dev/null; then options+=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache); fi
(cd "$root" && quietly "Configuring build-aarch64/" cmake --preset aarch64 -DSONARCAL_SYSROOT="$sysroot" "${options[@]}") ||
  fail "cmake cannot configure build-aarch64/"
say "Building for ARM ..."
if ((${#targets[@]} > 0)); then targets=(--target "${targets[@]}"); fi
cmake --build "$root/build-aarch64" "${targets[@]}" >&2 || fail "the build failed, its errors are above"
if [[ -n "$run_tests" ]]; then
  say "Running tests in the emulator ..."
  ctest --test-dir "$root/build-aarch64" --output-on-failure --tests-regex '^(core|sim_(physics|geometry|image))\.' >&2 ||
    fail "tests failed, see above"
fi
say "The build for ARM is right."
