#!/usr/bin/env bash
# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Builds the documentation as HTML in build/docs/html: the pages of doc/, and the reference of the Python and the C++ API from
# their comments. Installs doxygen and sphinx by apt. Fails on a warning.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/environment.sh"

install_packages build run docs
continue_as_owner "$@"
python3 -c "import myst_parser" 2>/dev/null || die "Debian 11 has no python3-myst-parser: build the documentation on a later Debian"
build_package all

pages=$build/docs/source html=$build/docs/html
rm -rf "$build/docs" && mkdir -p "$pages" "$html/cpp"
cd "$root"
cp -r README.md CONTRIBUTING.md CHANGELOG.rst LICENSE config doc "$pages"

log "C++ reference"
incomplete=WARN_IF_INCOMPLETE_DOC  # before doxygen 1.9.3, undocumented parameters were errors
dpkg --compare-versions "$(doxygen --version)" ge 1.9.3 || incomplete=WARN_IF_DOC_ERROR
{ cat tools/Doxyfile; printf '%s\n' "OUTPUT_DIRECTORY = $html" "HTML_OUTPUT = cpp" "$incomplete = NO"; } | doxygen -

log "pages and Python reference"
SPHINX_APIDOC_OPTIONS=members,show-inheritance python3 -m sphinx.ext.apidoc -q -f -M --implicit-namespaces -o "$pages/doc/api" src/sextant
{
  printf '%s\n' "Compiled core" "=============" "" "All names are in the module \`\`sextant\`\`, too."
  for module in "$build"/devel/lib/python3/dist-packages/sextant/_core/*.so; do
    room=$(basename "${module%%.*}")
    printf '%s\n' "" "$room" "-------------" "" ".. automodule:: sextant._core.$room" "   :members:" "   :undoc-members:"
  done
} >"$pages/doc/api/core.rst"
python3 -m sphinx -q -W --keep-going -c doc -b html "$pages" "$html"
log "$html/doc/index.html"
