#!/usr/bin/env bash
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Installs missing packages, builds Sextant and runs its demo on a separate master.
#
#   scripts/demo.sh [name:=value ...]      the arguments of launch/demo.launch, for instance rviz:=true mode:=nearest
#   scripts/demo.sh --ros-args             lists them
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/../tools/environment.sh"

install_packages build run
continue_as_owner "$@"
build_package demo  # what the demo needs, a third of everything: scripts/build.sh builds the rest

if [[ $* == --* ]]; then exec roslaunch sextant demo.launch "$@"; fi

port=$(python3 -c 'import socket; s = socket.socket(); s.bind(("localhost", 0)); print(s.getsockname()[1])')
export ROS_MASTER_URI=http://localhost:$port PYTHONUNBUFFERED=1
log=$(mktemp)
trap 'rm -f "$log"' EXIT
roslaunch -p "$port" sextant demo.launch "$@" 2>&1 | tee -i "$log"

# The exit status of roslaunch does not show that a node died, and its last messages hide the table.
if grep -q 'process has died \[' "$log"; then die "the demo failed: a node has died, see above"; fi
table=$(awk '/position error, cm/ {table = 1} /\033|killing on exit/ {table = 0} table' "$log")
[[ -n $table ]] || die "the demo failed: no table of errors"
printf '\n%s\n' "$table"
