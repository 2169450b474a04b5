#!/usr/bin/env bash
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Installs the linters (apt; ruff and lizard from PyPI into build/lint) and checks format, names, sizes and scripts.
# Every check runs; fails when one fails. The walls between the rooms are tests: test/python/project/test_architecture.py.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/environment.sh"

install_packages build run test lint
continue_as_owner "$@"
cd "$root"

wanted=tools/pip_packages_lint.txt
if ! cmp -s "$wanted" "$build/lint/installed"; then
  mkdir -p "$build" && python3 -m venv --clear "$build/lint"
  "$build/lint/bin/pip" install -q --disable-pip-version-check -r "$wanted" ||
    die "ruff and lizard come from PyPI, which cannot be reached from here: without them there is no lint"
  cp "$wanted" "$build/lint/installed"
fi

# The core's compile commands, each file by itself, are those of $source; everything else is checked in its place.
prepare_build
run_cmake "$build/lint/cmake" "$build/lint/devel" -DCATKIN_ENABLE_TESTING=ON -DCMAKE_EXPORT_COMPILE_COMMANDS=ON -DSEXTANT_UNITY=OFF -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON
mapfile -t cpp < <(find include src test benchmark -name '*.[ch]pp' | sort)
mapfile -t python < <(find setup.py src scripts tools test benchmark -name '*.py' | sort)
mapfile -t shell < <(find scripts tools -name '*.sh'; echo .ci/run)
mapfile -t core < <(find "$source"/src/{base,geometry,images,markers,detection,localization,mapping,landmarks,fusion,places,simulation} -name '*.cpp' | sort)

format() { clang-format-14 --dry-run -Werror "${cpp[@]}"; }
names() {
  printf '%s\n' "${core[@]}" |
    xargs -r -P "$(nproc)" -n 4 clang-tidy-14 --quiet --extra-arg-before=-std=c++17 -p "$build/lint/cmake" 2>/dev/null
}
python_style() { "$build/lint/bin/ruff" check --quiet --output-format=concise .; }
shell_style() { shellcheck -x -P tools:scripts "${shell[@]}"; }
catkin_style() { catkin_lint --config .catkin_lint --offline --quiet --strict -W1 "$root"; }

# No function over 40 lines or of a complexity over 10.
function_limits() { "$build/lint/bin/lizard" -w -L 40 -C 10 "${cpp[@]}" "${python[@]}"; }

# Nine of ten functions have at most 25 lines (the fifth column of lizard's table).
function_lengths() {
  "$build/lint/bin/lizard" --csv "${cpp[@]}" "${python[@]}" | cut -d, -f5 | sort -n |
    awk '{n[NR] = $1} END {ninth = n[int(NR * 0.9 + 0.5)]; print NR " functions, nine of ten with at most " ninth " lines"; exit ninth > 25}'
}

failed=()
for check in format names python_style function_limits function_lengths shell_style catkin_style; do
  if "$check"; then echo "ok: $check"; else
    echo "FAILED: $check"
    failed+=("$check")
  fi
done
((${#failed[@]} == 0)) || die "lint failed: ${failed[*]}"
