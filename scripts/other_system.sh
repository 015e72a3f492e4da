#!/usr/bin/env bash
# Builds and tests the committed tree on another system, in a root folder of its own. Needs root, debootstrap and
# git.
#
#   scripts/other_system.sh debian13|ubuntu24.04 [--root DIR] [--unverified] [--quick | -- ARGUMENTS OF CTEST]
#     --root DIR    the folder of the system (default: ~/.cache/sonarcal/<system>). It is made if it is absent, and
#                   kept: a second run installs and builds only what has changed.
#     --unverified  skip the check of the server's signature, for a machine that does not have the server's keys
#     --quick       only `scripts/test.sh --quick`
#     --            only `scripts/test.sh` with these arguments
#   Otherwise it runs both commands of the README: `scripts/demo.sh report` and `scripts/test.sh`.
#
# SONARCAL_MIRROR names another package server. SONARCAL_RECORDINGS is passed on, read-only.

# shellcheck source=scripts/common.sh
source "$(dirname "${BASH_SOURCE[0]}")/common.sh"

name="${1:-}"
case "$name" in
  debian13)
    release=trixie
    mirror=http://deb.debian.org/debian
    components=main
    keys=()  # debootstrap finds Debian's keys itself
    bootstrap_script=sid
    issue="Debian GNU/Linux 13"
    ;;
  ubuntu24.04)
    release=noble
    mirror=http://archive.ubuntu.com/ubuntu
    components="main,universe"
    keys=(--keyring=/usr/share/keyrings/ubuntu-archive-keyring.gpg)
    bootstrap_script=gutsy  # for this and all later releases of Ubuntu
    issue="Ubuntu 24.04"
    ;;
  -h | --help)
    sed -n '2,14s/^# \{0,1\}//p' "${BASH_SOURCE[0]}"
    exit 0
    ;;
  *) fail "system '$name', expected debian13 or ubuntu24.04" ;;
esac
arguments=("$@")
shift

system="${XDG_CACHE_HOME:-${HOME:-/root}/.cache}/sonarcal/$name"
commands=(demo test)
test_arguments=()
while (($# > 0)); do
  case "$1" in
    --root)
      [[ -n "${2:-}" ]] || fail "--root needs a folder"
      system="$2"
      shift 2
      ;;
    --unverified)
      keys=(--no-check-gpg)
      shift
      ;;
    --quick)
      commands=(test)
      test_arguments=(--quick)
      shift
      ;;
    --)
      commands=(test)
      shift
      test_arguments=("$@")
      break
      ;;
    *) fail "unknown argument '$1', expected --root, --unverified, --quick or --" ;;
  esac
done

[[ "$(id -u)" == 0 ]] || fail "chroot needs root: run this as root or with sudo"
command -v git >/dev/null || fail "there is no git: install git"

# Mounts are made in a mount namespace of this process: they end with it, however it ends.
if [[ -z "${SONARCAL_OWN_MOUNTS:-}" ]]; then
  SONARCAL_OWN_MOUNTS=1 exec unshare --mount --propagation private -- "${BASH_SOURCE[0]}" "${arguments[@]}"
fi

make_system() {
  if [[ -e "$system" ]]; then
    grep -qs "^PRETTY_NAME=\"$issue" "$system/etc/os-release" || fail "$system does not hold $issue"
    return 0
  fi
  command -v debootstrap >/dev/null || fail "there is no debootstrap: install debootstrap"
  local unfinished="$system.unfinished"
  rm -rf "$unfinished"
  mkdir -p "$unfinished"
  quietly "Making $issue in $system" debootstrap "${keys[@]}" --variant=minbase \
    --components="$components" --include=ca-certificates "$release" "$unfinished" "${SONARCAL_MIRROR:-$mirror}" \
    "$bootstrap_script" || fail "debootstrap failed, its last lines are above"
  mv "$unfinished" "$system"
}

mount_all() {
  mkdir -p "$system/proc" "$system/sys" "$system/dev"
  mount -t proc proc "$system/proc"
  mount --rbind --make-rslave /sys "$system/sys"
  mount --rbind --make-rslave /dev "$system/dev"
  if [[ -n "${SONARCAL_RECORDINGS:-}" ]]; then
    mkdir -p "$system/srv/recordings"
    mount --bind "$SONARCAL_RECORDINGS" "$system/srv/recordings"
    mount -o remount,bind,ro "$system/srv/recordings"
    passed_on+=(SONARCAL_RECORDINGS=/srv/recordings)
  fi
}

# A clone rather than an archive: a checkout leaves the time stamps of unchanged files alone, so that ninja builds
# only what has changed.
copy_tree() {
  local tree="$system/srv/sonarcal"
  [[ -z "$(git -C "$root" status --porcelain)" ]] || say "Changes that are not committed are not built."
  [[ -d "$tree/.git" ]] || git clone --quiet --no-checkout "$root" "$tree"
  git -C "$tree" fetch --quiet "$root" HEAD
  git -C "$tree" checkout --quiet --force --detach FETCH_HEAD
  say "Commit $(git -C "$tree" rev-parse --short HEAD) in $tree"
}

# inside SCRIPT ARGUMENTS...: runs a script of the project in the system, with little of this environment.
inside() {
  # shellcheck disable=SC2016  # the shell in the system expands these
  chroot "$system" /usr/bin/env -i HOME=/root LANG=C.UTF-8 PATH=/usr/sbin:/usr/bin:/sbin:/bin "${passed_on[@]}" \
    /bin/bash -c 'cd /srv/sonarcal && "$@"' bash "$@"
}

passed_on=(CI=true)  # warnings are errors
for variable in http_proxy https_proxy no_proxy; do
  if [[ -n "${!variable:-}" ]]; then passed_on+=("$variable=${!variable}"); fi
done

make_system
mount_all
copy_tree
for command in "${commands[@]}"; do
  case "$command" in
    demo) inside scripts/demo.sh report ;;
    test) inside scripts/test.sh "${test_arguments[@]}" ;;
  esac
done
say "$issue: done."
