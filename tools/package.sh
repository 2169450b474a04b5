#!/usr/bin/env bash
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Builds the Debian packages sextant and sextant-dev, runs the C++ tests and lintian on them. Afterwards, on the robot:
# apt install --no-install-recommends ./sextant_*.deb
#
#   tools/package.sh                                   for this machine's Debian, into build/packages
#   tools/package.sh --suite trixie [--arch arm64]     for another Debian, into build/packages/trixie-arm64: in a tree that
#                                                      debootstrap makes. As root; another architecture also needs
#                                                      qemu-user-static
#   tools/package.sh --suite trixie --check            installs the built packages on a bare system of that suite, runs the demo as
#                                                      a user without anything sourced, and purges them; on the smallest
#                                                      system that runs Sextant, without recommended packages
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/environment.sh"

suite="" check=0 arch=$(dpkg --print-architecture)
while (($#)); do
  case $1 in
    --suite) suite=${2:?which suite?}; shift 2 ;;
    --check) check=1; shift ;;
    --arch) arch=${2:?which architecture?}; shift 2 ;;
    *) sed -n '5,15s/^# \?//p' "$script"; exit 2 ;;
  esac
done

comma_separated() { paste -sd, | sed 's/,/, /g'; }
recommended() { sed -n 's/^Recommends: //p' "$root/debian/control.in" | tr , '\n' | tr -d ' '; }
from_manifest() { sed -n "s:.*<$1[^>]*>\(.*\)</$1>.*:\1:p" "$root/package.xml"; }

