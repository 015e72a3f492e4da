#!/usr/bin/env bash
# Builds with sanitizers and runs the tests. A test fails if a sanitizer reports anything.
#
#   scripts/sanitize.sh address|thread [--quick | --only PROGRAM ...] [ARGUMENTS OF CTEST]
#
#     address   AddressSanitizer, LeakSanitizer and UndefinedBehaviorSanitizer, in build-dev/
#     thread    ThreadSanitizer, in build-thread/, with a TBB that is built for it
#     --quick   the tests of scripts/test.sh --quick
#     --only    builds one program and runs its tests, such as --only sim_image_test; may be repeated
#
# ThreadSanitizer knows no synchronisation of a library that is built without it: each loop of Debian's TBB would look
# like a race. So this builds the TBB of the system from its source package, in build-thread/tbb/. Nothing is installed.

# shellcheck source=scripts/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

preset=
case "${1:-}" in
  address) preset=dev ;;
  thread) preset=thread ;;
  -h | --help)
    sed -n '2,12s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"
    exit 0
    ;;
  *) fail "'${1:-}', expected address or thread" ;;
esac
shift
tree="$root/build-$preset"

targets=()
selection=()
programs=()
while [[ $# -gt 0 ]]; do
  case "$1" in
    --quick)
      targets+=(quick_tests)
      selection=(-L quick)
      ;;
    --only)
      [[ -n "${2:-}" ]] || fail "--only needs a test program, such as sim_image_test"
      targets+=("$2")
      programs+=("${2%_test}")
      shift
      ;;
    *) break ;;
  esac
  shift
done
if [[ ${#programs[@]} != 0 ]]; then
  [[ ${#selection[@]} == 0 ]] || fail "--quick and --only, expected one of them"
  selection=(-R "^($(IFS='|' && echo "${programs[*]}"))\\.")
fi
if [[ ${#targets[@]} == 0 ]]; then targets=(all); fi
selection+=("$@")

# Sanitizers reserve fixed places in memory. Their runtime libraries of GCC 12 end at once where the kernel may put
# something else there.
fixed_addresses=()
if [[ "$(cat /proc/sys/vm/mmap_rnd_bits 2>/dev/null || echo 0)" -gt 28 ]]; then
  fixed_addresses=(setarch "$(uname -m)" --addr-no-randomize)
  "${fixed_addresses[@]}" true 2>/dev/null ||
    fail "this system forbids 'setarch --addr-no-randomize': set vm.mmap_rnd_bits=28, or run a container without seccomp"
fi

# The system's sources of packages, as sources of source packages in a folder.
list_source_packages() {
  local folder="$1" file
  for file in /etc/apt/sources.list /etc/apt/sources.list.d/*.list; do
    if [[ -f "$file" ]]; then sed -n 's/^deb\(-src\)\{0,1\} /deb-src /p' "$file"; fi
  done | sort -u >"$folder/source.list"
  for file in /etc/apt/sources.list.d/*.sources; do
    if [[ -f "$file" ]]; then sed 's/^Types:.*/Types: deb-src/' "$file" >"$folder/${file##*/}"; fi
  done
}

# build_tbb FOLDER: the TBB of the system with ThreadSanitizer, in FOLDER/lib.
build_tbb() {
  local folder="$1" package version
  read -r package version < <(dpkg-query --show --showformat='${source:Package} ${source:Version}\n' libtbb-dev)
  if [[ -f "$folder/version" && "$(cat "$folder/version")" == "$version" ]]; then return; fi
  rm -rf "$folder"
  mkdir -p "$folder/apt/sources" "$folder/apt/lists/partial" "$folder/source"
  list_source_packages "$folder/apt/sources"
  local apt=(apt-get -o Dir::Etc::SourceList=/dev/null -o Dir::Etc::SourceParts="$folder/apt/sources"
    -o Dir::State::Lists="$folder/apt/lists" -o Dir::Cache="$folder/apt" -o APT::Sandbox::User="$(id -un)"
    -o APT::Update::Post-Invoke::= -o APT::Update::Post-Invoke-Success::=)
  quietly "Reading the lists of source packages" "${apt[@]}" update || fail "apt failed, its last lines are above"
  (cd "$folder/source" && quietly "Fetching the source of $package $version" "${apt[@]}" source "$package=$version") ||
    fail "there is no source package $package $version: is the system up to date?"
  quietly "Configuring TBB" cmake -S "$folder"/source/*/ -B "$folder/build" -G Ninja -DCMAKE_BUILD_TYPE=RelWithDebInfo \
    -DCMAKE_INSTALL_PREFIX="$folder" -DCMAKE_INSTALL_LIBDIR=lib -DTBB_SANITIZE=thread -DTBB_STRICT=OFF -DTBB_TEST=OFF \
    -DTBBMALLOC_BUILD=OFF -DTBB_DISABLE_HWLOC_AUTOMATIC_SEARCH=ON || fail "cmake cannot configure TBB"
  quietly "Building TBB with ThreadSanitizer" cmake --build "$folder/build" || fail "the build of TBB failed"
  quietly "Copying TBB to $folder/lib" cmake --install "$folder/build" || fail "TBB cannot be copied"
  echo "$version" >"$folder/version"
}

say "Step 1 of 2: packages and build"
"$root/scripts/setup.sh" --tests --no-build
options=(-DSONARCAL_UNITY=ON)
if command -v ccache >/dev/null; then options+=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache); fi
cd "$root"
quietly "Configuring build-$preset/" cmake --preset "$preset" "${options[@]}" ||
  fail "cmake cannot configure the project, its last lines are above"
if [[ $preset == thread ]]; then build_tbb "$tree/tbb"; fi
# The build runs each test program once to list its tests.
"${fixed_addresses[@]}" cmake --build --preset "$preset" --target "${targets[@]}" >&2 ||
  fail "the build failed, its errors are above"
say "Step 2 of 2: tests (5 to 15 times slower than those of scripts/test.sh)"
"${fixed_addresses[@]}" ctest --preset "$preset" --parallel "$(nproc)" --no-tests=error "${selection[@]}"
