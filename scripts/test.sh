#!/usr/bin/env bash
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Installs what apt must, builds Sextant and runs every test (gtest, pytest, rostest). Fails when one fails;
# the last line is the total.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/../tools/environment.sh"

install_packages "$root/tools/apt_packages.txt"
continue_as_owner "$@"
build_package all tests

results=$build/test_results
rm -rf "$results"
complete=0
timeout 40m make -C "$binary" --no-print-directory run_tests || complete=$?  # 0 even where a test failed
catkin_test_results "$results" || true
((complete == 0)) || say "the tests did not run to their end"
python3 "$root/tools/test_totals.py" "$results"
exit "$complete"
