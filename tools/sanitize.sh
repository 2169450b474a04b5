#!/usr/bin/env bash
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Installs missing packages, builds Sextant with a sanitizer and runs the C++ tests. Fails at the first finding.
#
#   tools/sanitize.sh address    AddressSanitizer with leaks, UBSan: core, bridges, all nodelets in one process
#   tools/sanitize.sh thread     ThreadSanitizer: all nodelets in one process, several threads
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/environment.sh"

flags="" targets=(nodelets_storm landmark_storm)
case ${1-} in
  address)
    flags="-fsanitize=address,undefined -fno-sanitize-recover=all"
    targets+=(tests)
    ;;
  thread) flags="-fsanitize=thread" ;;
  *) die "argument needed: address or thread" ;;
esac
sanitizer=$1

install_packages build run test
continue_as_owner "$@"
prepare_build

# Debian's libraries are not built with the sanitizer: what is theirs alone is in these lists, each with its reason.
# A failed assertion of ROS raises SIGTRAP without a message: handle_sigtrap prints the location.
lists=$root/test/sanitizer
export ASAN_OPTIONS=detect_stack_use_after_return=1:new_delete_type_mismatch=1:handle_sigtrap=1
export LSAN_OPTIONS=suppressions=$lists/leaks.txt:print_suppressions=0
export UBSAN_OPTIONS=print_stacktrace=1
export TSAN_OPTIONS=suppressions=$lists/threads.txt:halt_on_error=1:second_deadlock_stack=1:history_size=7:handle_sigtrap=1

binary=$build/sanitize_$sanitizer
run_cmake "$binary" "$binary/devel" -DCATKIN_ENABLE_TESTING=ON -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS="$flags -O1 -g1 -fno-omit-frame-pointer"
make -C "$binary" --no-print-directory -j"$(make_jobs)" "${targets[@]}"
set +u
# shellcheck disable=SC1091
. "$binary/devel/setup.bash"
set -u

# One test program on a master of its own. ThreadSanitizer of GCC 12 cannot live with today's address layouts.
master=""
trap '[[ -z $master ]] || kill "$master"' EXIT
run_on_master() {
  local port status=0
  port=$(python3 -c 'import socket; s = socket.socket(); s.bind(("localhost", 0)); print(s.getsockname()[1])')
  export ROS_MASTER_URI=http://localhost:$port
  rosmaster --core -p "$port" >/dev/null &
  master=$!
  until rosparam list >/dev/null 2>&1; do
    sleep 0.2
    kill -0 "$master" || die "no rosmaster on port $port"
  done
  timeout 15m setarch -R "$@" || status=$?
  kill "$master"
  wait "$master" || true
  master=""
  return "$status"
}

programs=$binary/devel/lib/sextant
if [[ $sanitizer == address ]]; then
  for test in "$programs"/test_*; do "$test"; done
  run_on_master "$programs/camera_driver_memory"
fi
run_on_master "$programs/nodelets_storm" _num_worker_threads:=4
run_on_master "$programs/landmark_storm" _num_worker_threads:=4
log "nothing found by the $sanitizer sanitizer"
