# SPDX-FileCopyrightText: Sextant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Names of frames."""


def frame_name(name: str) -> str:
    """Name of a frame as in tf2, without the leading slash of tf."""
    return name.lstrip("/")
