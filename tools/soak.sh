#!/usr/bin/env bash
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Installs missing packages, builds Sextant and runs it for a long time, on a separate master.
#
#   tools/soak.sh [MINUTES [FILE.csv]]      the demo; 60 minutes into build/soak.csv, by default. Fails when the memory of a
#                                           node grows by more than 5 MB after the first minute, or its threads become more
#   tools/soak.sh --chaos [MINUTES [SEED]]  all systems, with random faults: damaged messages, clock jumps, killed nodes,
#                                           restarts of roscore, a remote machine whose link is down. Fails when good input
#                                           is not answered after a fault, a node ends, or its memory grows by more than 40 MB
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/environment.sh"

install_packages build run
continue_as_owner "$@"
build_package

if [[ ${1:-} == --chaos ]]; then
  export PYTHONPATH=$root/tools:$root/test/ros:$root/test/python:$PYTHONPATH
  exec python3 "$root/tools/chaos/chaos.py" "${2:-60}" "${3:-1}" "$build/chaos.log"
fi
python3 "$root/tools/soak.py" "${1:-60}" "${2:-$build/soak.csv}"
