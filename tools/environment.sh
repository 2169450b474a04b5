# shellcheck shell=bash
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Sourced by the other scripts: installs missing packages, builds this package in a workspace of its own (build/ of the
# checkout), and ignores what the shell of the caller has sourced.

script=$(realpath "$0")
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd -P)
build=$root/build         # rosrun looks for executables everywhere in a package, but not in its build/
source=$build/src/sextant  # links to what is in the checkout, without build/: else rosrun would find everything twice
binary=$build/cmake

# Debian's own tools, Python and ROS: no pyenv, conda, virtual environment or other workspace.
export PATH=/usr/sbin:/usr/bin:/sbin:/bin PYTHONNOUSERSITE=1
unset PYTHONPATH PYTHONHOME LD_LIBRARY_PATH PKG_CONFIG_PATH
unset CMAKE_PREFIX_PATH ROS_PACKAGE_PATH ROS_NAMESPACE ROS_IP ROS_IPV6
export ROS_HOSTNAME=localhost ROS_HOME=$build/ros

log() { echo "sextant: $*" >&2; }
die() { log "$*"; exit 1; }

if [[ $root =~ [^[:alnum:]/._+@-] ]]; then
  die "catkin cannot build in '$root': move it to a path without blanks and special characters"
fi

# listed_packages LIST...: the names in tools/apt_packages_LIST.txt. `NAME >= VERSION` is for this and later versions of Debian.
listed_packages() {
  local version files=("${@/#/$root/tools/apt_packages_}")
  files=("${files[@]/%/.txt}")
  version=$(. /etc/os-release && echo "${VERSION_ID:-99}")  # testing and unstable have none
  sed 's/#.*//' "${files[@]}" | awk -v version="$version" 'NF && version >= $3 + 0 {print $1}' | LC_ALL=C sort -u
}

# missing_packages LIST...: those of them that are not installed.
missing_packages() {
  LC_ALL=C comm -23 <(listed_packages "$@") \
    <(dpkg-query -W -f='${db:Status-Status} ${Package}\n' | sed -n 's/^installed //p' | LC_ALL=C sort -u)
}

# install_packages LIST...: installs them with apt; needs root or sudo only then.
install_packages() {
  command -v dpkg-query >/dev/null || die "this is not Debian (no dpkg); install by hand what tools/apt_packages_*.txt list"
  local missing log sudo=()
  mapfile -t missing < <(missing_packages "$@")
  ((${#missing[@]})) || return 0
  if ((EUID)); then
    command -v sudo >/dev/null || die "run as root first: apt-get install --no-install-recommends ${missing[*]}"
    sudo=(sudo)
  fi
  log "installing ${#missing[@]} packages with apt; on a bare system this takes some minutes"
  log=$(mktemp)
  apt_get() { "${sudo[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq -o DPkg::Lock::Timeout=300 "$@"; }
  apt_get update >"$log" || log "apt-get update failed; trying with the existing package lists"
  if ! apt_get install -y --no-install-recommends "${missing[@]}" >>"$log"; then
    cat "$log" >&2
    die "apt could not install ${missing[*]} (made for Debian 11 to 13; this is $(. /etc/os-release && echo "$PRETTY_NAME"))"
  fi
  rm -f "$log"
}

# continue_as_owner ARGUMENT...: when root works in a user's checkout, the rest of the calling script runs as that user,
# so that no file of root's is left in somebody's home.
continue_as_owner() {
  local owner group home groups=--clear-groups entry
  owner=$(stat -c %u "$root")
  ((EUID == 0 && owner != 0)) || return 0
  group=$(stat -c %g "$root") home=$build/home
  if entry=$(getent passwd "$owner"); then
    groups=--init-groups
    IFS=: read -r _ _ _ group _ home _ <<<"$entry"
  fi
  local -a as_owner=(setpriv "--reuid=$owner" "--regid=$group" "$groups" env "HOME=$home")
  "${as_owner[@]}" test -w "$root" || return 0
  "${as_owner[@]}" test -w . || cd "$root" || return
  exec "${as_owner[@]}" bash "$script" "$@"
}

# A compiler process takes up to 1 GB.
make_jobs() {
  awk -v cores="$(nproc)" '/^MemAvailable/ {n = int($2 / 1e6); print n < 1 ? 1 : n < cores ? n : cores}' /proc/meminfo
}

link_sources() {
  local entry
  mkdir -p "$source"
  find "$source" -maxdepth 1 -xtype l -delete  # links to removed files
  for entry in "$root"/*; do
    [[ $entry == "$build" ]] || ln -sfn "$entry" "$source/${entry##*/}"
  done
}

# prepare_build: the folder of the build and its links to the checkout.
prepare_build() {
  if [[ -f $binary/CMakeCache.txt ]] && ! grep -qxF "CMAKE_HOME_DIRECTORY:INTERNAL=$source" "$binary/CMakeCache.txt"; then
    log "the checkout has moved: rebuilding"
    rm -rf "$build"
  fi
  if ! { mkdir -p "$build" && touch "$build/CATKIN_IGNORE"; }; then die "cannot write $build (left by another user? remove it)"; fi
  link_sources
}

# run_cmake FOLDER DEVEL_SPACE [OPTION...]
run_cmake() {
  mkdir -p "$1"
  cmake -S "$source" -B "$1" -DCATKIN_DEVEL_PREFIX="$2" -DCATKIN_TEST_RESULTS_DIR="$build/test_results" \
    -DPYTHON_EXECUTABLE=/usr/bin/python3 -DCMAKE_TARGET_MESSAGES=OFF "${@:3}" >"$1/configure.log" 2>&1 ||
    { cat "$1/configure.log" >&2; die "cmake failed, see above"; }
}

# configure [ON]: with the tests, whose packages are not installed otherwise.
configure() {
  prepare_build
  local tests=${1:-OFF} stamp
  for stamp in "$build/configured_$tests" "$build/configured_ON"; do
    if [[ $stamp -nt ${BASH_SOURCE[0]} && -f $binary/Makefile ]]; then return; fi
  done
  # Debug information of lines and functions, for backtraces: the whole of it takes a third more of the compiler's time.
  run_cmake "$binary" "$build/devel" -DCATKIN_ENABLE_TESTING="$tests" -DCMAKE_CXX_FLAGS_RELWITHDEBINFO="-O2 -g1 -DNDEBUG"
  touch "$build/configured_$tests"
}

# build_package [TARGET...]: builds the targets (everything but the tests when none is named) and sources the result.
# The compiler's own output goes to $build/build.log.
build_package() {
  if [[ ${1-} == tests ]]; then configure ON; else configure; fi
  set -o pipefail
  flock "$build/lock" make -C "$binary" --no-print-directory -j"$(make_jobs)" "${@:-all}" 2>&1 |
    python3 "$root/tools/build_progress.py" "$build/build.log" ||
    die "the build failed; see the compiler output in $build/build.log"
  set +u
  # shellcheck disable=SC1091
  . "$build/devel/setup.bash"
  set -u
}
