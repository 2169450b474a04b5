#!/usr/bin/env bash
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Installs missing packages, builds Sextant and runs its demo for a long time, on a separate master. Fails when the memory
# of a node grows by more than 5 MB after the first minute, or when its threads become more.
#
#   tools/soak.sh [MINUTES [FILE.csv]]      60 minutes into build/soak.csv, by default
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/environment.sh"

install_packages build run
continue_as_owner "$@"
build_package

python3 "$root/tools/soak.py" "${1:-60}" "${2:-$build/soak.csv}"
