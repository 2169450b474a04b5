# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A marker map to fill in."""

from pathlib import Path
from typing import Sequence, Union

from sextant.base.atomic_file import atomic_file

_HEAD = """\
# Where do the markers hang? Write numbers for the words: metres, radians (doc/marker_map.md).
frame: map
markers:
"""


def write_map_template(path: Union[str, Path], family: str, ids: Sequence[int], size: float) -> None:
    """Writes a YAML marker map whose markers have words for a place: it is refused until these are numbers.

    :param size: edge length in metres
    :raises OSError: the file cannot be written
    """
    with atomic_file(path) as file:
        file.write(_HEAD)
        for id in ids:
            printed = f"family: {family}, id: {id}, size: {size}"
            file.write(f"  - {{{printed}, position: [x, y, z], rpy: [roll, pitch, yaw]}}\n")