# write_control FOLDER: the files of debian/ that depend on the package lists and on package.xml.
write_control() {
  local maintainer version
  maintainer="$(from_manifest maintainer) <$(sed -n 's/.*<maintainer email="\([^"]*\)".*/\1/p' "$root/package.xml")>"
  version=$(from_manifest version)~deb$(. /etc/os-release && echo "${VERSION_ID:-0}")
  sed -e "s/@MAINTAINER@/$maintainer/" \
    -e "s/@BUILD_DEPENDS@/debhelper-compat (= 13), $(listed_packages build package | comma_separated)/" \
    -e "s/@DEPENDS@/$(listed_packages run | grep -vxFf <(recommended) | comma_separated)/" "$root/debian/control.in" >"$1/control"
  printf '%s\n' "sextant ($version) unstable; urgency=medium" "" "  * See CHANGELOG.rst." "" \
    " -- $maintainer  $(LC_ALL=C date -R -r "$root/package.xml")" >"$1/changelog"
}

build_here() {
  local packages=$build/packages
  install_packages build package
  continue_as_owner "$@"
  prepare_build
  rm -rf "$packages/source" "$packages"/sextant*  # packages of other suites are in folders here
  mkdir -p "$packages/source"
  tar -C "$root" --exclude=./build --exclude=./.git --exclude=__pycache__ -c . | tar -C "$packages/source" -x
  write_control "$packages/source/debian"
  cd "$packages/source"
  log "building the packages, log in $packages/build.log"
  DEB_BUILD_OPTIONS="parallel=$(make_jobs) noautodbgsym ${DEB_BUILD_OPTIONS-}" dpkg-buildpackage -b -us -uc >"$packages/build.log" 2>&1 ||
    { tail -n 40 "$packages/build.log" >&2; die "the packages could not be built"; }
  cd "$packages"
  rm -rf source
  lintian --allow-root --fail-on error ./*.changes
  ls "$packages"/*.deb
}

# make_tree TREE ARCHITECTURE PACKAGE...: a minimal system of the suite with these packages.
make_tree() {
  local mirror
  mirror=$({ cat /etc/apt/sources.list /etc/apt/sources.list.d/*.sources 2>/dev/null || true; } |
    sed -n -e 's/^URIs: *//p' -e 's/^deb \(\[[^]]*\] \)\?\([^ ]*\) .*/\2/p' | head -n 1)
  if [[ ! -e $1/usr/bin/apt-get ]]; then
    log "installing Debian $suite for $2 in $1"
    debootstrap --arch="$2" --variant=minbase --include=ca-certificates "$suite" "$1" "$mirror" >"$1.log" 2>&1 || die "debootstrap failed, see $1.log"
    cp /etc/resolv.conf /etc/hosts "$1/etc/" && cp -a /etc/ssl/certs/. "$1/etc/ssl/certs/"
  fi
  in_tree "$1" apt-get -qq update
  in_tree "$1" env DEBIAN_FRONTEND=noninteractive apt-get -qq -y install --no-install-recommends "${@:3}" >"$1.log" 2>&1 || die "apt failed, see $1.log"
}

in_tree() {
  chroot "$1" env -i HOME=/root LANG=C.UTF-8 PATH=/usr/sbin:/usr/bin:/sbin:/bin DEB_BUILD_OPTIONS="${DEB_BUILD_OPTIONS-}" "${@:2}"
}

# use_native_compiler TREE: gcc of another architecture's tree is that of a second tree, which this processor runs itself: an
# emulated compiler takes ten times as long.
use_native_compiler() {
  local here target native=$build/package_trees/$suite-compiler-$arch name
  here=$(dpkg-architecture -q DEB_BUILD_GNU_TYPE) target=$(dpkg-architecture -a "$arch" -q DEB_HOST_GNU_TYPE 2>/dev/null)
  make_tree "$native" "$(dpkg --print-architecture)" "g++-${target//_/-}"
  make_tree "$1" "$arch" g++
  mkdir -p "$1/native"
  mount --bind "$native" "$1/native"
  ln -sfn /native/lib64 "$1/lib64"
  for name in "lib/$here" "$target"; do ln -sfn "/native/usr/$name" "$1/usr/$name"; done
  for name in gcc g++; do ln -sfn "/native/usr/bin/$target-$name" "$1/usr/bin/$name"; done
}

# open_tree NAME: the tree of this name, with /proc and /dev until the script ends.
open_tree() {
  ((EUID == 0)) || die "debootstrap needs root"
  command -v debootstrap >/dev/null || die "install debootstrap first"
  tree=$build/package_trees/$1
  mkdir -p "$build/package_trees"
  touch "$build/CATKIN_IGNORE"
  trap 'umount -q "$tree/proc" "$tree/dev/pts" "$tree/dev" "$tree/native" 2>/dev/null || true' EXIT
  make_tree "$tree" "$arch" ca-certificates
  mount -t proc proc "$tree/proc" && mount --bind /dev "$tree/dev" && mount --bind /dev/pts "$tree/dev/pts"
}

build_in_tree() {
  local packages=$build/packages/$suite-$arch
  open_tree "$suite-$arch"
  [[ $arch == "$(dpkg --print-architecture)" ]] || use_native_compiler "$tree"
  rm -rf "$tree/root/sextant" && mkdir "$tree/root/sextant"
  tar -C "$root" --exclude=./build --exclude=./.git --exclude=__pycache__ -c . | tar -C "$tree/root/sextant" -x
  in_tree "$tree" /root/sextant/tools/package.sh
  mkdir -p "$packages"
  cp "$tree"/root/sextant/build/packages/*.deb "$packages"
  log "packages in $packages"
}

# check_in_tree: apt, first pose, purge.
check_in_tree() {
  local packages=("$build/packages/$suite-$arch"/sextant_*.deb) begin left
  [[ -e ${packages[0]} ]] || die "no package yet: first tools/package.sh --suite $suite --arch $arch"
  rm -rf --one-file-system "$build/package_trees/$suite-$arch-bare"
  open_tree "$suite-$arch-bare"
  cp "${packages[0]}" "$tree/tmp/sextant.deb"
  in_tree "$tree" useradd --create-home robot
  log "installing ${packages[0]##*/} on a bare system"
  begin=$(date +%s)
  in_tree "$tree" env DEBIAN_FRONTEND=noninteractive apt-get -qq -y install --no-install-recommends /tmp/sextant.deb >"$tree.log" 2>&1 || die "apt failed, see $tree.log"
  log "installed after $(($(date +%s) - begin)) s"
  in_tree "$tree" setpriv --reuid robot --regid robot --clear-groups env HOME=/home/robot ROS_HOSTNAME=localhost bash -c "cd / &&
    { roslaunch -p 11399 sextant demo.launch headless:=true plot:=none >/tmp/demo.log 2>&1 & } &&
    export ROS_MASTER_URI=http://localhost:11399 && timeout 120 bash -c 'until rostopic list; do sleep 0.2; done' >/dev/null 2>&1 &&
    timeout 120 rostopic echo -n 1 /joint/pose/pose/pose/position && date +%s && wait && cat /tmp/demo.log" >"$tree.demo" ||
    die "no pose, see $tree.demo"
  log "first pose $(($(grep -m 1 -E '^[0-9]{10}$' "$tree.demo") - begin)) s after the start of apt"
  grep -A 4 'position error' "$tree.demo"
  in_tree "$tree" apt-get -qq -y purge sextant >>"$tree.log" 2>&1
  left=$(find "$tree"/{etc,usr,var,opt,srv} -xdev -iname '*sextant*' ! -path "*/apt/archives/*")
  [[ -z $left ]] || die "purge leaves: $left"
  log "purged, nothing is left"
}

if ((check)); then check_in_tree; elif [[ -n $suite ]]; then build_in_tree; else build_here "$@"; fi
