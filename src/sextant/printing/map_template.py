# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Template of a marker map."""

from pathlib import Path
from typing import Sequence, Union

from sextant.base.atomic_file import atomic_file

_HEAD = """\
# Replace the words by the measured poses of the markers: metres, radians (doc/reference/marker_map.md).
frame: map
markers:
"""


def write_map_template(path: Union[str, Path], family: str, ids: Sequence[int], size: float) -> None:
    """Writes a YAML marker map without poses; it cannot be read until numbers replace the words.

    :param size: edge length of the markers in metres
    :raises OSError: the file cannot be written
    """
    with atomic_file(path) as file:
        file.write(_HEAD)
        for id in ids:
            printed = f"family: {family}, id: {id}, size: {size}"
            file.write(f"  - {{{printed}, position: [x, y, z], rpy: [roll, pitch, yaw]}}\n")
