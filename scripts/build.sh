#!/usr/bin/env bash
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Installs missing packages and builds Sextant; afterwards `. build/devel/setup.bash` and roslaunch.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/../tools/environment.sh"

install_packages build run
continue_as_owner "$@"
build_package "$@"
