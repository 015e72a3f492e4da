#!/usr/bin/env bash
# Installs the packages that are missing (Debian 12, Debian 13, Ubuntu 24.04), and builds sonarcal into build/.
#
#   scripts/setup.sh [--tests | --quick-tests] [--no-build]
#     --tests        also what the tests need, and build the tests
#     --quick-tests  the same packages, and build only the quick tests with their libraries
#     --no-build     packages only
#
# Can be run again and again: what is there is left alone. Works as root and with sudo.

# shellcheck source=scripts/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

with_tests=no
with_build=yes
target=all
for argument in "$@"; do
  case "$argument" in
    --tests) with_tests=yes ;;
    --quick-tests)
      with_tests=yes
      target=quick_tests
      ;;
    --no-build) with_build=no ;;
    -h | --help)
      sed -n '2,9s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"
      exit 0
      ;;
    *) fail "unknown argument '$argument', expected --tests, --quick-tests or --no-build" ;;
  esac
done

# wanted_packages WHEN...: the packages of scripts/packages.txt with one of these words before them.
wanted_packages() {
  local when package
  while read -r when package; do
    if [[ -n "$package" && " $* " == *" $when "* ]]; then echo "$package"; fi
  done <"$root/scripts/packages.txt"
}

is_installed() {
  [[ "$(dpkg-query --show --showformat='${db:Status-Status}' "$1" 2>/dev/null)" == installed ]]
}

as_root() {
  if [[ "$(id -u)" == 0 ]]; then
    env DEBIAN_FRONTEND=noninteractive "$@"
  else
    sudo env DEBIAN_FRONTEND=noninteractive "$@"
  fi
}

# Succeeds if apt can install a package of this name. A name that other packages provide does not count.
is_offered() {
  [[ "$(apt-cache policy "$1" 2>/dev/null)" == *"Candidate: "[^\(]* ]]
}

# One sentence for the ways in which apt fails most often.
explain_apt() {
  local log
  log="$(cat "$last_log")"
  case "$log" in
    *"Could not get lock"* | *"Unable to acquire the dpkg frontend lock"*)
      fail "another program is installing packages: wait until it is done, then run this again" ;;
    *"No space left on device"* | *"enough free space"*)
      fail "the disk is too full to install the packages" ;;
    *"Temporary failure resolving"* | *"Could not connect"* | *"Failed to fetch"* | *"Could not resolve"*)
      fail "the package servers cannot be reached: is there a network?" ;;
    *"Unable to locate package"* | *"has no installation candidate"*)
      fail "apt knows not all of the packages: this needs Debian 12, Debian 13 or Ubuntu 24.04" ;;
    *) fail "apt failed, its last lines are above" ;;
  esac
}

need_root() {
  [[ "$(id -u)" == 0 ]] || command -v sudo >/dev/null ||
    fail "installing packages needs root: run this as root, or install sudo"
}

install_missing() {
  if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
    fail "this is neither Debian nor Ubuntu; install what scripts/packages.txt lists, then build with cmake"
  fi
  local package words=(build) required=() optional=()
  if [[ $with_tests == yes ]]; then words+=(test); fi
  while read -r package; do
    is_installed "$package" || required+=("$package")
  done < <(wanted_packages "${words[@]}")
  local apt=(apt-get -o DPkg::Lock::Timeout=120 --yes --no-install-recommends)
  if [[ ${#required[@]} != 0 ]]; then
    need_root
    # The lists of a fresh machine are empty, those of an old one may name packages that are gone.
    quietly "Updating the package lists" as_root "${apt[@]}" update || explain_apt
  fi
  if [[ $with_tests == yes ]]; then
    while read -r package; do
      is_installed "$package" || ! is_offered "$package" || optional+=("$package")
    done < <(wanted_packages optional)
  fi
  local missing=("${required[@]}" "${optional[@]}")
  if [[ ${#missing[@]} == 0 ]]; then
    say "All packages are there."
    return
  fi
  need_root
  say "Packages to install: ${missing[*]}"
  quietly "Installing ${#missing[@]} packages" as_root "${apt[@]}" install "${missing[@]}" || explain_apt
}

# A build directory that was configured for another path (a moved or copied tree) only fails later, and
# obscurely.
drop_stale_build() {
  local cache="$build/CMakeCache.txt" configured_source configured_build
  [[ -f "$cache" ]] || return 0
  configured_source="$(sed -n 's/^CMAKE_HOME_DIRECTORY:INTERNAL=//p' "$cache")"
  configured_build="$(sed -n 's/^CMAKE_CACHEFILE_DIR:INTERNAL=//p' "$cache")"
  if [[ "$configured_source" != "$root" || "$configured_build" != "$build" ]] ||
    ! grep -q '^CMAKE_GENERATOR:INTERNAL=Ninja$' "$cache"; then
    say "build/ was configured for ${configured_source:-another place}: starting it afresh."
    rm -rf "$build"
  fi
}

configure_and_build() {
  command -v c++ >/dev/null || fail "there is no C++ compiler: install g++"
  command -v cmake >/dev/null || fail "there is no cmake: install cmake"
  local free_kib
  free_kib="$(df --output=avail -k "$root" | tail -n 1)"
  ((free_kib > 1024 * 1024)) || fail "the disk of $root has less than 1 GiB left, too little for a build"

  drop_stale_build
  local tests_on
  tests_on="$([[ $with_tests == yes ]] && echo ON || echo OFF)"
  # A user's compiler may know warnings that those of continuous integration do not. The flags do not depend on the
  # tests, because other flags would build the program again.
  local warnings_fail
  warnings_fail="$([[ -n "${CI:-}" ]] && echo ON || echo OFF)"
  local options=("-DSONARCAL_BUILD_TESTS=$tests_on" "-DSONARCAL_WARNINGS_AS_ERRORS=$warnings_fail" -DSONARCAL_UNITY=ON)
  if command -v ccache >/dev/null; then options+=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache); fi
  (cd "$root" && quietly "Configuring build/" cmake --preset release "${options[@]}") ||
    fail "cmake cannot configure the project, its last lines are above"
  case "$target,$with_tests" in
    quick_tests,*) say "Building the quick tests (some minutes the first time) ..." ;;
    all,yes) say "Building the program and all tests (10 to 40 minutes on two cores the first time) ..." ;;
    *) say "Building the program (5 to 20 minutes on two cores the first time) ..." ;;
  esac
  # A compiler takes up to 2 GB.
  local jobs gib
  gib="$(awk '/^MemAvailable:/ {print int($2 / 1024 / 1024)}' /proc/meminfo)"
  jobs=$(($(nproc) + 1))
  if ((jobs > gib / 2)); then jobs=$((gib < 2 ? 1 : gib / 2)); fi
  cmake --build "$build" --target "$target" --parallel "$jobs" >&2 || fail "the build failed, its errors are above"
}

install_missing
if [[ $with_build == yes ]]; then configure_and_build; fi
