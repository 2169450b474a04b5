#!/usr/bin/env bash
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Installs missing packages, builds Sextant and runs its tests (gtest, pytest, rostest), several at a time, each rostest on a
# master of its own. A test that fails is run once more, as nodes may start late on a busy machine; the output names it. Fails when
# one fails twice, with the path of its log; the last line is the total.
#
#   scripts/test.sh                      every test
#   scripts/test.sh --quick              two minutes: no rostest and no test that is marked slow
#   scripts/test.sh -R landmark          with ctest's options: those with this word in their name
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/../tools/environment.sh"

install_packages build run test docs
continue_as_owner "$@"
build_package tests

chosen=("$@")
if [[ ${1-} == --quick ]]; then
  chosen=(--label-exclude slow "${@:2}")
  export PYTEST_ADDOPTS="-m 'not slow'"
fi

results=$build/test_results logs=$build/test_logs
rm -rf "$results" "$logs"
complete=0
(cd "$binary" && timeout 60m ctest --parallel $((2 * $(nproc))) --repeat until-pass:2 "${chosen[@]}") | tee "$build/ctest.log" ||
  complete=$?
sed -n 's/.*: \([^ ]*\) \.*\*\*\*\(.*[^ ]\)  .*/sextant: \1 at the first attempt: \2/p' "$build/ctest.log" | sort -u
python3 "$root/tools/test_logs.py" "$binary/Testing/Temporary/LastTest.log" "$logs"
python3 "$root/tools/test_totals.py" "$results" || complete=1
exit "$complete"
