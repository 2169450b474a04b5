#!/usr/bin/env bash
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Installs what apt must, builds Sextant and runs its demo on a master of its own, whatever else runs here.
#
#   scripts/demo.sh [name:=value ...]      the arguments of launch/demo.launch, for instance rviz:=true mode:=nearest
#   scripts/demo.sh --ros-args             lists them
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/environment.sh"

install_packages "$root/scripts/apt_packages.txt"
continue_as_owner "$@"
build_package

port=$(python3 -c 'import socket; s = socket.socket(); s.bind(("localhost", 0)); print(s.getsockname()[1])')
export ROS_MASTER_URI=http://localhost:$port

# roslaunch says on stderr that a node has died, but not by its exit status.
log=$(mktemp)
trap 'rm -f "$log"' EXIT
roslaunch -p "$port" sextant demo.launch "$@" 2> >(tee -i "$log" >&2)
wait $!
if grep -q 'process has died \[' "$log"; then die "the demo failed: a node has died"; fi
