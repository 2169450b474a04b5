#!/usr/bin/env bash
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Installs what apt must, builds Sextant and lets its demo drive for long, on a master of its own. Fails when the memory
# of a node grows by more than 5 MB after the first minute, or when its threads become more.
#
#   tools/soak.sh [MINUTES [FILE.csv]]      60 minutes into build/soak.csv, where nothing else is asked for
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/environment.sh"

install_packages "$root/tools/apt_packages.txt"
continue_as_owner "$@"
build_package

python3 "$root/tools/soak.py" "${1:-60}" "${2:-$build/soak.csv}"
